"""A fit as text that can be read aloud."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.fields import leaves
from stickslip.basics.notebook_display import NOT_DETERMINED, rounded, sure
from stickslip.basics.number_names import numbers_meant
from stickslip.basics.phrases import counted, listed
from stickslip.basics.quantities import with_unit
from stickslip.basics.variables import in_units_of
from stickslip.models.naming import description_of

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit


def parameter_rows(fit: Fit) -> list[dict[str, str]]:
    """For each free parameter its name, value, standard error, unit and the ends of its 95 % interval, as text."""
    ends = {name: (fit.errors[name], *fit.intervals[name]) for name in fit.values}
    return [
        {"name": name, "unit": unit_of_parameter(fit, name), "value": rounded(value, error), "error": error_text(fit, name),
         "low": rounded(low, error), "high": rounded(high, error)}
        for (name, value), (error, low, high) in zip(fit.values.items(), ends.values(), strict=True)
    ]  # fmt: skip


#: Kinds of values that are forces, or what stands for them, over a motion that was measured.
OVER_MOTION = ("force", "applied force", "torque", "current", "angle")


def error_text(fit: Fit, name: str) -> str:
    """The standard error of a parameter as it stands behind its value; that there is none where the sum of squares is not a parabola."""
    if name in fit.undetermined:
        return NOT_DETERMINED
    return "(by profile)" if name in fit.bent else sure(fit.errors[name])


def stated(fit: Fit, row: dict[str, str]) -> str:
    """A row of `parameter_rows` as one writes a number: value, standard error, unit."""
    unit = f" {row['unit']}".rstrip()
    return f"{row['value']}{unit} {row['error']}" if row["name"] in fit.bent else f"{row['value']} {row['error']}{unit}"


_LISTED = 4  # mean velocities, of which each has a line of its own
_UNITS = {"velocity": "m/s", "position": "m", "mean": "m/s", "force": "N", "applied force": "N", "torque": "N m", "current": "A",
          "angle": "rad"}  # fmt: skip


def unit_of_values(target: Any) -> str:
    """The SI unit of what is compared of one record."""
    return target.unit or _UNITS[target.kind]


def unit_of_parameter(fit: Fit, name: str) -> str:
    """The unit of a free parameter as its field or maker describes it, of that machine; empty where it is a bare number, or nobody says.

    Friction coefficients are forces (or torques) where the load is 1, which then is none.
    """
    description = description_of(name.partition("[")[0], fit.problem.parameters.make)
    unit = "N" if description.get("of_load") and _load_is_one(fit) else str(description.get("unit", ""))
    return "" if unit == "1" else in_units_of(fit.model(), unit)


def _load_is_one(fit: Fit) -> bool:
    """Whether the load of a contact is 1, so that coefficients of friction are forces."""
    if all(t.kind == "force" for t in fit.problem.targets):
        return all(bool(np.all(t.load == 1.0)) for t in fit.problem.targets)
    return in_units_of(fit.model(), "N") != "N" and dict(leaves(fit.model())).get("load") == 1.0


def undetermined(fit: Fit) -> list[str]:
    """Sentences on the parameters that the data do not determine: which change together while nothing measured changes."""
    sentences, first = [], fit.problem.first
    for members, directions in fit.information.groups:
        names = [fit.names[k] for k in members if k < len(fit.names)]
        others = [fit.problem.numbers[k - first] for k in members if k >= first]
        sensors = [n.name for n in others if n.of == "the sensor"]
        if not names:
            continue
        if len(members) == 1 and names[0] in fit.bent and names[0] not in fit.open:
            continue
        if len(members) == 1:
            sentences.append(f"{names[0]} is not determined: it has no effect on the measured values; fix it, or {fit.remedy}")
            continue
        phases = " the phases and offsets of the records" if len(names) + len(others) < len(members) else ""
        along_with = f" beside {listed([f'{n.name} of {n.of}' for n in others])}" if others else f" beside{phases}" if phases else ""
        sentence = f"{listed(names)} {'are' if len(names) > 1 else 'is'} not determined{along_with}"
        if len(directions) == 1 and len(names) == len(members):
            sentence += f": nothing measured changes while {_changes(fit, members, directions[0])}; fix one of them"
        else:
            counted = f"the data determine {len(members) - len(directions)} of {len(members)} combinations"
            sentence += f": {counted}; {_advice(fit, sensors, len(directions))}"
        sentences.append(sentence)
    return sentences + _determined(fit)


def _advice(fit: Fit, sensors: list[str], count: int) -> str:
    """Advice on directions that nothing determines."""
    if not sensors:
        return f"fix {count} of them"
    names = [n.name for n in (*fit.problem.numbers, *fit.problem.held) if n.of == "the sensor"]
    typed = ", ".join(f'"{name}": {"0.0" if name in sensors else "None"}' for name in names)
    return f'fix {count} of them; if the sensor is calibrated, type sensor={{{typed}}}, or what is known of it, as ("normal", mean, sd)'


def _determined(fit: Fit) -> list[str]:
    """The combinations of undetermined parameters that the data do determine."""
    return [
        f"the data determine {combination.formula} = {rounded(combination.value, combination.error)} {sure(combination.error)}"
        + ("" if combination.holds else ", near the fitted values: no formula that was tried holds farther away")
        for combination in fit.determined
    ]


def _changes(fit: Fit, members: list[int], direction: Array) -> str:
    """By how much each parameter changes along a direction, the one that changes most by one per cent."""
    values = [fit.values[fit.names[k]] for k in members]
    part = np.array([d * fit.slopes[k] / (abs(v) or 1.0) for d, k, v in zip(direction, members, values, strict=True)])
    part = part / part[np.argmax(abs(part))]
    steps = [f"{fit.names[k]} changes by {p:+.3g} {'%' if v else '/100'}" for p, k, v in zip(part, members, values, strict=True)]
    return ", ".join(steps)


def known_line(fit: Fit) -> str:
    """Numbers that were given and not fitted, with units: an error in one of these shifts the fitted ones."""
    of = fit.problem.parameters
    numbers = {} if callable(of.make) else {name: [value] for name, value in leaves(of.make)}
    numbers |= {name: [each[name] for each in of.fixed] for name in of.fixed[0]}
    free = {own for name in ({f.argument for f in of.free} | set(of.tied)) for own in (numbers_meant(name, numbers) or (name,))}
    given = [f"{name} = {_as_given(values, unit_of_parameter(fit, name))}" for name, values in numbers.items() if name not in free]
    return f"as given: {', '.join(given)}" if given else ""


def _as_given(values: list[Any], unit: str) -> str:
    """A value, or those of all records where they differ."""
    shown = [
        with_unit(float(v), unit)
        if isinstance(v, (int, float)) and not isinstance(v, bool)
        else v
        if isinstance(v, str)
        else type(v).__name__
        for v in values
    ]
    return " and ".join(dict.fromkeys(shown))


def sensor_lines(fit: Fit) -> list[str]:
    """Sensor effects, one sentence for all."""
    units = {n.name: n.unit(unit_of_values(fit.problem.targets[n.records[0]])) for n in (*fit.problem.numbers, *fit.problem.held)}
    readings = [
        f"{name} = {rounded(value, error)} {sure(error) if error else '(held)'} {units[name]}".rstrip()
        for name, (value, error) in fit.sensor.items()
        if name in units
    ]
    return ([f"sensor: {', '.join(readings)}"] if readings else []) + drive_lines(fit)


def drive_lines(fit: Any) -> list[str]:
    """Harmonics of the drive, one sentence for all."""
    harmonics = [f"{name} = {rounded(value, error)} {sure(error) if error else '(held)'}" for name, (value, error) in fit.drive.items()]
    return [f"harmonics of the drive, in parts of its amplitude: {', '.join(harmonics)}"] if harmonics else []


def input_lines(fit: Fit) -> list[str]:
    """Standard errors from noise of the motion, where they are more than a twentieth of the whole."""
    parts = {name: part for name, part in fit.input_errors.items() if name not in fit.undetermined and part > 0.05 * fit.errors[name]}
    return [f"from the noise of the motion: {', '.join(f'{name} {sure(part)}' for name, part in parts.items())}"] if parts else []


def cost_lines(fit: Fit) -> list[str]:
    """The cost of sensor effects: standard errors with them, with all their numbers known, and with those of one effect known."""
    costs, lines = fit.costs, []
    of_all = "sensor and drive" if fit.drive else "the sensor"
    for name, error in fit.errors.items():
        if name in fit.undetermined:
            continue
        each = [
            f"{sure(without[name])} with its {what} known" for what, without in costs.items() if what and _matters(error, without[name])
        ]
        if costs and _matters(error, costs[""][name]):
            lines.append(f"{name}: {sure(error)}, {sure(costs[''][name])} with {of_all} known{', ' if each else ''}{', '.join(each)}")
    return lines


def _matters(error: float, without: float) -> bool:
    """Whether a standard error becomes smaller by a twentieth or more."""
    return bool(without < 0.95 * error)


def report_text(fit: Fit) -> str:
    """The fit as text."""
    records, parameters = counted(len(fit.problem.targets), "record"), counted(len(fit.names), "parameter")
    rows = [f"{fit.law} fitted to {records}, {counted(fit.count, 'value')}; {parameters} free"]
    width = max(len(name) for name in fit.names)
    for row in parameter_rows(fit):
        name, unit = f"{row['name']:<{width}}", f" {row['unit']}".rstrip()
        if row["name"] in fit.undetermined:
            rows.append(f"  {name} {NOT_DETERMINED}: {fit.values[row['name']]:.3g}{unit} is one of many values that fit as well")
        else:
            rows.append(f"  {name} = {stated(fit, row)}   95 % {row['low']} to {row['high']}")
    rows += [f"  {line}" for line in (known_line(fit), *sensor_lines(fit), *cost_lines(fit), *input_lines(fit)) if line]
    means = [q for q in fit.quality if q.kind == "mean"]
    if len(means) > _LISTED:
        rms = float(np.sqrt(np.mean([q.rms**2 for q in means])))
        rows.append(f"  {len(means)} mean velocities: rms {rms:.3g} {means[0].unit}, the largest residual {max(q.rms for q in means):.3g}")
    for q in fit.quality:
        if q.kind == "mean" and len(means) > _LISTED:
            continue
        noise = f", noise {q.noise:.3g} {q.unit}" if np.isfinite(q.noise) else ""
        explained = f", R² {q.r2:.5f}" if np.isfinite(q.r2) else ""
        rows.append(f"  {q.label}, {q.kind}: rms {q.rms:.3g} {q.unit}{noise}{explained}, neighbours correlated {q.correlation:.2f}")
    rows += [f"  symmetry: {each}" for each in fit.symmetry]
    rows.append(f"  search: {fit.starts} starting points, {fit.agree} of the refined ones ended here")
    return "\n".join([*rows, *(f"note: {sentence}" for sentence in fit.warnings)])
