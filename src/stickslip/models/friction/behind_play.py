"""A law with inner states whose contact is moved through a play: it follows on one flank or the other, and between them nothing pushes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import where
from stickslip.basics.quantities import at_least, quantity
from stickslip.models.friction.law import Law
from stickslip.models.friction.law_adapter import LawAdapter, adapted

#: Play of a drive train, as force rigs describe it.
BACKLASH = quantity("backlash", "m", "b", example=1e-4, rule=at_least(0.0))
_ASIDE = 1.0  # a guard of another mode
_SIZE = 1e-6  # of an inner state whose size the law does not say [m]


@dataclass(frozen=True, eq=False)
class BehindPlay(Law):
    r"""The force at an actuator that moves a contact through a play b, where the contact has no mass.

    On a flank the contact has the velocity v of the actuator and the actuator its friction R. Where R falls to zero the flank is left: the
    contact stays, and nothing pushes until the actuator has moved by b, or comes back.

    Its last inner state is the place g of the actuator in the play, from -b/2 to b/2; its first memory is 1 on the front flank, -1 on
    that behind, and 0 between them. The others are those of the law.

    Parameters
    ----------
    friction : law
        A law with inner states, or another dynamic one.
    backlash : float
        Play b from end to end [m].

    Examples
    --------
    >>> import stickslip as ss
    >>> law = BehindPlay(ss.Dahl(0.2, 0.2, sigma0=1e5), backlash=1e-4)
    >>> [round(law.force(v=1e-3, z=(1e-6, 0.0), zdot=(0.0, 0.0), load=1.0, mode=(flank,)), 6) for flank in (0, 1)]
    [0.0, 0.1]
    """

    friction: Any
    backlash: float = field(metadata=BACKLASH)

    @classmethod
    def example(cls) -> Any:
        """Bristles behind a tenth of a millimetre."""
        from stickslip.models.friction.dahl import Dahl

        return cls(Dahl.example(), 1e-4)

    @property
    def _own(self) -> LawAdapter:
        return adapted(self.friction)

    @property
    def states(self) -> int:
        """Those of the law, and the place in the play."""
        return self._own.states + 1

    @property
    def modes(self) -> int:
        """The flank, and those of the law."""
        return self._own.modes + 1

    def rate(self, v: Numeric, z: Any, load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Rates of the inner states: those of the law on a flank, and the actuator's velocity between them."""
        inner, _ = _split(z)
        rates = self._own.rate(v, inner, load, mode[1:])
        moved = tuple(_on_flank(mode[0], rate, 0.0 * v) for rate in rates)
        return _joined((*moved, _on_flank(mode[0], 0.0 * v, v)))

    def force(self, v: Numeric, z: Any, zdot: Any, load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Force at the actuator [N]."""
        return _on_flank(mode[0], self._friction(v, z, load, mode), 0.0 * v)

    def switches(self, v: Numeric, z: Any, load: Numeric, mode: tuple[Numeric, ...]) -> list[tuple[Any, Any, Any]]:
        """A flank is left where friction falls to zero and reached at the ends of the play; between them the law's own guards rest."""
        (inner, offset), (flank, *own), half = _split(z), mode, 0.5 * self.backlash
        friction = self._friction(v, z, load, mode)
        left = [(where(flank * side > 0, side * friction, _ASIDE), 0, side) for side in (1, -1)]
        reached = [(_on_flank(flank, _ASIDE, half - side * offset), side, side) for side in (1, -1)]
        ends = [(guard, (after, *own), _joined((*inner, side * half))) for guard, after, side in (*left, *reached)]
        kept = [
            (_on_flank(flank, guard, _ASIDE), (flank, *after), _joined((*(inner if new is None else new), offset)))
            for guard, after, new in self._own.switches(v, inner, load, tuple(own))
        ]
        return [*ends, *kept]

    def scale(self, load: Numeric) -> Any:
        """Sizes of the law's inner states, and a small way."""
        own = self._own.scale(load)
        return _joined((*((_SIZE,) * self._own.states if own is None else own), _SIZE))

    def start(self, load: Numeric) -> Any:
        """The law's own, in the middle of the play."""
        return _joined((*self._own.start(load), 0.0))

    def _friction(self, v: Numeric, z: Any, load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Friction of the contact if it moves with the actuator [N]."""
        return self._own.response(v, _split(z)[0], load, tuple(mode[1:]))[0]


def _on_flank(flank: Any, there: Any, between: Any) -> Any:
    return where(flank * flank > 0, there, between)


def _split(z: Any) -> tuple[tuple[Any, ...], Any]:
    """The law's inner states, and the place in the play."""
    parts = z if isinstance(z, tuple) else (z,)
    return parts[:-1], parts[-1]


def _joined(values: tuple[Any, ...]) -> Any:
    """Inner states as an adapter takes them: a number alone of one."""
    return values if len(values) > 1 else values[0]
