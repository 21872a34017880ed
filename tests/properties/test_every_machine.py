"""Every machine at every door: it works, or it is refused with a reason; nothing else, and no silent answer about the first body."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import pytest

import stickslip as ss
from every import Case, all_machines, door_of, every_door, every_machine, in_the_plane, not_on_page, without_line, wrong_line
from registries import tell
from rows import each_row
from stickslip.analysis.losses_at_instants import lost_at_hits
from stickslip.mechanisms import MECHANISMS

PAGE = Path(__file__).parents[2] / "notes" / "which-machine.md"
sys.path.insert(0, str(PAGE.parents[1] / "docs" / "_ext"))

import which_machine  # noqa: E402
from which_machine import cell, kept_table, lacking, not_yes_or_no, table, unknown  # noqa: E402


def kept():
    return kept_table(PAGE.read_text(encoding="utf-8"))


def test_every_kind_of_machine_has_a_line():
    """First of all: without its line and its column a machine fails at every door, for this one reason."""
    tell([sentence for made in MECHANISMS.values() for sentence in without_line(made)])
    tell([sentence for name, line in all_machines.items() for sentence in wrong_line(name, line)])


def test_the_page_lists_every_machine_and_every_door():
    tell([sentence for name in all_machines for sentence in not_on_page(name, kept())])
    left = sorted({name for name, _ in kept()} - set(all_machines))
    left += sorted({door for _, door in kept()} ^ set(every_door))
    assert not left, f"{', '.join(left)}: not both in tests/every.py and on the page; type python docs/_ext/which_machine.py"
    assert table(kept()) in PAGE.read_text(encoding="utf-8")


def test_a_machine_that_is_not_known_is_refused_before_any_is_tried():
    with pytest.raises(SystemExit, match=r"'Robto' is given; did you mean 'Robot'\?$"):
        which_machine.main("Robot", "Robto")
    allowed = "'sled' is given, and every_machine in tests/every.py has no such machine; allowed are 'Robot', 'Chain, LuGre'"
    assert unknown(["sled"], {"Robot": 0, "Chain, LuGre": 0}) == [allowed]


def test_a_page_that_lacks_another_machine_says_to_name_that_one_too():
    both, end = {"Robot": 0, "Joint": 0}, "; type its name too, or no name, which tries all"
    at_all, at_one = lacking(["Robot"], both, ["CSV", "report"], {}), lacking(["Robot"], both, ["CSV", "report"], {("Joint", "CSV"): "yes"})
    assert at_all == [f"notes/which-machine.md lacks 'Joint' at every door{end}"]
    assert at_one == [f"notes/which-machine.md lacks 'Joint' at report{end}"]


@pytest.fixture(params=[*every_machine, *(pytest.param(name, marks=pytest.mark.slow) for name in in_the_plane)], scope="module")
def case(request, tmp_path_factory):
    tell(not_on_page(request.param, kept()))
    return Case(request.param, *all_machines[request.param], tmp_path_factory.mktemp("every"))


@each_row("door", every_door)
def test_every_machine_is_taken_or_refused_with_a_reason(case, door):
    """As the page says: a door that opens and is not in the table, or closes and is, is as wrong as an AttributeError."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            found = cell(door_of(door, case), case)
        except Exception as error:
            error.add_note(not_yes_or_no(case.name, door))
            raise
    told = kept().get((case.name, door), "nothing")
    assert found == told, f'if that is meant, python docs/_ext/which_machine.py "{case.name}" writes the page anew'


def test_a_list_where_parts_are_meant_says_to_write_a_tuple():
    pair = ss.Chain.example()
    with pytest.raises(ss.InputError, match=r"this is a list, and several parts are given as a tuple; .* type modules=\(head, tail\)"):
        ss.Chain(list(pair.modules), pair.link)
    with pytest.raises(ss.InputError, match="this is a list, and several links are given as a tuple"):
        ss.Chain(pair.modules, [pair.link])


@each_row(
    "chain",
    [
        ss.Chain.example(),
        ss.Chain.example().replace({"phases.1": [0.1, 0.2, 0.3]}),
        ss.Chain(ss.Chain.example().modules * 2, link=(ss.Spring(1.0), ss.machines.Rigid(), ss.Spring(2.0, 0.1, 0.03))),
        ss.Chain((ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), ss.Chain.example().modules[0]), link=ss.machines.Rigid()),
    ],
)  # fmt: skip
def test_chains_come_back_from_their_files(chain):
    assert ss.Chain.from_toml(chain.to_toml()) == chain
    assert chain.to_toml().startswith('[mechanism]\nkind = "chain"')


@each_row(
    ("old", "new", "said"),
    [
        ('kind = "spring"', 'kind = "springy"', "mechanism.link.kind = 'springy'; did you mean 'spring'"),
        ("body_mass", "body_mas", "mechanism.modules.0.body_mas is not known; did you mean 'body_mass'"),
        ("[mechanism.link]", "[mechanism.lonk]", r"\[mechanism.link\] is missing or no table"),
        ("stiffness = 1200.0", "stiffness = -1.0", "mechanism.link.stiffness = -1.0; allowed is zero or more"),
    ],
)
def test_what_is_wrong_with_a_chain_in_a_file_is_said(old, new, said):
    with pytest.raises(ss.InputError, match=said):
        ss.Chain.from_toml(ss.Chain.example().to_toml().replace(old, new))


def test_a_run_of_a_machine_of_ones_own_asks_for_its_class(tmp_path):
    tow = every_machine["a machine of your own"][0]
    path = ss.solve(tow, periods=4).save(tmp_path / "run.nc")
    with pytest.raises(ss.InputError, match=r"the machine Tow, which is not part of stickslip; .* type ss.load\(path, machines=\[Tow\]\)"):
        ss.load(path)
    assert ss.load(path, machines=[type(tow)]).model == tow


def test_equal_modules_move_as_one_of_them_alone():
    """Each contact of a chain in phase is the contact of one robot: same pattern, same margin, by other code for the forces."""
    robot = every_machine["Robot"][0]
    chain = ss.motion(ss.solve(ss.Chain((robot, robot), ss.Spring(1200.0, 0.4)), periods=60))
    alone = ss.motion(ss.solve(robot, periods=60))
    for each in chain.contacts.values():
        assert (each.type, each.pattern, each.period, each.direction) == (alone.type, alone.pattern, alone.period, alone.direction)
        assert each.margin == pytest.approx(alone.margin, rel=1e-9) and each.stick_fraction == pytest.approx(alone.stick_fraction, rel=1e-9)
    with pytest.raises(AttributeError, match=r"no type as a whole; type motion.contacts\[name\].type"):
        chain.type  # noqa: B018


def test_contacts_that_never_move_are_anchored():
    robot = every_machine["Robot"][0]
    run = ss.solve(ss.Chain((robot, robot.replace(body_mass=3.0)), ss.Spring(1200.0, 0.4)), periods=60)
    m = ss.motion(run)
    assert m.anchored == ("module 2",) and m.contacts["module 2"].type == "rest"
    assert not run.contacts["module 2"].mode.any()


def test_bodies_that_drift_apart_are_noted():
    robot = every_machine["Robot"][0]
    apart = ss.solve(ss.Chain((robot, robot.replace(body_mass=3.0)), ss.Spring(0.0)), periods=60)
    assert any("module 1 and module 2 drift apart" in note for note in apart.notes)
    together = ss.solve(ss.Chain((robot, robot), ss.Spring(1200.0, 0.4)), periods=60)
    assert not any("drift" in note for note in together.notes)


def test_energy_of_several_bodies_is_balanced_to_rounding():
    """Friction, dampers, an elastic stop, a moving belt and hits: each period's balance closes as it does for one robot."""
    from dataclasses import dataclass

    from every import DRY, Capsule

    @dataclass(frozen=True, eq=False)
    class OnBelt(Capsule):
        def contacts(self):
            return {"capsule": ss.Contact("capsule", self.friction, load=1.5, on=0.05)}

        def stops(self):
            return {("hammer", "capsule"): ss.Stop(gap=self.gap, restitution=0.4)}

    soft, hits = (ss.solve(cls(300.0, DRY), periods=30) for cls in (Capsule, OnBelt))
    assert ss.energy(soft).damping[-1] > 0.1 * ss.energy(soft).friction[-1]
    lost = [loss for _, loss, _, _ in lost_at_hits(hits, hits.model.mechanics)]
    assert max(lost) > 1e-3 * ss.energy(hits).drive[-1]
    assert max(ss.energy(run).worst for run in (soft, hits)) < 1e-10  # exact runs: rounding of some hundred steps in a period


def test_columns_of_one_contact_are_asked_of_several_in_vain():
    many = ss.solve(ss.Chain.example().replace({"phases.1": [0.5, 1.0]}), periods=12)
    with pytest.raises(AttributeError, match="it is of one body on one contact, and a Chain lists several; there are mean_vel"):
        many.drive_power  # noqa: B018
    with pytest.raises(AttributeError, match="it is of stops, and this Chain has none; there are mean_vel"):
        many.hits  # noqa: B018
    grid = ss.map(ss.Chain.example(), **{"phases.1": [0.5, 1.0], "link.stiffness": [500.0, 1200.0]}, periods=12)
    with pytest.raises(ss.InputError, match=r"the dataset has motion_type of each contact \(module 1, module 2\); choose one"):
        ss.plot.motion_map(grid)
