"""What functions read besides their arguments is searched: a change of any of it is noticed, and what cannot be compared is said."""

import collections
import functools
import itertools
import os
import pathlib
import random
import time
import types
from dataclasses import dataclass
from typing import Any

import numpy as np

import stickslip as ss
from rows import each_row
from stickslip.basics.references import References
from stickslip.engine import kinds
from stickslip.maths import sin

OWN = types.ModuleType("helper_of_a_user")
exec("K = 2.0\ndef scaled(x):\n    return K * x\n", vars(OWN))
FACTOR, LAW = 2.0, ss.Coulomb(0.1, 0.2)
Pair = collections.namedtuple("Pair", "a b")


class Held:
    """An object of a user with attributes, and a number of its class."""

    of_class = 3.0

    def __init__(self, k):
        self.k = k
        self.inner = None

    def force(self, x):
        return -self.k * x

    @property
    def twice(self):
        return 2.0 * self.of_class


HELD, NESTED, ARRAY, LISTED = Held(1.0), {"a": [{"b": 1.0}]}, np.array([1.0, 2.0]), [1.0, Held(2.0)]


def _inner(x):
    return FACTOR * x


def _replaced(y):
    return 3.0 * y


def _default(x, k=2.0):
    return k * x


def closure():
    k = 1.0

    def force(x):
        return (lambda: k * x)()

    def change():
        nonlocal k
        k = 2.0

    return force, change


def _set(owner, name, value):
    return lambda: setattr(owner, name, value)


def _changed_global(name, value):
    return lambda: globals().__setitem__(name, value)


class Child(Held):
    """Inherits what is changed in its base."""


#: For each way: the function, and what changes it.
WAYS = {
    "a global number": lambda: (lambda x: FACTOR * x, _changed_global("FACTOR", 5.0)),
    "a global number of a function within": lambda: (lambda x: sum(FACTOR * y for y in [x]), _changed_global("FACTOR", 6.0)),
    "a global number of a helper": lambda: (lambda x: _inner(x), _changed_global("FACTOR", 7.0)),
    "a helper that is replaced": lambda: (lambda x: _inner(x), _changed_global("_inner", lambda x: x)),
    "a name that hides one of Python": lambda: (lambda x: max(x, 0.0), _changed_global("max", lambda a, b: a)),
    "the code of a helper": lambda: (lambda x: _replaced(x), _set(_replaced, "__code__", (lambda y: y).__code__)),
    "a default": lambda: (lambda x: _default(x), _set(_default, "__defaults__", (9.0,))),
    "a variable of the function around": closure,
    "a number of a module": lambda: (lambda x: OWN.K * x, _set(OWN, "K", 3.0)),
    "a number of a helper in a module": lambda: (lambda x: OWN.scaled(x), _set(OWN, "K", 4.0)),
    "a global law": lambda: (lambda x: LAW.sliding(x, 1.0), _changed_global("LAW", ss.Coulomb(0.3, 0.3))),
    "an attribute": lambda: (lambda x: HELD.k * x, _set(HELD, "k", 2.0)),
    "an attribute of an attribute": lambda: (
        lambda held: setattr(held, "inner", Held(1.0)) or (lambda x: held.inner.k * x, _set(held.inner, "k", 2.0))
    )(Held(1.0)),
    "a bound method": lambda: (HELD.force, _set(HELD, "k", 5.0)),
    "a number of a class": lambda: (lambda x: HELD.twice * x, _set(Held, "of_class", 4.0)),
    "a number of a base": lambda: (Child(1.0).force, _set(Held, "of_class", 8.0)),
    "a method of a class": lambda: (Child(1.0).force, _set(Held, "force", lambda self, x: x)),
    "deep in lists and dictionaries": lambda: (lambda x: NESTED["a"][0]["b"] * x, lambda: NESTED["a"][0].__setitem__("b", 2.0)),
    "a list": lambda: (lambda x: LISTED[0] * x, lambda: LISTED.__setitem__(0, 2.0)),
    "a list that grows": lambda: (lambda x: len(LISTED) * x, lambda: LISTED.append(1.0)),
    "an array": lambda: (lambda x: ARRAY[0] * x, lambda: ARRAY.__setitem__(0, 3.0)),
    "a partial": lambda: (functools.partial(lambda held, x: held[0] * x, (given := [1.0])), lambda: given.__setitem__(0, 2.0)),
    "a cached function": lambda: (functools.lru_cache(lambda x: FACTOR * x), _changed_global("FACTOR", 8.0)),
    "a tuple with names": lambda: ((lambda pair: lambda x: pair.a[0] * x)(Pair(given := [1.0], 0.0)), lambda: given.clear()),
}


@each_row("name", WAYS)
def test_a_change_of_what_a_function_reads_is_noticed(name):
    function, change = WAYS[name]()
    read = References(function)
    assert read.complete and read.unchanged()
    change()
    globals_of_test = globals()
    try:
        assert not read.unchanged()
    finally:
        globals_of_test.pop("max", None)


def _of_a_module_to_come(x):
    import helper_to_come

    return helper_to_come.K * x


draw, counter = np.random.default_rng(1), itertools.count()
UNKNOWN = {
    "a clock": lambda x: time.time() * x,
    "a draw": lambda x: random.random() * x,
    "a draw of numpy": lambda x: np.random.uniform() * x,
    "a generator": lambda x: draw.normal() * x,
    "a counter": lambda x: next(counter) * x,
    "the environment": lambda x: float(os.environ["K"]) * x,
    "a file": lambda x: float(pathlib.Path("k.txt").read_text()) * x,
    "a table": lambda x: np.loadtxt("k.txt")[0] * x,
    "a name made of text": lambda x: globals()["FACTOR"] * x,
    "an attribute made of text": lambda x: getattr(HELD, "k" + "") * x,
    "text as code": lambda x: eval("FACTOR * x"),
    "a module that is not imported yet": _of_a_module_to_come,
    "a large array": (lambda many: lambda x: many[0] * x)(np.zeros(100_000)),
}


@each_row("name", UNKNOWN)
def test_what_cannot_be_compared_makes_a_list_incomplete(name):
    assert not References(UNKNOWN[name]).complete


MODELS = {
    "LuGre": lambda: ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4),
    "Coulomb": lambda: ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"),
    "a chain": ss.Chain.example,
    "a joint": ss.Joint.example,
}


@each_row("name", MODELS)
def test_machines_of_the_package_are_not_asked_again(name, monkeypatch):
    model = MODELS[name]()
    kinds.check_functions(model)
    monkeypatch.setattr(kinds, "fresh_mechanics", None)
    kinds.check_functions(model)


def test_a_method_that_is_put_into_a_class_of_the_package_is_noticed(monkeypatch):
    read = References(MODELS["Coulomb"]())
    monkeypatch.setattr(ss.Coulomb, "sliding", lambda self, v, load: 0.05 * load)
    assert read.complete and not read.unchanged()
    assert References(MODELS["Coulomb"]()).patched and not read.patched


@dataclass(frozen=True, eq=False)
class Driven(ss.Machine):
    """A machine of parts that reads a name."""

    law: Any
    time_scale = 1.0

    def bodies(self):
        return {"block": ss.Body(1.0, force=lambda t, x, v: sin(t) - FACTOR * x)}

    def contacts(self):
        return {"block": ss.Contact("block", self.law, load=1.0)}


def test_a_machine_of_parts_is_asked_again_only_when_a_name_has_changed(monkeypatch):
    machine = Driven(ss.Coulomb(0.1, 0.1))
    kinds.check_functions(machine)
    before = kinds.kind_of(machine)
    kinds.check_functions(machine)
    assert kinds.kind_of(machine) == before
    monkeypatch.setitem(globals(), "FACTOR", 11.0)
    kinds.check_functions(machine)
    assert kinds.kind_of(machine) != before
