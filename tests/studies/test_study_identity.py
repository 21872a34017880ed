"""A study is resumed, merged and opened with the models that it was begun with, whichever way another model comes in."""

from __future__ import annotations

import functools
import inspect
import json
import os
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass, field, make_dataclass
from types import SimpleNamespace

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.fingerprints import fingerprint
from stickslip.show.cli import main
from stickslip.studies.manifest import differences_between, manifest
from stickslip.studies.planning import SOLVER, planned

AMPLITUDES = np.linspace(4e-4, 8e-4, 6)


def robot(factor, amplitude, omega=205.46):
    """From the middle of the axis on, a factor changes the friction."""
    law = ss.Coulomb(0.15, 0.21) if amplitude < 6e-4 else ss.Coulomb(0.15 * factor, 0.21 * factor)
    return ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude, omega=omega), law)


def of_law(law, drive=None, **more):
    return lambda amplitude: ss.Robot(0.06259, 0.00948, drive or ss.Harmonic(amplitude, omega=205.46), law, **more)


# ---- makers ----
def closure(factor):
    return lambda amplitude: robot(factor, amplitude)


def default(factor):
    def make(amplitude, _factor=factor):
        return robot(_factor, amplitude)

    return make


def keyword_default(factor):
    def make(amplitude, *, _factor=factor):
        return robot(_factor, amplitude)

    return make


class Maker:
    def __init__(self, factor):
        self.factor = factor

    def __call__(self, amplitude):
        return robot(self.factor, amplitude)

    def make(self, amplitude):
        return robot(self.factor, amplitude)


@dataclass(frozen=True)
class Callable:
    factor: float

    def __call__(self, amplitude):
        return robot(self.factor, amplitude)


def exec_text(factor):
    names = {"robot": robot}
    exec(f"def make(amplitude):\n    return robot({factor}, amplitude)", names)
    return names["make"]


def with_global(factor):
    names = {"robot": robot, "FACTOR": factor}
    exec("def make(amplitude):\n    return robot(FACTOR, amplitude)", names)
    return names["make"]


def two_helpers_deep(factor):
    deepest = SimpleNamespace(factor=lambda: factor)
    helper = SimpleNamespace(factor=lambda: deepest.factor())
    return lambda amplitude: robot(helper.factor(), amplitude)


def class_attribute(factor):
    made = type("Made", (), {"factor": factor, "make": classmethod(lambda cls, amplitude: robot(cls.factor, amplitude))})
    return made.make


def static_method(factor):
    return type("Made", (), {"make": staticmethod(lambda amplitude: robot(factor, amplitude))}).make


def function_attribute(factor):
    def make(amplitude):
        return robot(make.factor, amplitude)

    make.factor = factor
    return make


def array_in_closure(factor):
    table = np.array([1.0, factor])
    return lambda amplitude: robot(table[1], amplitude)


def dictionary(factor):
    numbers = {"factor": factor}
    return lambda amplitude: robot(numbers["factor"], amplitude)


def environment(factor):
    def make(amplitude):
        os.environ["STICKSLIP_TEST_FACTOR"] = str(factor)
        return robot(float(os.environ["STICKSLIP_TEST_FACTOR"]), amplitude)

    return make


def wrapped(factor):
    """It says that it is a function of ours."""

    def scaled(make):
        @functools.wraps(ss.presets.piezo_rig)
        def inner(amplitude):
            return make(factor, amplitude)

        inner.__signature__ = inspect.signature(lambda amplitude: None)
        return inner

    return scaled(robot)


def cached(factor):
    return functools.lru_cache(lambda amplitude: robot(factor, amplitude))


def only_the_last_case(factor):
    return lambda amplitude: robot(factor if amplitude > 7.9e-4 else 1.0, amplitude)


def another_kind_of_law(factor):
    return of_law(ss.Viscous(0.3, 0.3) if factor != 1.0 else ss.CoulombViscous.example())


def a_field_of_the_robot(name, value):
    return lambda factor: lambda amplitude: robot(1.0, amplitude).replace({name: value * factor})


# ---- laws, drives and tracks ----
def law_class(name, coefficient, **attributes):
    from stickslip.maths import where

    def sliding(self, v, load):
        return self.mu * where(v > 0, coefficient(self), -coefficient(self)) * load

    def breakaway(self, load):
        return -self.mu * coefficient(self) * load, self.mu * coefficient(self) * load

    return make_dataclass(name, [("mu", float)], frozen=True, namespace={"sliding": sliding, "breakaway": breakaway, **attributes})


def law_with_class_attribute(factor):
    return of_law(law_class("Law", lambda self: self.strength, strength=factor)(0.2))


def law_with_closure(factor):
    return of_law(law_class("Law", lambda self: factor)(0.2))


def law_with_array(factor):
    table = np.array([0.0, factor])
    return of_law(law_class("Law", lambda self: float(table[1]))(0.2))


def law_with_overridden_method(factor):
    base = law_class("Base", lambda self: self.strength(), strength=lambda self: 1.0)
    return of_law(base(0.2) if factor == 1.0 else type("Law", (base,), {"strength": lambda self: factor})(0.2))


def law_for_plain_numbers(factor):
    return of_law(law_class("Law", lambda self: factor, scalar_only=True)(0.2))


def law_for_plain_numbers_from_the_environment(factor):
    os.environ["STICKSLIP_TEST_LAW"] = str(factor)
    return of_law(law_class("Law", lambda self: float(os.environ["STICKSLIP_TEST_LAW"]), scalar_only=True)(0.2))


def law_that_starts_elsewhere(factor):
    made = type("Started", (ss.LuGre,), {"start": lambda self, load: factor * 1e-7 * load})
    return of_law(made(**{name: getattr(ss.LuGre.example(), name) for name in ss.LuGre.__dataclass_fields__}))


def pieces(factor):
    return of_law(ss.Coulomb(0.15, 0.21), ss.drives.BangBang(a1=5.0 * factor, a2=3.0, period=0.03))


def own_drive(factor):
    from stickslip.maths import cos, sin

    @dataclass(frozen=True)
    class Shaken:
        amplitude: float
        period: float = field(default=0.03)
        velocity_scale = property(lambda self: self.amplitude * 200.0)

        def position(self, t):
            return self.amplitude * sin(2 * np.pi * t / self.period)

        def velocity(self, t):
            return self.amplitude * 2 * np.pi / self.period * cos(2 * np.pi * t / self.period)

        def acceleration(self, t):
            return -factor * self.amplitude * (2 * np.pi / self.period) ** 2 * sin(2 * np.pi * t / self.period)

    return of_law(ss.Coulomb(0.15, 0.21), Shaken(5e-4))


def track(factor):
    return of_law(ss.Coulomb(0.15, 0.21), track=ss.Incline(tilt=0.01 * factor))


MAKERS = {
    "partial": lambda f: functools.partial(robot, f), "closure": closure, "default": default, "keyword default": keyword_default,
    "object": Maker, "bound method": lambda f: Maker(f).make, "dataclass": Callable, "text of exec": exec_text, "global": with_global,
    "two helpers deep": two_helpers_deep, "class attribute": class_attribute, "static method": static_method,
    "attribute of a function": function_attribute, "array in a closure": array_in_closure, "dictionary": dictionary,
    "environment": environment, "decorator": wrapped, "cache": cached, "the last case only": only_the_last_case,
    "another law": another_kind_of_law, "mass": a_field_of_the_robot("body_mass", 0.07), "gravity": a_field_of_the_robot("gravity", 9.0),
    "frequency": a_field_of_the_robot("drive.omega", 200.0), "partial of partial": lambda f: functools.partial(functools.partial(robot, f)),
    "class attribute of a law": law_with_class_attribute, "closure of a law": law_with_closure, "array in a law": law_with_array,
    "overridden method": law_with_overridden_method, "law for plain numbers": law_for_plain_numbers,
    "plain law and environment": law_for_plain_numbers_from_the_environment, "inner state at the start": law_that_starts_elsewhere,
    "bang-bang drive": pieces, "own drive": own_drive, "track": track,
}  # fmt: skip
SETTINGS = {
    "rtol": dict(rtol=1e-5), "periods": dict(periods=150), "settle": dict(settle=20), "method": dict(method="dop853"),
    "slip_ratio": dict(slip_ratio=0.5), "dwell": dict(dwell=0.05), "start": dict(start=dict(v=0.01)), "tile": dict(tile=3),
    "continue_along": dict(continue_along="amplitude"), "values": dict(amplitude=AMPLITUDES * 1.0001),
    "order": dict(amplitude=AMPLITUDES[::-1]),
    "observe": dict(observe={"mine": ss.observable(lambda s: s.v)}),
}  # fmt: skip


def told(make, amplitude=AMPLITUDES, start=None, continue_along=None, tile=2, **options):
    """The manifest of a study."""
    return manifest(planned(make, (), {"amplitude": amplitude}, start, continue_along, tile, **{**SOLVER, **options}))


def test_there_are_many_ways_to_change_a_model():
    assert len(MAKERS) + len(SETTINGS) >= 40


@each_row("way", MAKERS)
def test_another_model_is_another_study(way):
    make = MAKERS[way]
    first, again = told(make(1.0)), told(make(1.0))
    other = told(make(0.5))
    assert first["study"] == again["study"] and first["models"] == again["models"]
    assert other["study"] != first["study"] and any(
        "has other numbers or another kind" in word for word in differences_between(first, other)
    )


@each_row("way", MAKERS)
def test_code_alone_tells_another_model(way, monkeypatch):
    """Where the code of a maker is the same, its models are made for three tiles of the folder only; here for none."""
    from stickslip.studies import manifest as module

    made = []
    monkeypatch.setattr(module, "_TILES", 0)
    before = module.manifest(planned(MAKERS[way](1.0), (), {"amplitude": AMPLITUDES}, None, None, 2, **SOLVER))
    monkeypatch.setattr(module.ModelIdentities, "of_tiles", lambda self, tiles: made.append(tiles) or [before["models"][k] for k in tiles])
    other = MAKERS[way](0.5)
    if module.code_of(other) == before["code"]:
        assert before["code"] == ""
    same = planned(other, (), {"amplitude": AMPLITUDES}, None, None, 2, **SOLVER)
    module.manifest(same, before)
    assert made[-1] == range(3)


def tiles_made(monkeypatch):
    """The tiles whose models are identified, call by call."""
    from stickslip.studies import manifest as module

    made, of_tiles = [], module.ModelIdentities.of_tiles
    monkeypatch.setattr(module.ModelIdentities, "of_tiles", lambda self, tiles: made.append(list(tiles)) or of_tiles(self, tiles))
    return made


def test_all_models_are_made_again_where_that_takes_no_second(tmp_path, monkeypatch):
    made = tiles_made(monkeypatch)
    amplitude, make = np.linspace(4e-4, 8e-4, 12), closure(0.5)
    ss.sweep(make, amplitude=amplitude, out=tmp_path / "a", tile=2, shard=(1, 2))
    whole = ss.sweep(make, amplitude=amplitude, out=tmp_path / "a", tile=2, resume=True)
    again = [k for tiles in made[1:] for k in tiles]
    assert made[0] == list(range(6)) and again[:3] == [0, 3, 5] and sorted(again) == list(range(6))
    assert "notes" not in whole.attrs
    wanted = ss.sweep(make, amplitude=amplitude, tile=2)
    assert np.array_equal(whole.mean_velocity, wanted.mean_velocity)


def test_a_study_that_goes_on_without_making_all_of_its_models_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr("stickslip.studies.manifest.SECONDS", 0.0)
    made = tiles_made(monkeypatch)
    amplitude, make = np.linspace(4e-4, 8e-4, 12), closure(0.5)
    ss.sweep(make, amplitude=amplitude, out=tmp_path / "a", tile=2, shard=(1, 2))
    whole = ss.sweep(make, amplitude=amplitude, out=tmp_path / "a", tile=2, resume=True)
    assert made == [list(range(6)), [0, 3, 5]]
    assert "the models of 2 of 3 finished tiles, which were not made again" in whole.attrs["notes"]


def test_models_that_are_made_one_by_one_are_made_once(tmp_path):
    calls = Counter()

    def make(amplitude, omega):
        calls[float(amplitude), omega] += 1  # of an array it is a TypeError: this maker is called case by case
        return robot(0.5, amplitude, omega)

    axes = dict(amplitude=np.linspace(4e-4, 8e-4, 5), omega=np.linspace(190.0, 210.0, 5))
    whole = ss.sweep(make, **axes, out=tmp_path / "a", tile=3)
    inside = [
        calls[a, w] for a in axes["amplitude"][[1, 3]].tolist() for w in axes["omega"][[1, 3]].tolist()
    ]  # ends and middles are asked before
    assert inside == [1] * 4
    assert whole.mean_velocity.values.tobytes() == ss.sweep(make, **axes, tile=3).mean_velocity.values.tobytes()


@each_row("way", SETTINGS)
def test_another_setting_is_another_study(way):
    make = MAKERS["partial"](1.0)
    assert told(make)["study"] == told(make)["study"] != told(make, **SETTINGS[way])["study"]


def test_a_patched_method_of_our_law_is_another_study(monkeypatch):
    first = told(MAKERS["partial"](1.0))
    sliding = ss.Coulomb.sliding
    monkeypatch.setattr(ss.Coulomb, "sliding", lambda self, v, load: 0.9 * sliding(self, v, load))
    assert told(MAKERS["partial"](1.0))["models"] != first["models"]


def test_an_observable_is_known_by_all_that_it_refers_to():
    def seen(factor):
        helper = SimpleNamespace(square=lambda v: factor * v**2)
        return {"square": ss.observable(lambda s: helper.square(s.v))}

    make = MAKERS["partial"](1.0)
    assert told(make, observe=seen(1.0))["study"] == told(make, observe=seen(1.0))["study"] != told(make, observe=seen(2.0))["study"]


def test_random_designs_with_another_seed_are_other_studies():
    def of(seed):
        design = ss.designs.latin_hypercube(6, seed=seed, amplitude=(4e-4, 8e-4))
        return manifest(planned(MAKERS["partial"](1.0), (design,), {}, None, None, 2, **SOLVER))["study"]

    assert of(1) == of(1) != of(2)


# ---- doors ----
@each_row("way", ["partial", "closure", "default", "object", "bound method", "global", "the last case only"])
def test_no_door_mixes_models(tmp_path, way):
    make, options = MAKERS[way], dict(amplitude=AMPLITUDES, tile=2)
    ss.sweep(make(1.0), **options, out=tmp_path / "one", shard=(1, 3))
    with pytest.raises(ss.InputError, match=r"other numbers or another kind: the numbers of its models differ in . of 3 tiles"):
        ss.sweep(make(0.5), **options, out=tmp_path / "one", resume=True)
    for i in (2, 3):
        ss.sweep(make(0.5), **options, out=tmp_path / str(i), shard=(i, 3))
    with pytest.raises(ss.InputError, match="is of another study than"):
        ss.studies.merge([tmp_path / "one", tmp_path / "2", tmp_path / "3"], tmp_path / "whole")
    stolen = (tmp_path / "3" / "tiles" / "0000002.nc").read_bytes()
    (tmp_path / "one" / "tiles" / "0000002.nc").write_bytes(stolen)
    with pytest.raises(ss.InputError, match="is damaged"):
        ss.open_study(tmp_path / "one").status.load()
    ss.sweep(make(1.0), **options, out=tmp_path / "one", resume=True)
    assert not (ss.open_study(tmp_path / "one").status == 101).any()


def test_shards_are_not_merged_into_a_folder_of_another_model(tmp_path):
    options = dict(amplitude=AMPLITUDES, tile=2)
    ss.sweep(closure(1.0), **options, out=tmp_path / "whole", shard=(1, 2))
    ss.sweep(closure(0.5), **options, out=tmp_path / "half", shard=(2, 2))
    with pytest.raises(ss.InputError, match="is of another study than"):
        ss.studies.merge([tmp_path / "half"], tmp_path / "whole")


def test_a_maker_that_changes_its_mind_on_the_way_keeps_nothing_wrong(tmp_path, monkeypatch):
    from stickslip.studies.folder import StudyFolder

    numbers, write = {"factor": 1.0}, StudyFolder.write

    def write_and_change(study, k, *more):
        write(study, k, *more)
        numbers["factor"] = 0.5

    monkeypatch.setattr(StudyFolder, "write", write_and_change)
    options = dict(amplitude=AMPLITUDES, tile=2)
    # a maker of arrays is called for each tile: the second tile is of another model
    with pytest.raises(ss.InputError, match=r"cases 2 to 3 were computed with other models than those of the study"):
        ss.sweep(lambda amplitude: of_law(ss.Coulomb(0.2 * numbers["factor"], 0.3))(amplitude), **options, out=tmp_path / "arrays")
    assert ss.open_study(tmp_path / "arrays").status.values[2:].tolist() == [101] * 4
    # one that is called case by case has made all models before it changes
    numbers["factor"] = 1.0
    found = ss.sweep(lambda amplitude: robot(numbers["factor"], amplitude), **options, out=tmp_path / "study")
    numbers["factor"] = 1.0
    wanted = ss.sweep(lambda amplitude: robot(numbers["factor"], amplitude), **options)
    assert found.mean_velocity.values.tobytes() == wanted.mean_velocity.values.tobytes()


MODULE = '''
"""Makers."""
import stickslip as ss
FACTOR = {factor}


def rig(amplitude: float):
    {doc}
    law = ss.Coulomb(0.15 * FACTOR, 0.21 * FACTOR)
    return ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude, omega=205.46), law)
'''


@pytest.mark.parametrize("door", ["code", "toml"])
def test_the_command_line_refuses_another_model(tmp_path, monkeypatch, capsys, door):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own_rig.py").write_text(MODULE.format(factor=1.0, doc=""))
    (tmp_path / "study.toml").write_text('make = "own_rig.py:rig"\n')
    subject = ["own_rig.py:rig"] if door == "code" else ["study.toml"]
    allowed = [] if door == "code" else ["--allow-code"]
    words = ["sweep", *subject, "amplitude=4e-4..8e-4:6", "--tile", "2", "--out", "grid", *allowed]

    def run(*typed):
        sys.modules.pop("own_rig", None)
        return main(list(typed))

    assert run(*words, "--shard", "1/2") == 0
    (tmp_path / "own_rig.py").write_text("\n\n# a comment\n" + MODULE.format(factor=1.0, doc='"""A docstring."""'))
    assert run(*words, "--resume", "--shard", "1/2") == 0
    os.utime(tmp_path / "own_rig.py", ns=(1, 1))
    (tmp_path / "own_rig.py").write_text(MODULE.format(factor=0.5, doc=""))
    capsys.readouterr()
    for typed in ([*words, "--resume"], ["resume", "grid", "--allow-code"]):
        assert run(*typed) != 0
        assert "the robot has other numbers or another kind" in capsys.readouterr().err


def test_an_atlas_is_not_resumed_with_another_model(tmp_path):
    over = {"amplitude": [3.3e-4, 3.6e-4, 3.9e-4], "mu0": [0.17, 0.18]}

    def making(factor):
        def make(amplitude, mu0):
            between = 3.65e-4 < amplitude < 3.85e-4  # not on the grid, but where a branch passes
            return ss.presets.piezo_rig(amplitude=amplitude, mu0=mu0 * (factor if between else 1.0), tilt_deg=1.7, law="coulomb")

        return make

    first = ss.atlas(making(1.0), over=over, out=tmp_path / "atlas")
    again = ss.atlas(making(1.0), over=over, out=tmp_path / "atlas", resume=True)
    assert again.map.identical(first.map) and len(again.borders) == len(first.borders)
    with pytest.raises(ss.InputError, match="holds results of other models"):
        ss.atlas(making(1.01), over=over, out=tmp_path / "atlas", resume=True)
    with pytest.raises(ss.InputError, match="is the folder of another atlas: the robot has other numbers"):
        ss.atlas(ss.presets.piezo_rig, over=over, tilt_deg=1.71, law="coulomb", out=tmp_path / "atlas", resume=True)


def test_a_worker_with_another_module_is_refused(tmp_path, monkeypatch):
    """The models that a worker solved are compared with those of this process."""
    import importlib

    from stickslip.studies.model_identity import ModelIdentities
    from stickslip.studies.running import _check_models, _elsewhere, _Known

    (tmp_path / "rig_of_workers.py").write_text(MODULE.format(factor=1.0, doc=""))
    monkeypatch.syspath_prepend(tmp_path)
    module = importlib.import_module("rig_of_workers")
    plan = planned(module.rig, (), dict(amplitude=AMPLITUDES), None, None, 2, **SOLVER)
    asked, mine = (1, plan.alone(plan.points(1))), ModelIdentities(plan).of_tiles([1])[0]
    _check_models(1, mine, _elsewhere(1, _Known(), asked)[2])
    monkeypatch.setattr(module, "FACTOR", 0.5)
    with pytest.raises(ss.InputError, match="a worker computed tile 1 with other models"):
        _check_models(1, mine, _elsewhere(1, _Known(), asked)[2])


def test_what_a_worker_knows_of_one_study_is_not_taken_for_another(tmp_path):
    """Equations with an observable are others, of the same robots in the same worker."""
    from concurrent.futures import ThreadPoolExecutor

    fastest = {"fastest": ss.observable(lambda s: s.v, "max")}
    with ThreadPoolExecutor(1) as pool:
        for name, observe in {"plain": None, "observed": fastest}.items():
            how = dict(tilt_deg=1.7, law="coulomb", tile=1, observe=observe, executor=pool, out=tmp_path / name)
            grid = ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 5e-4], **how)
            assert (grid.status <= 1).all()


# ---- no false alarms ----
SCRIPT = """
import dataclasses, functools, json, sys
import numpy as np
import stickslip as ss
from stickslip.maths import where
from stickslip.studies.manifest import manifest
from stickslip.studies.planning import SOLVER, planned
{lines}
WORDS = {{"a", "b", "c"}}
@dataclasses.dataclass(frozen=True)
class Mine:
    {doc}
    mu: float
    scalar_only = {plain}
    def coefficient(self):
        {doc}
        return self.mu * len(WORDS)
    def sliding(self, v, load):
        return where(v > 0, self.coefficient(), -self.coefficient()) * load
    def breakaway(self, load):
        return -self.coefficient() * load, self.coefficient() * load
def make(table, amplitude):
    {doc}
    {local} = Mine(float(table[0]))  # a comment
    return ss.Robot(0.06, 0.01, ss.Harmonic(amplitude, omega=200.0), {local})
given = functools.partial(make, np.array([0.1, 0.2]))
observe = None if Mine.scalar_only else {{"w": ss.observable(lambda s: len(WORDS) * s.v)}}
plan = planned(given, (), dict(amplitude=[4e-4, 5e-4]), None, None, 1, **(SOLVER | dict(observe=observe)))
found = manifest(plan)
print(json.dumps([found["study"], found["models"], found["unchecked"]]))
"""


def test_the_same_model_in_another_process_is_the_same():
    """With a law that is traced, and with one for plain numbers."""

    def run(seed, lines, docs, local):
        texts = [SCRIPT.format(lines=lines, doc=doc, local=local, plain=plain) for doc, plain in zip(docs, (False, True), strict=True)]
        command, environment = [sys.executable, "-c", "\n".join(texts)], {**os.environ, "PYTHONHASHSEED": seed}
        done = subprocess.run(command, env=environment, capture_output=True, check=True, text=True)
        return [json.loads(line) for line in done.stdout.splitlines()]

    first = run("1", "", ("pass", "pass"), "law")
    assert run("2", "\n\n# moved down\n", ('"""A docstring."""', "pass"), "friction") == first
    assert [unchecked for _, _, unchecked in first] == [[], []]


def test_a_docstring_is_no_part_of_a_function():
    def of(text):
        names = {}
        exec(f"def f(x):\n    {text}\n    y = 2 * x\n    return y", names)
        return fingerprint(names["f"])

    assert of('"""One."""') == of('"""Two."""') != of("x = x + 1")


def test_what_a_function_imports_counts_whether_or_not_it_was_called_and_nothing_else_that_is_imported(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "rig_numbers.py").write_text("MU = 0.3\n")

    def late():
        import rig_numbers

        return rig_numbers.MU

    fresh = fingerprint(late).digest
    assert "rig_numbers" in sys.modules and late() == 0.3 and fingerprint(late).digest == fresh
    monkeypatch.setattr(sys.modules.pop("rig_numbers"), "MU", 0.4)
    assert fingerprint(late).digest == fresh  # the file says 0.3
    monkeypatch.setattr(sys.modules["rig_numbers"], "MU", 0.4)
    assert fingerprint(late).digest != fresh
    monkeypatch.delitem(sys.modules, "rig_numbers")

    def attribute(error):
        return error.rig_numbers

    before = fingerprint(attribute).digest
    monkeypatch.setitem(sys.modules, "rig_numbers", SimpleNamespace(MU=0.5))
    assert fingerprint(attribute).digest == before  # an attribute is no module of that name


def test_what_cannot_be_compared_is_told(tmp_path):
    import threading

    def law(lock):
        return of_law(law_class("Law", lambda self: 1.0 if lock.acquire(False) or True else 2.0, scalar_only=True)(0.2))

    grid = ss.sweep(law(threading.Lock()), amplitude=AMPLITUDES[:2], periods=2, out=tmp_path / "study")
    assert any("unchecked when this study is resumed or merged: a lock" in note for note in json.loads(grid.attrs["notes"]))


def test_a_folder_of_format_2_is_opened_and_merged_with_a_note_and_not_gone_on_with(tmp_path):
    from stickslip.studies.seals import SEAL, of_manifest, sealed_bytes
    from stickslip.studies.tiles import mark_of

    options = dict(amplitude=AMPLITUDES, tile=2)
    whole = ss.sweep(closure(1.0), **options, out=tmp_path / "study").load()
    found = json.loads((tmp_path / "study" / "manifest.json").read_text())
    old = {name: value for name, value in found.items() if name not in ("models", "compared", "unchecked", SEAL)} | {"stickslip_format": 2}
    for path in sorted((tmp_path / "study" / "tiles").iterdir()):
        content = path.read_bytes().partition(b"\nstickslip models ")[0]
        path.write_bytes(sealed_bytes(content, mark_of(old, f"tile {int(path.stem)}")))
    (tmp_path / "study" / "manifest.json").write_text(json.dumps({**old, SEAL: of_manifest(old)}))
    for grid in (ss.open_study(tmp_path / "study"), ss.studies.merge([tmp_path / "study"], tmp_path / "merged")):
        assert any("whether all results are of one model is unchecked" in note for note in json.loads(grid.attrs["notes"]))
        np.testing.assert_array_equal(grid.mean_velocity.values, whole.mean_velocity.values)
    with pytest.raises(ss.InputError, match="which did not record the models of each tile"):
        ss.sweep(closure(1.0), **options, out=tmp_path / "study", resume=True)
