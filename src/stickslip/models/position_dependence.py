"""Whether the position appears in a model's equations: asked of the equations themselves, which are called with marks for numbers."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import Model, Numeric
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.models.normal_loads import normal_load


class _Mark:
    """Stands for a number and remembers what it was made of: what is computed from marks is a mark with the names of all of them."""

    __array_ufunc__ = None  # arrays leave the operation to us

    def __init__(self, *names: str):
        self.names = frozenset(names)

    def _with(self, *others: Any) -> _Mark:
        return _Mark(*self.names.union(*map(_names, others)))

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __pow__ = __rpow__ = _with
    __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = __neg__ = __pos__ = __abs__ = _with
    __lt__ = __le__ = __gt__ = __ge__ = __and__ = __rand__ = __or__ = __ror__ = __invert__ = _with
    __ss_sin__ = __ss_cos__ = __ss_exp__ = __ss_log__ = __ss_sqrt__ = __ss_tanh__ = __ss_within__ = __ss_where__ = __ss_power__ = _with

    def __bool__(self) -> bool:
        raise TypeError("`if` on a mark")


def _names(value: Numeric) -> frozenset[str]:
    return value.names if isinstance(value, _Mark) else frozenset()


def knows_position(model: Model) -> bool:
    """Whether x appears in the load or in the acceleration of a model; where it does not, x is a quadrature and no state.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)
    >>> bench = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0))
    >>> knows_position(robot), knows_position(bench)
    (False, True)
    """
    try:
        written = replace_leaf(model, {name: _Mark("number") for name, _ in leaves(model)})
        return _appears(written, *map(_Mark, ("t", "v", "R")))
    except Exception:  # written for numbers only
        pass
    try:
        return _appears(model, 0.0, 0.0, 0.0)
    except Exception:  # it does with x what only numbers can do: so x is there
        return True


def _appears(model: Any, t: Any, v: Any, R: Any) -> bool:
    x = _Mark("x")
    values = (normal_load(model, t, x), model.acceleration(t, x, v, R))
    return any("x" in _names(value) or _of_objects(value) for value in values)


def _of_objects(value: Numeric) -> bool:
    """Whether a value is an array of marks."""
    return getattr(getattr(value, "dtype", None), "kind", "") == "O"
