"""The only caller of friction laws: one interface to any law, with defaults for optional methods.

A law takes and gives a number for one inner state and a tuple for several; here states are a tuple always. What a law need not have
(`states`, `modes`, `switches`, `scale`, `start`, `velocity_scale`, `notes`, an argument `applied`) has its default here and nowhere else.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import itertools
from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Law, Numeric
from stickslip.basics.errors import InputError, OneContactNeeded
from stickslip.basics.maths import sqrt, where

SWITCHES = ("stick", "slip")  #: of a contact that rests exactly, called "stick of belt"
TINY = 1e-300  # a velocity that has a sign and nothing else
_NO_LESS = 1e-150  # a velocity whose square is a number
#: Of the velocity scale, the creep that is lost in the rounding of slips and of the instants at which steps end; and that of a slip that is
#: a difference of velocities, which steps follow less exactly.
_LEAST_CREEP, _LEAST_DIFFERENCE = 1e-12, 1e-9

States = tuple[Any, ...]
#: What ends a mode: guards that fall to zero, each with the modes and the inner states (None: unchanged) after it.
Switches = list[tuple[Any, tuple[Any, ...], States | None]]


@dataclass(frozen=True, eq=False)
class LawAdapter:
    """A friction law, asked in one way.

    Parameters
    ----------
    law : law
        Any law; a set-valued one has no states and no modes.
    dynamic : bool
        Whether it has `rate` and `force`, and so never rests exactly.
    states, modes : int
        Number of inner states, and of whole-number memories.
    switching : bool
        Whether it has `switches`, and so takes its modes.
    restitution : float, optional
        Of a contact that flies where its load falls to zero, and lands again: velocity of parting over velocity of approach. Its states
        are then the gap [m] and the gap's rate [m/s]. None: a run ends there.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = adapted(ss.Dahl.example())
    >>> law.states, law.modes, law.rate(v=1e-3, z=(0.0,), load=0.7)
    (1, 0, (0.001,))
    """

    law: Any
    dynamic: bool
    states: int
    modes: int
    switching: bool
    restitution: Any = None

    @property
    def flies(self) -> bool:
        """Whether its contact leaves where the load falls to zero, and lands again."""
        return self.restitution is not None

    @property
    def has_slip_ratio(self) -> bool:
        """Whether inner states say how far its friction is from that of sliding; a set-valued law slides or rests."""
        return self.dynamic and self.states > 0

    def rate(self, v: Numeric, z: States, load: Numeric, mode: States = ()) -> States:
        """Rates of the inner states."""
        return self._shaped(self.law.rate(v, self._own(z), load, *self._held(mode)), "rate") if self.dynamic else ()

    def force(self, v: Numeric, z: States, zdot: States, load: Numeric, mode: States = (), applied: Numeric = 0.0) -> Any:
        """Friction force [N]; of a set-valued law while it slides. `applied` is what would keep the velocity constant [N]."""
        if not self.dynamic:
            return self.law.sliding(v, load)
        more = (*self._held(mode), *((applied,) if self.needs_applied else ()))
        return self.law.force(v, self._own(z), self._own(zdot), load, *more)

    def response(
        self, v: Numeric, z: States, load: Numeric, mode: States = (), applied: Numeric = 0.0, least: Numeric = 0.0
    ) -> tuple[Any, States]:
        """Friction force [N], and the rates of the inner states."""
        zdot = self.rate(v, z, load, mode)
        return self.resolved(least, v, z, zdot, load, mode, applied), zdot

    def resolved(self, least: Any, v: Any, z: States, zdot: States, load: Any, mode: States = (), applied: Any = 0.0) -> Any:
        """Friction force [N] where velocities below `least` cannot be told from rounding.

        A law that creeps gives forces of all sizes to them. Below w = `least` its force is therefore proportional to the velocity:
        R = |v|/r R(r sign v) with r^2 = v^2 + w^2, which differs from the law by parts of w^2/v^2.
        """
        if self.creep_velocity(z, load) is None:
            return self.force(v, z, zdot, load, mode, applied)
        size = sqrt(v * v + (least + _NO_LESS) ** 2)
        return abs(v) / size * self.force(where(v > 0.0, 1.0, -1.0) * size, z, zdot, load, mode, applied)

    @staticmethod
    def least_creep(scale: Numeric, difference: bool = False) -> Any:
        """The velocity below which friction that creeps is taken to be proportional to it, in motions of such a velocity [m/s]."""
        return (_LEAST_DIFFERENCE if difference else _LEAST_CREEP) * scale

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """Friction force of a set-valued law at a velocity that is not zero [N]."""
        return self.law.sliding(v, load)

    def breakaway(self, load: Numeric) -> tuple[Any, Any]:
        """Forces (backward, forward) up to which a set-valued law holds a body [N]."""
        backward, forward = self.law.breakaway(load)
        return backward, forward

    def limits(self, load: Numeric) -> tuple[Any, Any] | None:
        """Forces (backward, forward) up to which any law holds a body [N], a dynamic one by its coefficients; None where it has none."""
        if not self.dynamic:
            try:
                return self.breakaway(load)
            except InputError:  # the stand-in for a law whose class is not known
                return None
        minus, plus = (self._static(side) for side in ("minus", "plus"))
        return None if minus is None or plus is None else (-minus * load, plus * load)

    def switches(self, v: Numeric, z: States, load: Numeric, mode: States) -> Switches:
        """Guards that end a mode; empty for a law without modes."""
        if not self.switching:
            return []
        switches = self.law.switches(v, self._own(z), load, mode)
        return [(guard, tuple(after), None if new is None else self._shaped(new, "switches")) for guard, after, new in switches]

    def passed_zero(self, z: States, load: Numeric, mode: States, side: int = 1) -> tuple[States, States]:
        """Inner states and modes once v has come to zero from a side: after every switch that waits for it and for nothing else."""
        done: set[int] = set()
        while True:
            at, near = (self.switches(v, z, load, mode) for v in (0.0, side * TINY))
            due = [k for k, (here, ahead) in enumerate(zip(at, near, strict=True)) if here[0] <= 0 < ahead[0] and k not in done]
            if not due:
                return z, mode
            _, mode, new = at[due[0]]
            z = z if new is None else new
            done.add(due[0])

    def scale(self, load: Numeric) -> States | None:
        """Typical size of each inner state, where the law says it."""
        own = getattr(self.law, "scale", None)
        return None if own is None else self._shaped(own(load), "scale")

    def slip_length(self, load: Numeric) -> Any:
        """Slip over which its inner states change [m]: what the law says; None where it does not, and its states are deflections."""
        own = getattr(self.law, "slip_length", None)
        return None if own is None else own(load)

    def start(self, load: Numeric) -> States:
        """Inner states of a contact that nobody has moved: what the law says, else zeros."""
        return self._shaped(self.law.start(load), "start") if self.has_start else (0.0,) * self.states

    def velocity_scale(self) -> Any:
        """A velocity over which friction changes [m/s]; None where the law has none."""
        own = getattr(self.law, "velocity_scale", None)
        return None if own is None else own()

    def creep_velocity(self, z: States, load: Numeric) -> Any:
        """Velocity up to which friction is proportional to it, in these inner states [m/s]; None where the law does not say."""
        own = getattr(self.law, "creep_velocity", None)
        return None if own is None else own(self._own(z), load)

    def notes(self, load: Numeric) -> list[str]:
        """The law's notes on its own numbers."""
        own = getattr(self.law, "notes", None)
        return [] if own is None else list(own(load))

    def cautions(self, load: Numeric) -> list[str]:
        """What the law says where its energy is examined, in `check` and on the bench, and nowhere else."""
        own = getattr(self.law, "cautions", None)
        return [] if own is None else list(own(load))

    @functools.cached_property
    def needs_applied(self) -> bool:
        """Whether its force must know the friction force that would hold the body."""
        kind: Any = type(self.law)
        return self.dynamic and _takes_applied(kind)

    @property
    def has_start(self) -> bool:
        """Whether the law says in which inner states a contact is that nobody has moved."""
        return bool(self.states) and callable(getattr(self.law, "start", None))

    @property
    def holds_velocity(self) -> bool:
        """Whether it balances the other forces without any state: the velocity with which a body comes to rest then stays."""
        return self.dynamic and not self.states and not self.modes

    @property
    def compiles(self) -> bool:
        """Whether the engine can trace it; a law that says `scalar_only` is solved in plain Python."""
        return not getattr(self.law, "scalar_only", False)

    @property
    def random(self) -> bool:
        """Whether it draws by chance."""
        return bool(getattr(self.law, "random", False))

    @property
    def name(self) -> str:
        """The law's `title`, if it has one as sums do; else the name of its class."""
        title = getattr(self.law, "title", None)
        return title if isinstance(title, str) else type(self.law).__name__

    def _static(self, side: str) -> Any:
        """Static friction coefficient of a law that names one, else the kinetic one, else None."""
        f = getattr(self.law, f"f_{side}", None)
        return getattr(self.law, f"mu_{side}", None) if f is None else f

    def _own(self, values: States) -> Any:
        """Inner states as the law takes them."""
        return values[0] if self.states == 1 else tuple(values)

    def _held(self, mode: States) -> tuple[States, ...]:
        """The modes as a law takes them that has any."""
        return (mode,) if self.switching else ()

    def _shaped(self, value: Numeric, what: str) -> States:
        """The law's values for its inner states, as a tuple of the right length."""
        values = tuple(value) if isinstance(value, (tuple, list)) else (value,)
        if len(values) != self.states:
            states = f"{self.states} inner state{'' if self.states == 1 else 's'} (class attribute states)"
            raise InputError(self.name, [f"{what} gives {len(values)} values; the law has {states}"])
        return values


def is_law(value: Numeric) -> bool:
    """Whether something (or what its class makes) has the methods of a set-valued or a dynamic law."""
    return _is_dynamic(value) or (hasattr(value, "sliding") and hasattr(value, "breakaway"))


def _is_dynamic(value: Any) -> bool:
    return hasattr(value, "rate") and hasattr(value, "force")


def adapted(law: Law, restitution: Numeric | None = None) -> LawAdapter:
    """A law, to be asked in one way; with a restitution its contact may fly, unless it has inner states, which no hit throws."""
    dynamic = _is_dynamic(law)
    switching = dynamic and hasattr(law, "switches")
    flies = not dynamic and restitution is not None
    return LawAdapter(
        law=law,
        dynamic=dynamic,
        states=int(getattr(law, "states", 1)) if dynamic else 2 * flies,
        modes=int(getattr(law, "modes", 0)) if switching else 0,
        switching=switching,
        restitution=restitution if flies else None,
    )


def law_of(model: Any) -> LawAdapter:
    """The law of a model's only contact, to be asked in one way; an error of a machine that lists contacts."""
    if callable(getattr(model, "contacts", None)):
        raise OneContactNeeded.of(model, "law")
    return adapted(model.friction)


@functools.lru_cache(maxsize=256)
def _takes_applied(kind: Any) -> bool:
    return "applied" in inspect.signature(kind.force).parameters


def mirrored_law(law: LawAdapter) -> Any:
    """The law as it is for who looks from the other side: what its own `mirrored()` says, else plus and minus exchanged, in parts too.

    Examples
    --------
    >>> import stickslip as ss
    >>> mirrored_law(ss.Coulomb(mu_plus=0.15, mu_minus=0.21))
    Coulomb(mu_plus=0.21, mu_minus=0.15, f_plus=None, f_minus=None)
    """
    if hasattr(law, "mirrored"):
        return law.mirrored()
    numbers = {f.name: getattr(law, f.name) for f in dataclasses.fields(law) if f.init}
    changes = {name: _mirrored_parts(value) for name, value in numbers.items()}
    for name, backward in numbers.items():
        stem = name.removesuffix("_minus")
        forward = next((n for n in (f"{stem}_plus", stem) if n in numbers and n != name), None) if stem != name else None
        if forward is not None and (forward != stem or backward is not None):  # z_ba_minus=None means z_ba
            changes |= {name: numbers[forward], forward: backward}
    return dataclasses.replace(law, **changes)


def _mirrored_parts(value: Numeric) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_mirrored_parts, value))
    return mirrored_law(value) if dataclasses.is_dataclass(value) and not isinstance(value, type) else value


_SLIPS, _LOADS = (-1.0, -1e-3, 1e-3, 1.0), (0.0, 1e-3, 1.0, 3.0, 100.0)  # at which laws are asked how they grow with the load


def is_affine(law: LawAdapter) -> bool:
    """Whether the sliding force of a law grows with the load at one rate: what it makes of an impulse is then known."""
    import numpy as np

    for v in _SLIPS:
        forces = [np.asarray(law.sliding(v, load), float) for load in _LOADS]
        rates = [(b - a) / (q - p) for (a, b), (p, q) in zip(itertools.pairwise(forces), itertools.pairwise(_LOADS), strict=True)]
        if any(np.any(abs(rate - rates[0]) > 1e-9 * (abs(rate) + abs(rates[0]))) for rate in rates):
            return False
    return True
