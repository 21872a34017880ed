"""Methods as objects: each says which machines it takes, and why not the others."""

from __future__ import annotations

import math

import pytest

import stickslip as ss
from every import every_machine
from problems import chain
from rows import each_row
from stickslip.engine.tableaux import TABLEAUX
from stickslip.solvers.methods import ALL, METHODS, method_for

TAKEN = {
    "Robot": "closed arcs",
    "PulledMass": "Taylor steps",
    "BlockOnBelt": "Taylor steps",
    "ForcedOscillator": "Taylor steps",
    "Chain, set-valued laws": "Taylor steps",
    "Chain, LuGre": "Rosenbrock steps",
    "capsule with an elastic stop": "Taylor steps",
    "a machine of your own": "Taylor steps",
}


@each_row("name", TAKEN)
def test_each_machine_has_its_method_and_all_others_a_reason(name):
    """The judge takes everything; of the rest exactly one solves a machine by itself, and the others say why not in a sentence."""
    machine = every_machine[name][0]
    said = {method.title: method.accepts(machine) for method in ALL if "auto" in method.names}
    assert method_for("auto", machine).title == TAKEN[name] and said["SciPy"] is None
    assert [title for title, reason in said.items() if reason is None] in ([TAKEN[name], "SciPy"], ["closed arcs", "Taylor steps", "SciPy"])
    assert all(len(reason) > 20 for reason in said.values() if reason is not None)


def test_what_runs_is_named_by_the_run():
    pair = chain(0.0, 1.0)
    assert ss.solve(pair, periods=1).method == "exact"
    assert ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), periods=1, rtol=1e-3).method == "Taylor8"
    assert ss.solve(pair, periods=1, method="dop853").method == "dop853"


def test_an_error_has_what_each_method_of_the_name_said():
    lugre = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    with pytest.raises(ss.InputError, match=r"closed arcs: LuGre is a dynamic law.*; Taylor steps: it is for set-valued laws; LuGre has"):
        ss.solve(lugre, periods=1, method="exact")
    with pytest.raises(ss.InputError, match=r"Rosenbrock steps: it is for laws with inner states; .*Coulomb.* is set-valued; type method="):
        ss.solve(chain(0.0, 1.0), periods=1, method="rodas5p")
    with pytest.raises(ss.InputError, match="Runge-Kutta steps: it takes one body on one contact, and this machine lists several"):
        ss.solve(chain(0.0, 1.0), periods=1, method="rk4")
    with pytest.raises(ss.InputError, match="it knows robots without impulses or memory; here is a mechanism with springs"):
        ss.solve(every_machine["BlockOnBelt"][0], duration=1.0, method="rk4")


def test_the_equations_decide_and_not_a_class():
    """A robot whose friction grows with speed has no closed arcs."""
    drive = ss.Harmonic(6e-4, 65.4 * math.pi)
    plain = ss.Robot(0.06259, 0.00948, drive, ss.Coulomb(0.15, 0.21))
    viscous = plain.replace(friction=ss.CoulombViscous.example())
    assert method_for("exact", plain).title == "closed arcs" and method_for("exact", viscous).title == "Taylor steps"
    assert set(METHODS) == {"auto", "exact", *TABLEAUX, "taylor", "rk4", "radau", "lsoda", "bdf", "dop853"}
