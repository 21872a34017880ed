"""The identity of traced equations: a hash that two models share if, and only if, their kernels compute the same."""

from __future__ import annotations

import dataclasses
import hashlib
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.engine.observed import Observed
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.trace import trace


def equation_hash(model: Model, observe: Observed = ()) -> str:
    """Hash of the equations of a model, and of the observables that are evaluated beside them.

    The numbers of the model are symbols in it; numbers that its methods take from elsewhere are constants.

    Parameters
    ----------
    model : Robot or other machine
    observe : tuple of (str, Observable)
        Names and functions of the state.

    Returns
    -------
    str

    Raises
    ------
    InputError
        If the model cannot be traced.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.coulomb_robot(0.5, 0.9)
    >>> first = equation_hash(robot)
    >>> first == equation_hash(robot.replace(gravity=9.8)), first == equation_hash(robot.replace(friction=ss.LuGre.example()))
    (True, False)
    """
    return _Hashes().of(trace(model, observe)).hex()


class _Hashes:
    """Hashes of expressions and of records that hold them; each expression is hashed once."""

    def __init__(self) -> None:
        self._known: dict[int, bytes] = {}

    def of(self, value: Any) -> bytes:
        """The hash of a part of the equations."""
        if isinstance(value, Sym):
            return self._expression(value)
        if dataclasses.is_dataclass(value):
            parts = [(f.name, getattr(value, f.name)) for f in dataclasses.fields(value)]
            return _hash(type(value).__name__, *(self.of(part) for part in parts if not isinstance(part[1], Graph)))
        if isinstance(value, dict):
            return _hash("dict", *sorted(self.of(item) for item in value.items()))
        if isinstance(value, (tuple, list)):
            return _hash("tuple", *map(self.of, value))
        return _hash(type(value).__name__, repr(value))

    def _expression(self, node: Sym) -> bytes:
        known, waiting = self._known, [node]
        while waiting:
            now = waiting[-1]
            missing = [arg for arg in now.args if arg.number not in known]
            if missing and now.number not in known:
                waiting += missing
                continue
            waiting.pop()
            value = float(now.value).hex() if now.op == "constant" else ""
            known[now.number] = _hash(now.op, now.name, value, *(known[arg.number] for arg in now.args))
        return known[node.number]


def _hash(*parts: str | bytes) -> bytes:
    made = hashlib.blake2b(digest_size=16)
    for part in parts:
        text = part.encode() if isinstance(part, str) else part
        made.update(b"%d:" % len(text) + text)
    return made.digest()
