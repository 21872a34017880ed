"""A flow that switches, as every model is asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.models.flow_contacts import resting_contacts
from stickslip.models.friction.law_adapter import SWITCHES, LawAdapter, adapted


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
    numbers_by_case: bool = True
    turning_velocity: None = None
    unit_of_time: str = "unit of time"
    has_units: bool = False
    time_scale: None = None
    not_followed: str = ""
    angles: tuple[str, ...] = ()

    @property
    def has_displacement(self) -> bool:
        """Whether one of its states is called cyclic: its mean rate is the mean velocity."""
        return bool(self.model.cyclic)

    @property
    def own_states(self) -> tuple[str, ...]:
        """Names of its states: those of its field, and those of its contacts' laws behind them."""
        if self.model.states is None:
            why = "its states have no names, so their number is not known; type states=('x', 'v') where it is made"
            raise InputError("SwitchingFlow", [why])
        return tuple(self.model.names(len(self.model.states) + len(self.model.inner)))

    @property
    def start_names(self) -> tuple[str, ...]:
        """Names of what may be given of a start: its states."""
        return tuple(self.model.states or ())

    def column_names(self, start: Mapping[str, Any]) -> tuple[str, ...]:
        """The columns of its cases, from the names of what is given of a start where its states have none."""
        states = self.model.names((len(start) if self.model.states is None else len(self.model.states)) + len(self.model.inner))
        names = [f"{what}_{name}" for what in ("mean", "min", "max", "end") for name in states]
        names += ["end_mode", "switches", *(["mean_velocity"] if self.model.cyclic else [])]
        return (*names, *(["period"] if self.model.period is not None else []))

    def named_start(self, start: Any) -> dict[str, Any]:
        """Initial values by name, from a dict or a list of one number for each state; `InputError` for anything else."""
        if start is None or isinstance(start, dict):
            return dict(start or {})
        values = np.asarray(start, float) if isinstance(start, (list, tuple, np.ndarray)) else np.zeros(())
        own, inner = self.model.states, self.model.inner
        names = self.model.names((len(values) if values.ndim and own is None else len(own or ())) + len(inner))
        if values.ndim != 1 or len(values) not in (len(names), len(own or names)):
            allowed = "a dict, or a list of one number for each state; type start={'x': 0.1}"
            raise InputError("start", [f"start = {start!r}; allowed is {allowed}"])
        return {name: float(value) for name, value in zip(names, values, strict=False)}

    @property
    def sections(self) -> dict[str, float]:
        """The states by which a section may be cut, with a size of each: those of its field that come back."""
        field = self.model.states or ()
        scales = (1.0,) * len(field) if self.model.scales is None else self.model.scales
        return {name: float(scale) for name, scale in zip(field, scales, strict=True) if name not in self.model.cyclic}

    @property
    def switch_names(self) -> tuple[str, ...]:
        """Its switches: those of contacts that rest exactly, and those from one mode to another."""
        flow = self.model
        rests = resting_contacts(flow.contacts, *flow.given_once)
        changes = (f"{a} to {b}" for a in flow.modes for b in flow.modes if a != b or flow.switches.get(flow.labels[a][0]))
        return (*(f"{kind} of {name}" for name in rests for kind in SWITCHES), *changes)

    @property
    def event_names(self) -> tuple[str, ...]:
        """Names of what its own events happen to: its contacts."""
        return tuple(self.model.contacts)

    def mirror_image(self) -> Any:
        """Raise `InputError`: it has none that could be made of its parts."""
        why = "a flow has no direction in space: which of its states change their sign is not known"
        raise InputError("mirrored", [f"{why}; write the flow of the states with their signs changed"])

    @property
    def part_names(self) -> dict[str, tuple[str, ...]]:
        """Names for the dimensions that its columns have: none."""
        return {}

    @property
    def law_names(self) -> str:
        """The names of its laws, each once."""
        return " + ".join(dict.fromkeys(law.name for law in self.laws))

    @cached_property
    def laws(self) -> tuple[LawAdapter, ...]:
        """The laws of its contacts, of the first case where there are several."""
        return tuple(adapted(contact.law(*self.model.given_once)) for contact in self.model.contacts.values())
