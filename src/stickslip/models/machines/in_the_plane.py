"""What ready-made machines in the plane have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.maths import pi, sin
from stickslip.basics.quantities import at_least, positive, quantity, remarks_on_gravity
from stickslip.models.forces import check_law
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.parts import Spring

PUSH = quantity("force of the push", "N", "F", example=4.0, rule=at_least(0.0))
PUSHED_AT = quantity("angular frequency of the push", "rad/s", r"\omega", example=5.0, rule=positive)


class InThePlane(Machine):
    """Base of those that gravity pulls down and something drives at the angular frequency `omega`."""

    _laws: ClassVar[tuple[str, ...]] = ("friction",)  # its fields that are friction laws

    @property
    def period(self: Any) -> Any:
        """Time after which what drives it repeats [s]."""
        return 2 * pi / self.omega

    @property
    def notes(self: Any) -> list[str]:
        """Remarks on these numbers that are not errors."""
        return remarks_on_gravity(self.gravity)

    def _check(self, problems: Problems) -> None:
        for name in self._laws:
            check_law(getattr(self, name), problems)
        self._check_numbers(problems)
        if not problems.mistakes:
            super()._check(problems)

    def _check_numbers(self, problems: Problems) -> None:
        """Note what is wrong with its numbers beside what each of them says."""


class PushedOnSpring(InThePlane):
    """Base of those with a first coordinate x that is pushed to and fro, and that a spring may hold."""

    def _check_numbers(self: Any, problems: Problems) -> None:
        if self.stiffness is None and np.any(np.asarray(self.damping) != 0.0):
            problems.add(f"damping = {self.damping!r} is given alone, and there is no spring; type stiffness=0.0 for a damper without one")

    def _push(self: Any) -> Callable[[Numeric, Any, Any], Any]:
        """The force on its first body."""

        def pushed(t: Numeric, x: Any, v: Any) -> Any:
            return (self.push * sin(self.omega * t), 0.0)

        return pushed

    def links(self: Any) -> Mapping[Any, Any]:
        """The spring that holds it."""
        return {} if self.stiffness is None else {("x", None): Spring(self.stiffness, self.damping)}
