"""The record of a run of several bodies and contacts; of one body on one contact it is what it always was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from runs import coulomb_run, lugre_run, unit_robot
from several import LAYOUT, MODE, STATES, Pair, T, coefficients, forces, glued, pair_run, pieces, state, ways
from stickslip.analysis.motion import threshold_table
from stickslip.analysis.run_segments import shares
from stickslip.analysis.steady import period_number, velocity_range
from stickslip.basics.status import STATUS
from stickslip.models.state_layout import BodyStates, ContactStates, StateLayout, of_one_contact
from stickslip.results.datasets import columns_with_units, headed
from stickslip.results.dense_output import HarmonicArcs, PolynomialPieces, inner_rates, pieces_from_arrays
from stickslip.results.events import events_of

#: Sums of five terms of size 1 to 10, and a few more roundings.
ROUNDING = 1e-13


@pytest.fixture
def pair(monkeypatch):
    monkeypatch.setattr("stickslip.models.forces.columns", forces)
    return pair_run()


@pytest.fixture(scope="module")
def robot_run():
    return coulomb_run(unit_robot(0.7, 0.9), 6)


# ---- states ----
def test_the_states_have_names():
    assert LAYOUT.names == STATES
    assert StateLayout.of_one(2, knows_position=True).names == ("v", "z.0", "z.1", "x")


@each_row("piece", [0, 1, 2])
def test_positions_are_ways_and_what_is_added_to_them(piece):
    """Against NumPy's polynomials, integrated from the start of the piece."""
    c = coefficients()
    t = np.linspace(T[piece], T[piece + 1], 9)
    x, v, z = pieces(c).evaluate(t, np.full(9, piece))
    head = ways(c)[piece, 0] + state(c, 0, piece).integ(lbnd=T[piece])(t)
    assert x.shape == v.shape == (9, 2) and z.shape == (9, 3, 2)
    assert abs(x - np.stack([head, 0.5 * head + state(c, 2, piece)(t)], axis=1)).max() < ROUNDING
    assert abs(v - np.stack([state(c, i, piece)(t) for i in (0, 1)], axis=1)).max() < ROUNDING
    assert abs(z[:, 0] - np.stack([state(c, i, piece)(t) for i in (3, 4)], axis=1)).max() < ROUNDING
    assert abs(z[:, 1, 0] - state(c, 5, piece)(t)).max() < ROUNDING


def test_where_a_law_has_fewer_inner_states_they_are_no_numbers():
    z = pieces().evaluate(T[:3], np.arange(3))[2]
    assert np.isnan(z).tolist() == [[[False, False], [False, True], [True, True]]] * 3


def test_rates_of_inner_states_are_their_slopes():
    c, t = coefficients(), np.linspace(T[0], T[1], 7)
    rates = inner_rates(pieces(c), t, np.zeros(7, int))
    assert rates.shape == (7, 3, 2)
    assert abs(rates[:, 0, 1] - state(c, 4, 0).deriv()(t)).max() < 10 * ROUNDING  # slopes are four to twenty times larger
    assert np.isnan(rates[:, 1, 1]).all() and np.isnan(rates[:, 2]).all()


def test_a_body_whose_position_is_a_state_has_no_way():
    layout = StateLayout((BodyStates("car", 0, position=2), BodyStates("cart", 1, position=3)), (), ways=())
    c = coefficients()[:, :4]
    made = PolynomialPieces(T, np.empty((3, 0), np.int8), np.empty((3, 0)), c, layout=layout)
    assert abs(made.evaluate(T[:3], np.arange(3))[0] - c[:, 2:, 0]).max() == 0.0
    again = pieces_from_arrays("polynomial", made.arrays())
    assert again.layout == layout and again.mode.shape == (3, 0) and again.x0.shape == (3, 0)


def test_pieces_of_several_come_back_from_their_arrays_and_can_be_cut():
    made, t = pieces(), np.linspace(0.0, 0.6, 11)
    again, cut = pieces_from_arrays("polynomial", made.arrays()), made.until(0.6)
    index = np.searchsorted(T, t, side="right") - 1
    for a, b, c in zip(*(p.evaluate(t, index) for p in (made, again, cut)), strict=True):
        assert np.array_equal(a, b, equal_nan=True) and np.nanmax(abs(a - c)) < ROUNDING
    assert again.layout == cut.layout == made.layout and np.array_equal(again.memory, made.memory) and np.array_equal(cut.mode, MODE[:2])


def test_all_that_is_wrong_with_a_layout_is_told_at_once():
    contacts = (ContactStates("pad", (1.0,), (9, 3, 3)), ContactStates("pad", (1.0, 0.0), memory=(-1,)))
    wrong = StateLayout((BodyStates("head", 0, way=1), BodyStates("tail", 7)), contacts, ways=(0,), single=True)
    with pytest.raises(ss.InputError) as error:
        pieces(layout=wrong)
    said = str(error.value)
    for flaw in (
        "names of the contacts are ['pad', 'pad']", "'tail' has neither a way nor a position", "state number 7; allowed is 0 to 5",
        "state number 9", "inner states are [9, 3, 3]", "way number 1; allowed is 0 to 0", "memory number -1",
        "3 columns of mode; allowed is one for each of the 2 contacts", "1 numbers in the direction of 'pad'",
        "single=True with 2 bodies (head, tail)",
    ):  # fmt: skip
        assert flaw in said, said


def test_closed_arcs_are_those_of_one_body():
    shared = StateLayout((BodyStates("head", 0, way=0), BodyStates("tail", 0, way=0)), (ContactStates("pad", (1.0, 0.0)),), ways=(0,))
    for wrong in (LAYOUT, shared):
        with pytest.raises(ss.InputError, match="HarmonicArcs"):
            HarmonicArcs(T, MODE[:, 0], np.zeros(3), np.zeros(3), 1.0, 1.0, 0.5, 0.5, layout=wrong)


# ---- a run ----
def test_columns_have_an_axis_for_bodies_or_contacts(pair):
    n = len(pair.t)
    assert pair.x.shape == pair.v.shape == pair.acceleration.shape == (n, 2)
    assert pair.mode.shape == pair.friction_force.shape == pair.slip.shape == pair.load.shape == (n, 3) and pair.z.shape == (n, 3, 2)
    assert pair.strobe_x.shape == pair.strobe_v.shape == (2, 2) and pair.strobe_z.shape == (2, 3, 2)
    index = np.clip(np.searchsorted(T, pair.t, side="right") - 1, 0, 2)
    x, v, z = pair.pieces.evaluate(pair.t, index)
    assert np.array_equal(pair.x, x) and np.array_equal(pair.v, v) and np.array_equal(pair.z, z, equal_nan=True)
    assert np.array_equal(pair.mode, MODE[index])
    assert pair.strobe_x[0].tolist() == pair.x[0].tolist() and "not judged" in pair.notes[0] and "finished" in repr(pair)


def test_parts_are_seen_by_their_names(pair):
    assert list(pair.bodies) == ["head", "tail"] and list(pair.contacts) == ["head", "tail", "belt"]
    for i, body in enumerate(pair.bodies.values()):
        for name in ("x", "v", "acceleration", "strobe_x", "strobe_v"):
            assert np.array_equal(getattr(body, name), getattr(pair, name)[:, i])
    for i, contact in enumerate(pair.contacts.values()):
        for name in ("mode", "friction_force", "slip", "load"):
            assert np.array_equal(getattr(contact, name), getattr(pair, name)[:, i])
        assert contact.events == [event for event in pair.events if event.part == contact.name]
    assert np.array_equal(pair.contacts["head"].z, pair.z[:, 0]) and np.array_equal(pair.contacts["tail"].z, pair.z[:, 1, 0])
    assert pair.contacts["belt"].z is None and pair.contacts["tail"].strobe_z.shape == (2,)


def test_a_robots_parts_are_called_body_and_contact(robot_run):
    elastic = lugre_run(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4), 2, rtol=1e-6)
    for run in (robot_run, elastic):
        (body,), (contact,) = run.bodies.items(), run.contacts.items()
        assert (body[0], contact[0]) == ("body", "contact") and {event.part for event in run.events} == {"contact"}
        for name in ("x", "v", "acceleration", "strobe_x", "strobe_v"):
            assert np.array_equal(getattr(body[1], name), getattr(run, name)) and getattr(run, name).ndim == 1
        for name in ("mode", "friction_force"):
            assert np.array_equal(getattr(contact[1], name), getattr(run, name)) and getattr(run, name).ndim == 1
        assert contact[1].events == run.events
    assert robot_run.contacts["contact"].z is None
    (contact,) = elastic.contacts.values()
    assert np.array_equal(contact.z, elastic.z) and np.array_equal(contact.strobe_z, elastic.strobe_z)
    assert np.array_equal(robot_run.contacts["contact"].slip, robot_run.v) and np.ptp(robot_run.contacts["contact"].load) == 0.0
    with pytest.raises(AttributeError, match="only machines of several contacts"):
        robot_run.slip  # noqa: B018


def test_at_has_the_axes_of_the_columns_behind_the_shape_of_its_argument(pair):
    found = pair.at(pair.t)
    for name in ("x", "v", "z", "mode", "friction_force", "acceleration", "load"):
        assert np.array_equal(found[name], getattr(pair, name), equal_nan=True), name
    assert pair.at(0.3)["x"].shape == (2,) and pair.at([[0.1], [0.2]])["z"].shape == (2, 1, 3, 2)


def test_forces_are_asked_once_for_all_contacts_with_the_axes_of_the_columns(monkeypatch):
    asked = []

    def columns(model, mode, t, x, v, z, zdot, memory):
        asked.append((mode.shape, t.shape, x.shape, v.shape, z.shape, zdot.shape, [m.tolist() for m in memory]))
        return forces(model, mode, t, x, v, z, zdot, memory)

    monkeypatch.setattr("stickslip.models.forces.columns", columns)
    run = pair_run()
    for _ in range(2):
        assert run.friction_force.shape == run.load.shape
    n = len(run.t)
    shapes = ((n, 3), (n,), (n, 2), (n, 2), (2, n, 3), (2, n, 3))
    assert [one[:6] for one in asked] == [shapes] and [sorted(set(m)) for m in asked[0][6]] == [[1, 2], [7]]


def test_an_instant_at_which_any_body_jumps_stands_there_twice(monkeypatch):
    monkeypatch.setattr("stickslip.models.forces.columns", forces)
    c = coefficients()
    c[1, 1] *= 3.0  # the tail's velocity, at T[1] and at T[2]
    run = pair_run(pieces(c))
    assert [int((run.t == t).sum()) for t in T[1:3]] == [2, 2] and [int((pair_run().t == t).sum()) for t in T[1:3]] == [1, 1]
    first, second = np.flatnonzero(run.t == T[1])
    assert run.v[second, 1] == pytest.approx(3 * run.v[first, 1]) and run.v[second, 0] == pytest.approx(run.v[first, 0])


# ---- events ----
def test_events_at_one_instant_are_one_for_each_part_in_order():
    told = [(e.t, e.kind, e.before, e.after, e.part) for e in events_of(pieces())]
    assert told == [
        (0.5, "stick", 1, 0, "head"), (0.5, "stick", 1, 0, "tail"), (0.75, "switch", 0, 0, "head"), (0.75, "slip", 0, 1, "tail"),
    ]  # fmt: skip


@each_row(
    ("jump", "thrown"),
    [(0.2, ["head", "tail", "belt"]), ([0.2, 0.0], ["head", "belt"]), ([0.2, 0.2], ["head", "tail"]), ([0.0, -0.1], ["tail", "belt"])],
)
def test_an_impulse_throws_the_contacts_whose_slip_jumps(jump, thrown):
    still = pieces(mode=np.ones((3, 3), np.int8), memory=((1, 7),) * 3)
    found = events_of(still, [(0.75, np.array(jump) if isinstance(jump, list) else jump)])
    assert [(e.t, e.kind, e.part) for e in found] == [(0.75, "impulse", name) for name in thrown]


def test_the_contact_that_was_lost_is_named(monkeypatch):
    monkeypatch.setattr("stickslip.models.forces.columns", forces)  # the load of the second falls to zero
    run = pair_run()
    assert [e for e in run.events if e.kind == "contact lost"] == []
    lost = [e for e in replace(run, status=STATUS[6]).events if e.kind == "contact lost"]
    assert [(e.t, e.part, e.after) for e in lost] == [(1.0, "tail", 1)]


def test_two_robots_in_one_record_move_as_each_does_alone(monkeypatch):
    robots = [ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude) for amplitude in (5e-4, 8e-4)]
    alone = {name: lugre_run(robot, 3, rtol=1e-6) for name, robot in zip(("slow", "fast"), robots, strict=True)}
    both = pair_run(glued(alone), Pair(period=robots[0].period))
    t = np.linspace(0.0, both.pieces.t[-1], 500)
    owns = [run.at(t) for run in alone.values()]
    monkeypatch.setattr("stickslip.models.forces.columns", forces)
    found = both.at(t)
    for i, ((name, run), own) in enumerate(zip(alone.items(), owns, strict=True)):
        for column, mine in (("x", found["x"][:, i]), ("v", found["v"][:, i]), ("z", found["z"][:, i, 0])):
            assert abs(mine - own[column]).max() < 1e-13 * abs(own[column]).max(), column  # the polynomials are shifted, in ten roundings
        assert [(e.t, e.kind, e.before, e.after) for e in both.contacts[name].events] == [
            (e.t, e.kind, e.before, e.after) for e in run.events
        ]
        assert both.bodies[name].strobe_x == pytest.approx(run.strobe_x, rel=1e-12, abs=1e-18)
        assert np.isin([e.t for e in run.events], both.t).all()
    assert len(both.events) == sum(len(run.events) for run in alone.values()) > 8
    assert [e.t for e in both.events] == sorted(e.t for e in both.events)


# ---- doors ----
def test_datasets_have_the_dimensions_body_and_contact(pair):
    data = pair.to_xarray()
    assert (
        data.x.dims == ("time", "body") and data.z.dims == ("time", "contact", "inner_state") and data["load"].dims == ("time", "contact")
    )
    assert data.body.values.tolist() == ["head", "tail"] and data.contact.values.tolist() == ["head", "tail", "belt"]
    assert np.array_equal(data.v.sel(body="tail"), pair.v[:, 1]) and np.array_equal(data.mode.sel(contact="belt"), pair.mode[:, 2])


def test_the_dataset_of_a_robot_has_the_dimension_time_alone(robot_run):
    one = robot_run.to_xarray()
    assert set(one.dims) == {"time"} and set(one.coords) == {"time"} and "slip" not in one


def test_text_and_matlab_files_name_the_parts(pair, tmp_path):
    from scipy.io import loadmat

    lines = pair.save(tmp_path / "pair.csv").read_text().splitlines()
    head = lines[0].split(",")
    assert head[:5] == ["t [s]", "x.head [m]", "x.tail [m]", "v.head [m/s]", "v.tail [m/s]"]
    assert [name for name in head if name[0] == "z"] == ["z.head_0 [m]", "z.head_1 [m]", "z.tail_0 [m]"]
    assert np.array_equal(np.array([line.split(",")[2] for line in lines[1:]], float), pair.x[:, 1])
    read = loadmat(pair.save(tmp_path / "pair.mat"))
    assert np.array_equal(read["z"], pair.z, equal_nan=True) and [n.strip() for n in read["body"]] == ["head", "tail"]
    assert headed(columns_with_units({"t": T, "z": np.ones((4, 2))}, {}, None)) == ["t [s]", "z_0 [m]", "z_1 [m]"]


def test_a_file_of_several_comes_back_bit_by_bit(monkeypatch, tmp_path):
    import xarray as xr

    monkeypatch.setattr("stickslip.models.forces.columns", forces)
    run = pair_run(model=unit_robot(0.7, 0.9).replace({"drive.omega": 2 * np.pi}))
    path = run.save(tmp_path / "pair.nc")
    same = ss.load(path)
    assert same.pieces.layout == LAYOUT and same.events == run.events
    for name in ("t", "x", "v", "z", "mode", "strobe_x", "load"):
        assert np.array_equal(getattr(same, name), getattr(run, name), equal_nan=True), name
    with xr.open_dataset(path, engine="h5netcdf") as seen:
        assert seen.x.dims == ("time", "body") and seen.body.values.tolist() == ["head", "tail"]
        assert np.array_equal(seen.mode.sel(contact="tail"), run.mode[:, 1])


@each_row(
    ("place", "name", "value", "message"),
    [
        ("/", "stickslip_format", 3, "has format 3, this stickslip reads up to 2; type pip install --upgrade"),
        ("/", "stickslip_format", 1, r"has format 1, which no release has written; allowed are 2 to 2; type run\.save"),
        ("pieces", "layout", None, "is damaged .* save the run again"),
        ("pieces", "layout", "[]", "is damaged"),
        ("pieces", "layout", LAYOUT.to_text().replace('"position": 2', '"position": 17'), "damaged .*state number 17; allowed is 0 to 5"),
        ("pieces", "layout", LAYOUT.to_text().replace('"way": 0', '"way": "0"'), "damaged .*way number '0'"),
    ],
)  # fmt: skip
def test_a_file_of_an_unknown_format_or_layout_is_refused_with_what_to_do(place, name, value, message, monkeypatch, tmp_path):
    import h5py

    monkeypatch.setattr("stickslip.models.forces.columns", forces)
    path = pair_run(model=unit_robot(0.7, 0.9).replace({"drive.omega": 2 * np.pi})).save(tmp_path / "run.nc")
    with h5py.File(path, "r+") as file:
        del file[place].attrs[name]
        if value is not None:
            file[place].attrs[name] = value
    with pytest.raises(ss.InputError, match=message):
        ss.load(path)


# ---- analyses ----
@each_row(
    "analysis",
    [
        ss.energy, ss.motion, ss.mean_velocity, ss.dynamics.spectrum, ss.plot.phase,
        threshold_table, velocity_range, period_number, shares, lambda run: run.steadiness,
        lambda run: ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), guess=run),
    ],
)  # fmt: skip
def test_an_analysis_of_one_contact_refuses_several_with_a_reason(analysis, pair):
    said = r"the run has 2 bodies \(head, tail\) and 3 contacts .* allowed is one body on one contact, as .*; type run"
    with pytest.raises(ss.InputError, match=said):
        analysis(pair)


def test_one_body_with_an_axis_is_analysed_as_one_body(robot_run):
    """The record of a machine that lists its parts and has one of each: columns keep their axes, analyses see the same numbers."""
    named = StateLayout((BodyStates("block", 0, way=0),), (ContactStates("pad"),), ways=(0,))
    listed = replace(robot_run, pieces=replace(robot_run.pieces, layout=named))
    assert listed.x.shape == (len(listed.t), 1) and list(listed.bodies) == ["block"] and listed.events[0].part == "pad"
    assert np.array_equal(of_one_contact("test", listed, "it is one").x, robot_run.x)
    assert ss.mean_velocity(listed) == ss.mean_velocity(robot_run) and ss.motion(listed).contacts["pad"] == ss.motion(robot_run)
    assert listed.notes == robot_run.notes


def test_starts_have_the_shape_of_the_batch_also_where_its_last_axis_has_one_value():
    chain = ss.Chain.example()
    first, *others = chain.modules
    batch = chain.replace(modules=(first.replace(body_mass=np.array([[0.06], [0.07]])), *others))
    v = np.array([[0.01], [0.02]])
    found = ss.solve(batch, periods=2, start={"v": {"module 1": v}})
    assert found.shape == (2, 1)
    for i in range(2):
        one = chain.replace(modules=(first.replace(body_mass=float(batch.modules[0].body_mass[i, 0])), *others))
        alone = ss.solve(one, periods=2, start={"v": {"module 1": v[i, 0]}}, keep="summary")
        assert found.body_velocity[i, 0] == pytest.approx(alone.body_velocity, rel=1e-12)
