"""A page for a machine of any kind: sliders for its numbers, and a picture of its motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from stickslip.basics.errors import InputError, Problems, did_you_mean, without_advice
from stickslip.basics.fields import field_description, leaves
from stickslip.basics.quantities import symbol_text
from stickslip.basics.variables import unit_of
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import is_machine, machine_of
from stickslip.show.explorer.effort import RTOL, affordable
from stickslip.show.explorer.sliders import Parameter

COARSE, FINE = 40, 200  # drive periods of a run while a slider moves, and after its release
#: Drive periods of the first picture, while a kernel is compiled, its method, which needs none, and its tolerance.
FIRST, PLAIN, LOOSE = 6, "radau", 1e-3
#: The error message for machine numbers sent to a server that shows a robot.
OF_A_ROBOT = "this server shows a robot; begin it with stickslip explore FILE for a machine"
_TIMES = 20.0  # length of a run of an autonomous machine, in units of its own time scale
_FAR = 1e300
_NUDGE = 1e-3  # relative change of a number that tests whether it may vary alone


@dataclass(frozen=True)
class Shown:
    """The machine that a page shows.

    Parameters
    ----------
    model : Robot, mechanism or machine
        A single case, as initially shown.
    title : str
        Title of the page.
    options : dict
        Arguments of the solver: periods or duration, start, ...
    notes : tuple of str
        Remarks shown with every run.

    Raises
    ------
    InputError
        For a batch, or a machine without a period and without a duration.

    Examples
    --------
    >>> import stickslip as ss
    >>> shown = Shown(ss.Chain.example())
    >>> len(shown.numbers), shown.with_values({"phases.1": 0.5}).phases
    (18, (0.0, 0.5))
    """

    model: Any
    title: str = "a machine"
    options: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        problems = Problems("explore")
        if not is_machine(self.model):
            instead = "allowed is a machine with bodies and contacts; of a flow ss.plot.states(run) draws the states"
            problems.add(f"{type(self.model).__name__} has no bodies that could be drawn; {instead}")
        elif self.model.shape != ():
            problems.add(f"the machine is a batch of shape {self.model.shape}; allowed is one; type one number where an array stands")
        elif self.model.period is None and "duration" not in self.options and not machine_of(self.model).time_scale:
            problems.add(f"{type(self.model).__name__} has no period, so a run needs a duration; type duration=20.0 [s]")
        problems.check()

    @cached_property
    def numbers(self) -> dict[str, Parameter]:
        """The numbers with sliders, by dotted names."""
        return {p.name: p for p in sliders_of(self.model)}

    @property
    def turns(self) -> bool:
        """Whether it turns about an axis."""
        return unit_of("x", self.model) == "rad"

    @property
    def groups(self) -> dict[str, list[Parameter]]:
        """The numbers grouped by part; those of the whole machine come first."""
        parts: dict[str, list[Parameter]] = {"": []}
        for p in self.numbers.values():
            parts.setdefault(_part(p.name), []).append(p)
        return {part: of for part, of in parts.items() if of}

    def with_values(self, values: Mapping[str, float]) -> Any:
        """The machine with other numbers; all errors are reported together."""
        problems = Problems("state")
        for name in values:
            if name not in self.numbers:
                problems.add(f"values.{name[:40]!r} is not known; {did_you_mean(name[:40], self.numbers)}")
        problems.check()
        return self.model.replace(dict(values)) if values else self.model

    def robot(self, law: str = "", **changes: float) -> Any:
        """The machine, in the form that `Kernels` expects."""
        return self.with_values(changes)

    def length(self, model: Any, fine: bool) -> dict[str, Any]:
        """The length of a run, as arguments of `solve`."""
        given = {name: value for name, value in self.options.items() if name not in ("periods", "duration", "settle", "rtol", "keep")}
        if model.period is None:
            duration = self.options.get("duration", _TIMES * float(machine_of(model).time_scale or 1.0))
            return {**given, "duration": duration}
        wanted = int(self.options.get("periods", FINE))
        return {**given, "periods": affordable(model, wanted if fine else min(wanted, COARSE))}


def sliders_of(model: Any) -> Iterator[Parameter]:
    """Every number of a machine with the range of its slider: that of its field (metadata "range"), else one around its value.

    Numbers that may only change together, such as the frequencies of all drives of a chain, have one slider: "*.omega".

    Examples
    --------
    >>> import stickslip as ss
    >>> first = next(sliders_of(ss.Chain.example()))
    >>> first.name, first.label, first.unit, (round(first.low, 6), round(first.high, 6))
    ('modules.0.body_mass', 'mass of the body', 'g', (0.01, 0.2))
    """
    names: set[str] = set()
    for first, value in leaves(model):
        name = _together(model, first, float(value))
        if name not in names:
            names.add(name)
            described, value = field_description(model, first), float(value)
            yield _numbered(replace(Parameter.described(name, described, value, _around(described, value)), least=-_FAR, most=_FAR))


def _numbered(p: Parameter) -> Parameter:
    """A number of a sequence, such as phases.1, with its position in label and symbol, counted from 1 as bodies are."""
    last = p.name.rpartition(".")[2]
    if not last.isdigit():
        return p
    position = str(int(last) + 1)
    return replace(p, label=f"{p.label} {position}", symbol=p.symbol and symbol_text(f"{p.symbol}_{position}"))


def _together(model: Any, name: str, value: float) -> str:
    """The name of a number, or the pattern "*.name" of all its namesakes if it may not change alone."""
    all_of_them = f"*.{name.rpartition('.')[2]}"
    moved = value + _NUDGE * (abs(value) or 1.0)
    alone = not _is_taken(model, {name: moved})
    return all_of_them if alone and _is_taken(model, {all_of_them: value}) and _is_taken(model, {all_of_them: moved}) else name


def _is_taken(model: Any, changes: dict[str, float]) -> bool:
    try:
        model.replace(changes)
    except InputError:
        return False
    return True


def _around(described: Mapping[str, Any], value: float) -> tuple[float, float]:
    """The declared range if the value lies in it; else a range around the value, on both sides of zero for an angle or zero."""
    low, high = described.get("range", (1.0, -1.0))
    if low <= value <= high:
        return low, high
    if described.get("unit") == "rad":
        return -math.pi, math.pi
    if value == 0.0:
        return -1.0, 1.0
    return tuple(sorted((0.1 * value, 2.5 * value)))  # type: ignore[return-value]


def _part(name: str) -> str:
    """The part to which a dotted name belongs: modules.0 for modules.0.drive.amplitude."""
    places = name.removeprefix("*.").split(".")
    return ".".join(places[:2]) if len(places) > 2 and places[1].isdigit() else places[0] if len(places) > 1 else ""


def part_label(part: str) -> str:
    """The name of a part on the page, counted from 1 as bodies are.

    Examples
    --------
    >>> part_label("modules.0"), part_label("link"), part_label("")
    ('module 1', 'link', 'the machine')
    """
    name, _, number = part.partition(".")
    return f"{name.removesuffix('s')} {int(number) + 1}" if number else name.replace("_", " ") or "the machine"


# ---- answers ----
def picture(shown: Shown, fine: bool, model: Any, progress: Callable[[int, int], None], first: bool = False) -> dict[str, Any]:
    """The data of a run that the page draws and, after the release of a slider, the facts about it."""
    from stickslip.show.reports.facts import facts, mean_of, tables
    from stickslip.show.reports.moving import moments

    run = _solved(shown, model, fine, progress, first)
    data: dict[str, Any] = {"kind": "machine", "fine": fine, "picture": moments(run), "status": run.status}
    data["speeds"] = {name: unit_of_part("v", run.model, name) for name in run.body_columns}
    data["mean_velocity"] = {name: mean_of(run, name) for name in run.body_columns}
    if fine:
        data |= {"facts": facts(run), "tables": tables(run), "notes": [without_advice(note) for note in (*shown.notes, *run.notes)]}
    return data


def _solved(shown: Shown, model: Any, fine: bool, progress: Callable[[int, int], None] | None = None, first: bool = False) -> Any:
    from stickslip.solvers import solve

    length = shown.length(model, fine)
    if first:
        length |= {"method": PLAIN} | {name: min(FIRST, count) for name, count in length.items() if name == "periods"}
    run = solve(model, **length, rtol=LOOSE if first else RTOL, keep="trajectory", progress=progress)
    if model.period is not None and len(run.strobe_times) < 3:
        raise InputError("run", [f"{run.status} after {float(run.pieces.t[-1]):.4g} s, within the first periods"])
    return run


def report(shown: Shown, values: Mapping[str, float]) -> bytes:
    """The report on a run with these numbers."""
    from stickslip.show.reports.run import run_page

    return run_page(_solved(shown, shown.with_values(values), True), shown.title).encode()


def study(shown: Shown, values: Mapping[str, float]) -> bytes:
    """A study file that `stickslip run` reads."""
    model = shown.with_values(values)
    how = "\n".join(f"{name} = {value!r}" for name, value in shown.length(model, True).items() if name in ("periods", "duration"))
    return f"{model.to_toml()}\n[solve]\n{how}\n".encode()
