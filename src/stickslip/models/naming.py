"""Names of the axes of a sweep, from the maker's own description of its numbers."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

from stickslip.basics.arguments import described_arguments
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import field_description, is_record, leaves
from stickslip.basics.number_names import numbers_meant
from stickslip.basics.quantities import axis_in, pretty_unit, quantity
from stickslip.basics.typed_numbers import in_unit

_START = {
    "start.x": quantity("position at the start", "m", "x"),
    "start.v": quantity("velocity at the start", "m/s", "v"),
    "start.z": quantity("inner state at the start", "m", "z"),
}


def description_of(name: str, make: Any = None) -> Mapping[str, Any]:
    """The description of a number of a record, or of an argument of its maker; empty if it has none."""
    if name in _START:
        return _START[name]
    if callable(make):
        described = described_arguments(make)
        return next((described[each] for each in numbers_meant(name, described)), {})
    return field_description(make, name) or next((field_description(make, each) for each in _meant(make, name)), {})


def _meant(record: Any, name: str) -> tuple[str, ...]:
    """The numbers of a record that a name stands for."""
    return numbers_meant(name, (each for each, _ in leaves(record))) if is_record(record) else ()


def axis_of(name: str, make: Any = None) -> tuple[str, str] | None:
    """The name of a number and its unit; None if unknown.

    Arguments that a function does not describe have the descriptions of the presets' arguments of the same names.

    Examples
    --------
    >>> import stickslip as ss
    >>> axis_of("link.stiffness", ss.Chain.example()), axis_of("amplitude", lambda amplitude: None)
    (('stiffness of the spring k', 'N/m'), ('amplitude of the inner mass A', 'm'))
    >>> axis_of("modules.1.drive.omega", ss.Chain.example()), axis_of("modules.drive.omega", ss.Chain.example())
    (('angular frequency (modules.1) ω', 'rad/s'), ('angular frequency ω', 'rad/s'))
    """
    name = next(iter(meant), str(name)) if len(meant := _meant(make, str(name))) == 1 else str(name)
    description = _with_part(description_of(name, make), name, make)
    return axis_in(description) or (axis_in(_of_presets().get(name, {})) if make is None or callable(make) else None)


def _with_part(description: Mapping[str, Any], name: str, make: Any) -> Mapping[str, Any]:
    """The description of a number that several parts have, with the part in its label."""
    pieces = name.split(".")
    last = max((i for i, piece in enumerate(pieces) if piece.isdigit()), default=0)
    alike = ".".join(piece for piece in pieces if not piece.isdigit())
    if not last or "label" not in description or callable(make) or len(_meant(make, alike)) < 2:
        return description
    return {**description, "label": f"{description['label']} ({'.'.join(pieces[: last + 1])})"}


def unit_in(name: str, make: Any = None) -> str:
    """The unit of a number as printed after its value; empty for a dimensionless number, and for one without a description.

    Examples
    --------
    >>> import stickslip as ss
    >>> unit_in("sigma0", ss.presets.piezo_rig), unit_in("link.stiffness", ss.Chain.example()), unit_in("mu0", ss.presets.piezo_rig)
    ('N/m', 'N/m', '')
    """
    unit = (axis_of(name, make) or ("", ""))[1]
    return "" if unit == "1" else pretty_unit(unit)


def in_its_unit(name: str, value: Numeric, make: Any, problems: Problems, label: str = "") -> Any:
    """One or several numbers, converted to the unit of the maker's argument; words and percentages are unchanged.

    Parameters
    ----------
    name : str
        Name of the number, as for `axis_of`.
    value : number, text or quantity of pint, or several of them
        The value that was typed.
    make : callable or record
    problems : Problems
        Receives a sentence if the unit measures something else.
    label : str
        Name of the value in that sentence; `name` if not given.

    Examples
    --------
    >>> import stickslip as ss
    >>> problems = Problems("continuation")
    >>> in_its_unit("amplitude", ("uniform", "0.5 mm", 6e-4), ss.presets.piezo_rig, problems)
    ('uniform', 0.0005, 0.0006)
    >>> in_its_unit("amplitude", (5e-4, "1%"), ss.presets.piezo_rig, problems)
    (0.0005, '1%')
    >>> in_its_unit("amplitude", "5 kg", ss.presets.piezo_rig, problems, "start"), problems.mistakes
    ('5 kg', ['start: kg is a unit of mass and no number in it can be one in m; allowed are numbers [m]'])
    """
    axis = axis_of(name, make)
    if axis is None:
        return value
    try:
        if isinstance(value, tuple):
            return tuple(each if isinstance(each, str) and each.strip().endswith("%") else in_unit(each, axis[1]) for each in value)
        return in_unit(value, axis[1])
    except ValueError as error:
        problems.add(f"{label or name}: {error}; allowed are numbers [{axis[1]}]")
        return value


def example_for(name: str) -> float:
    """A typical value of an argument that has the name of a preset's; 1 for others."""
    return float(_of_presets().get(name, {}).get("example", 1.0))


@functools.cache
def _of_presets() -> dict[str, Mapping[str, Any]]:
    """Descriptions of the presets' arguments by name, from the first preset that has an argument of this name."""
    from stickslip.models.presets import PRESETS

    makers: list[Callable[..., Any]] = list(PRESETS.values())
    return {name: description for make in reversed(makers) for name, description in described_arguments(make).items()}
