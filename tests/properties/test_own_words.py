"""Whatever is given, the answer is one of our sentences: what is wrong, what is allowed, what to type."""

from __future__ import annotations

import errno
import io
import json
from dataclasses import dataclass, field

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import StickslipError
from stickslip.basics.progress import ProgressLine
from stickslip.maths import exp, where
from stickslip.models.tables import document_of
from stickslip.studies import folder


def rig(**more):
    return ss.presets.piezo_rig(**{"tilt_deg": 1.7, "amplitude": 6e-4, "law": "coulomb", **more})


def says(make, *words):
    with pytest.raises(StickslipError) as caught:
        make()
    for word in words:
        assert word in str(caught.value), str(caught.value)


# ---- study files ----
@each_row("kind", ["[1, 2]", "{a = 1}", "3", "true", "1979-05-27", '""'])
@pytest.mark.parametrize("part", ["harmonic", "coulomb", "level"])
def test_a_kind_of_a_wrong_kind_is_told(kind, part):
    says(lambda: ss.Robot.from_toml(rig().to_toml().replace(f'kind = "{part}"', f"kind = {kind}")), "kind = ", "study file")


@each_row("text", ["a = " + "[" * 3000, "a = " + "9" * 5000, "\0", "robot = 3", "robot = [1]", "[robot]\ndrive = 1"])
def test_a_text_that_no_parser_bears_is_told(text):
    says(lambda: ss.Robot.from_toml(text), "study file")


def test_toml_is_text():
    says(lambda: document_of(3), "int given", "TOML text")
    says(lambda: ss.Robot.from_toml(b"[robot]"), "bytes given")


# ---- laws ----
@dataclass(frozen=True)
class Asks:
    """A law that decides by `if` on its number, which in a batch is many."""

    mu: float = 0.15

    def sliding(self, v, load):
        k = 2.0 if self.mu > 0.1 else 1.0
        return where(v > 0, k * self.mu * load, -k * self.mu * load)

    def breakaway(self, load):
        return -2 * self.mu * load, 2 * self.mu * load


@dataclass(frozen=True)
class Remembers:
    """A law whose attribute would keep the value that the first numbers gave it, hidden behind one of the class."""

    mu: float = 0.15
    hold = 1.0

    def __post_init__(self):
        object.__setattr__(self, "hold", 2 * self.mu)

    def sliding(self, v, load):
        return where(v > 0, self.hold * load, -self.hold * load)

    def breakaway(self, load):
        return -self.hold * load, self.hold * load


@dataclass(frozen=True)
class Derives(Remembers):
    hold: object = field(init=False, default=None)


@dataclass(frozen=True)
class Follows(Remembers):
    """The same as a number: it follows the others into a batch."""

    hold: float = field(init=False, default=0.0)


def test_a_law_that_asks_its_number_in_a_batch_is_told_of_where():
    says(lambda: ss.solve(rig(tilt_deg=0.0).replace(friction=Asks(np.array([0.05, 0.2]))), periods=3), "Asks", "where(condition, yes, no)")


@each_row("law", [Remembers, Derives])
def test_what_a_law_computes_when_it_is_made_is_never_stale(law):
    says(lambda: ss.solve(rig(tilt_deg=0.0).replace(friction=law()), periods=3), law.__name__, "hold", "compute it in the method")
    says(lambda: ss.testing.check_law(law()), "hold")


def test_what_a_law_computes_as_a_number_follows_its_numbers():
    many = ss.solve(rig(tilt_deg=0.0).replace(friction=Follows(np.array([0.1, 0.15]))), periods=3)
    one = ss.solve(rig(tilt_deg=0.0).replace(friction=Follows(0.15)), periods=3)
    assert many.mean_velocity[1] == pytest.approx(ss.mean_velocity(one), rel=1e-12)


def two_sided(v, plus, minus):
    """What anyone would write first: each branch overflows on the other side."""
    return where(v > 0, plus * exp(-v / 1e-5), -minus * exp(v / 1e-5))


def test_a_branch_that_is_not_taken_may_overflow():
    v = np.array([-1.0, -1e-5, 1e-5, 1.0])
    np.testing.assert_allclose(two_sided(v, 3.0, 5.0), [two_sided(x, 3.0, 5.0) for x in v.tolist()], rtol=1e-15)


@dataclass(frozen=True)
class Grows:
    mu: float = 0.15

    def sliding(self, v, load):
        return where(v > 0, self.mu * load * exp(v / 1e-6), -self.mu * load)

    def breakaway(self, load):
        return -1e9 * self.mu * load, 1e9 * self.mu * load


@dataclass(frozen=True)
class Divides(Grows):
    def sliding(self, v, load):
        return where(v > 0, self.mu * load * (1 + 1e-6 / v), -self.mu * load)


def test_a_law_without_bounds_is_told_that_both_branches_are_computed():
    says(lambda: ss.testing.check_law(Grows()), "Grows", "abs(v)")
    says(lambda: ss.bench(Divides(), experiments=["hysteresis"]), "Divides", "abs(v)")


# ---- contact ----
def thrown(amplitude=5e-3, phase=-1.5707963):
    drive = ss.drives.VerticalVibration(ss.Harmonic(5e-4, omega=200.0), amplitude=amplitude, phase=phase)
    return ss.Robot(body_mass=0.06, inner_mass=0.01, friction=ss.Coulomb(0.15, 0.2), drive=drive)


def test_a_run_that_loses_contact_in_its_first_period_says_so_whatever_is_asked():
    run = ss.solve(thrown(), periods=10)
    says(lambda: ss.mean_velocity(run), "contact lost", "no mean velocity")
    assert run.window == (0.0, run.t[-1])
    for draw in (ss.plot.velocity, ss.plot.forces, ss.plot.phase):
        draw(run)
    assert ss.energy(run) is not None


def test_a_run_without_contact_from_the_start_is_refused():
    says(lambda: ss.solve(thrown(phase=1.5707963), periods=10), "at the start", "there is no contact", "more than zero")
    many = ss.solve(thrown(amplitude=np.array([5e-3, 1e-4]), phase=1.5707963), periods=10)
    assert many.status.tolist() == [6, 0] and np.isnan(many.mean_velocity[0])


def test_fixed_steps_refuse_a_load_that_falls_to_zero():
    says(lambda: ss.solve(thrown(), periods=3, method="rk4"), "rk4", "falls to", 'method="auto"')


# ---- records ----
def test_json_without_a_table_is_no_record(tmp_path):
    t = (np.arange(20000) * 1e-3).tolist()
    for k, made in enumerate((t, [], {}, {"a": 1.0}, [[t]])):
        path = tmp_path / f"{k}.json"
        for indent in (None, 1):
            path.write_text(json.dumps(made, indent=indent))
            says(lambda path=path: ss.read(path), "JSON", "allowed")


def test_a_heading_in_brackets_is_no_json(tmp_path):
    (tmp_path / "a.csv").write_text("[Header]\nt [s],v [m/s]\n0.0,1.0\n0.1,2.0\n0.2,3.0\n")
    assert ss.read(tmp_path / "a.csv")["v"].values.tolist() == [1.0, 2.0, 3.0]


def test_a_long_quoted_cell_is_read(tmp_path):
    rows = "\n".join(f"{0.001 * k},{k},1" for k in range(100))
    (tmp_path / "a.csv").write_text(f't [s],v [m/s],"{"x" * 190_000}"\n{rows}\n')
    assert len(ss.read(tmp_path / "a.csv")["v"].values) == 100


# ---- files ----
@pytest.fixture(scope="module")
def short():
    return ss.solve(rig(), periods=3, settle=0)


@each_row("suffix", ["csv", "CSV", "mat", "nc", "h5"])
def test_a_file_holds_what_its_ending_says(short, suffix, tmp_path):
    path = short.save(tmp_path / f"x.{suffix}")
    first = path.read_bytes()[:8]
    kinds = {"csv": first.startswith(b"t"), "mat": first.startswith(b"MATLAB"), "nc": first == b"\x89HDF\r\n\x1a\n"}
    assert kinds[{"h5": "nc"}.get(suffix.lower(), suffix.lower())], first


def test_an_ending_that_is_no_format_is_refused(short, tmp_path):
    says(lambda: short.save(tmp_path / "x.ods"), "'.ods'", ".nc", "run.save('run.nc')")
    assert not list(tmp_path.iterdir())


@each_row("path", [3, None, b"run.nc", "a\0.nc", ["run.nc"]])
def test_what_is_no_path_is_told(short, path):
    for give in (short.save, short.to_mat, ss.load, ss.read, ss.open_study, lambda p: ss.studies.export(p, p)):
        says(lambda give=give: give(path), "path")


def test_a_file_that_is_too_large_is_no_used_up_quota(tmp_path):
    said = {code: str(folder.unwritable_error(tmp_path, OSError(code, "x"))) for code in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)}
    assert "disk is full" in said[errno.ENOSPC] and "quota" in said[errno.EDQUOT]
    assert "quota" not in said[errno.EFBIG] and "larger" in said[errno.EFBIG]


# ---- arguments ----
def test_a_misspelt_argument_of_a_preset_is_told():
    says(lambda: ss.presets.piezo_rig(tilt_deg=1.7, amplitud=5e-4), "did you mean 'amplitude'?", "amplitude is missing")
    says(lambda: ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, frequency=32.7), "omega")
    says(lambda: ss.presets.coulomb_robot(0.5), "alpha_minus is missing")


def double_well(t, y, n):
    return y[1], y[0] - y[0] ** 3 - n.d * y[1] + n.F * ss.maths.cos(t)


DUFFING = ss.SwitchingFlow({0: double_well}, {}, 2 * ss.maths.pi, {"d": 0.5, "F": 0.1}, ("x", "v"))


def branch(**more):
    steps = dict(start=3.6e-4, stop=3.8e-4, step=0.2)
    return ss.continuation(ss.presets.piezo_rig, parameter="amplitude", tilt_deg=1.7, mu0=0.18, law="coulomb", **steps, **more)


def test_a_branch_stops_when_its_progress_says_so():
    seen = []
    whole = branch(progress=lambda *state: seen.append(state))
    assert seen[0][1:] == (2, 400) and seen[-1] == (whole.ended, len(whole.values), len(whole.values))
    assert [done for _, done, _ in seen] == [*range(2, len(whole.values) + 1), len(whole.values)]
    short = branch(progress=lambda what, done, most: done < 3)
    assert short.ended == "it was stopped by progress" and len(short.values) == 3


def test_progress_means_one_thing_everywhere(capsys):
    whole, record = branch(), ss.virtual_rig(rig(law="coulomb"), noise=1e-4, seed=1)
    calls = [
        lambda p: ss.solve(rig(amplitude=[5e-4, 6e-4]), periods=3, progress=p),
        lambda p: ss.sweep(ss.presets.piezo_rig, amplitude=[5e-4, 6e-4], tilt_deg=1.7, law="coulomb", periods=3, progress=p),
        lambda p: ss.bench(ss.Coulomb(0.15, 0.2), experiments=["steady"], progress=p),
        lambda p: ss.bifurcation(ss.presets.piezo_rig, parameter="amplitude", values=[5e-4, 6e-4], tilt_deg=1.7, law="coulomb", progress=p),
        lambda p: branch(progress=p),
        lambda p: ss.dynamics.special_curve(whole, whole.special[0], "mu0", stop=0.185, progress=p),
        lambda p: ss.optimisation.propagate(rig(law="coulomb"), uncertain={"friction.mu_plus": (0.15, "3%")}, samples=4, progress=p),
        lambda p: ss.compare(record, rig(law="coulomb"), laws=["coulomb"], progress=p),
        lambda p: ss.dynamics.edge_state(DUFFING, {"x": -1.0}, {"x": 1.0}, progress=p),
    ]
    for k, call in enumerate(calls):
        for progress in (True, lambda *now: None, (False, None)[k % 2]):
            call(progress)
        says(lambda call=call: call(3), "progress = 3", "progress=True")
        says(lambda call=call: call("yes"), "progress = 'yes'")


def test_a_bar_of_progress_is_one_line(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setenv("TERM", "xterm")
    line = ProgressLine("starts", out=(out := Terminal()))
    line(1, 2), line("drawing", 1, 2), line(ss.studies.Progress(done=2, cases=2))
    said = out.getvalue()
    assert said.count("\r") == 3 and said.count("\n") == 1 and said.endswith("\n")
    assert f"[{'#' * 12}{'.' * 12}] starts, 1 of 2" in said and "drawing, 1 of 2" in said and f"[{'#' * 24}] 100 %" in said


@each_row("terminal", [False, True])
def test_a_log_has_a_line_of_progress_ever_more_rarely(monkeypatch, terminal):
    now = 0.0

    class Log(io.StringIO):
        def isatty(self):
            return terminal

    monkeypatch.setenv("TERM", "dumb")
    monkeypatch.setattr("time.monotonic", lambda: now)
    line, told = ProgressLine(out=(out := Log())), []
    for second in range(1, 60):
        now = float(second)
        line(second, 60)
        told += [second] * (len(out.getvalue().splitlines()) - len(told))
    assert told == [5, 8, 12, 18, 27, 41] and out.getvalue().startswith("5 of 60\n8 of 60\n")


def masked():
    return np.ma.masked_array([0.15, 0.2], [False, True])


def test_masked_values_are_no_numbers():
    for make in (
        lambda: ss.Coulomb(masked(), 0.2), lambda: rig(amplitude=masked()), lambda: ss.solve(rig(), start={"v": masked()}),
        lambda: ss.sweep(ss.presets.piezo_rig, amplitude=masked(), tilt_deg=1.7, law="coulomb"),
    ):  # fmt: skip
        says(make, "masked")
    assert ss.Coulomb(masked().compressed(), 0.2).mu_plus.tolist() == [0.15]


@each_row("x", [1e9, 1e12, 1e300])
def test_a_start_too_far_away_for_its_motion_is_refused(x):
    says(lambda: ss.solve(rig(), periods=3, start={"x": x}), "start", "allowed are sizes up to")


def test_a_start_far_away_moves_as_one_at_zero():
    near, far = (ss.mean_velocity(ss.solve(rig(), periods=20, start={"x": x})) for x in (0.0, 1e5))
    # x is told to 1.5e-11 m there, at each of some hundred steps; the window is a drive period of 0.03 s or more
    assert far == pytest.approx(near, abs=1e-8)


def test_a_mechanism_on_the_virtual_rig_shows_what_it_has():
    oscillator = ss.ForcedOscillator(mass=1.0, load=1.0, friction=ss.Coulomb(0.1, 0.1), stiffness=100.0, damping=0.1, force=1.0, omega=8.0)
    rec = ss.virtual_rig(oscillator, periods=2, settle=2)
    assert len(rec["velocity"]) == 200
    says(lambda: ss.virtual_rig(oscillator, channels=["drive"]), "drive", "ForcedOscillator", "velocity")


def test_correlations_beside_an_undetermined_parameter_are_none():
    from stickslip.inverse.identification.fit import Fit

    class Known:
        covariance = np.array([[1.0, 0.5, np.inf], [0.5, 1.0, 0.0], [np.inf, 0.0, np.inf]])

    found = Fit.correlations.fget(Known)
    assert found[:2, :2].tolist() == [[1.0, 0.5], [0.5, 1.0]]
    assert found[2, 2] == 1.0 and np.isnan(found[[0, 1, 2, 2], [2, 2, 0, 1]]).all()


# ---- notebooks ----
def test_figures_leave_the_settings_of_a_back_end_alone():
    """The first figure of a notebook loads its back end, which turns `interactive` on; it must be on for the next figure too."""
    import matplotlib as mpl

    before, size = mpl.is_interactive(), mpl.rcParams["font.size"]
    try:
        mpl.interactive(False)
        with ss.plot.publication():
            mpl.interactive(True)
        assert mpl.is_interactive() and mpl.rcParams["font.size"] == size
    finally:
        mpl.interactive(before)


def test_a_tilt_that_went_with_the_law_shows_when_the_run_is_printed():
    level = ss.solve(rig(law="coulomb").replace(friction=ss.Coulomb(0.1, 0.2)), periods=3)
    assert "the track is level: the tilt of 1.7 degrees" in repr(level) and "run.notes" in repr(level)
    assert "level" not in repr(ss.solve(rig(law="coulomb"), periods=3))
