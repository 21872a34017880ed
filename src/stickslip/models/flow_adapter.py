"""A flow that switches, as every model is asked."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from stickslip.models.friction.law_adapter import LawAdapter, adapted


@dataclass(frozen=True, eq=False)
class FlowAdapter:
    """The answers of a `SwitchingFlow`.

    Examples
    --------
    >>> import stickslip as ss
    >>> FlowAdapter(ss.SwitchingFlow(lambda t, y: (y[1], -y[0]))).unit_of_time
    'unit of time'
    """

    model: Any

    has_bodies: bool = False
    has_tolerance: bool = False
    memories: int = 0  # that is its mode
    turning_velocity: None = None
    unit_of_time: str = "unit of time"
    has_units: bool = False
    angles: tuple[str, ...] = ()

    @property
    def has_displacement(self) -> bool:
        """Whether one of its states is called cyclic: its mean rate is the mean velocity."""
        return bool(self.model.cyclic)

    @cached_property
    def laws(self) -> tuple[LawAdapter, ...]:
        """The laws of its contacts, of the first case where there are several."""
        return tuple(adapted(contact.law(*self.model.given_once)) for contact in self.model.contacts.values())
