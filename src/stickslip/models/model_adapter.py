"""What is asked of any model: robots, machines that list their parts, and flows that switch answer the same questions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from stickslip.models.flow_adapter import FlowAdapter
from stickslip.models.machine_adapter import is_machine, machine_of
from stickslip.models.switching_flow import is_flow


class ModelAdapter(Protocol):
    """The questions. Who needs the equations of bodies asks `machine_of`."""

    @property
    def model(self) -> Any:
        """The model."""

    @property
    def has_bodies(self) -> bool:
        """Whether it has bodies; a flow has states of its own instead."""

    @property
    def part_names(self) -> dict[str, tuple[str, ...]]:
        """Names of bodies, contacts and stops, for the dimensions that its columns have."""

    @property
    def laws(self) -> tuple[Any, ...]:
        """The laws of its contacts."""

    @property
    def law_names(self) -> str:
        """The names of its laws, each once: "Coulomb + LuGre"."""

    @property
    def not_followed(self) -> str:
        """Why small changes are not followed along its runs; "" where they are."""

    @property
    def has_displacement(self) -> bool:
        """Whether it makes a way, and so has a mean velocity."""

    @property
    def has_tolerance(self) -> bool:
        """Whether its runs are solved to a tolerance; else they are exact to rounding."""

    @property
    def memories(self) -> int:
        """How many whole numbers its laws remember."""

    @property
    def turning_velocity(self) -> Any:
        """Velocity at which one body on a spring turns back, that of the spring's far end [m/s]; None of anything else."""

    @property
    def own_states(self) -> tuple[str, ...] | None:
        """Names that it gives its states itself; None where they follow from bodies and contacts."""

    @property
    def start_names(self) -> tuple[str, ...]:
        """Names of what may be given of a start, such as "v", or the states of a flow."""

    def named_start(self, start: Any) -> dict[str, Any]:
        """Initial values by name, from what is given as a start; `InputError` where it is none."""

    @property
    def numbers_by_case(self) -> bool:
        """Whether the numbers of a batch come from whole runs, one case at a time."""

    def column_names(self, start: Mapping[str, Any]) -> tuple[str, ...]:
        """The columns of its cases that are named after its own states, for a start by name; none where they are of bodies and contacts."""

    @property
    def sections(self) -> dict[str, float] | None:
        """Of those the states by which a section may be cut, with a size of each; None where they follow too."""

    @property
    def switch_names(self) -> tuple[str, ...]:
        """Its switches, such as "stick of block", or "free to hunted" from one mode of a flow to another."""

    @property
    def event_names(self) -> tuple[str, ...]:
        """Names of what its own events happen to: contacts and stops."""

    @property
    def mirror_image(self) -> Callable[[], Any] | None:
        """The function that makes its mirror image, if it has one."""

    @property
    def time_scale(self) -> Any:
        """A typical time; None if unknown."""

    @property
    def angles(self) -> tuple[str, ...]:
        """Names of its coordinates that are angles while others may be lengths."""

    @property
    def unit_of_time(self) -> str:
        """The unit of time, in words."""

    @property
    def has_units(self) -> bool:
        """Whether the units of its states are known."""


def is_model(value: Any) -> bool:
    """Whether an object is a machine that solvers take, or a flow."""
    return is_flow(value) or is_machine(value)


def adapter_of(model: Any) -> ModelAdapter:
    """The adapter of any model.

    Examples
    --------
    >>> import stickslip as ss
    >>> swing = ss.SwitchingFlow(lambda t, y: (y[1], -y[0]), states=("x", "v"))
    >>> [adapter_of(model).has_bodies for model in (ss.Chain.example(), ss.Joint.example(), swing)]
    [True, True, False]
    """
    return FlowAdapter(model) if is_flow(model) else machine_of(model)
