"""The explorer's sliders and curves in a notebook: a widget whose front end is one small module, loaded from this package only."""

from __future__ import annotations

import functools
import importlib.resources
from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.errors import InputError, Problems, StickslipError, did_you_mean
from stickslip.basics.fields import leaves
from stickslip.basics.number_names import numbers_meant
from stickslip.basics.optional import library
from stickslip.show.explorer.machines import Shown, picture
from stickslip.show.explorer.sliders import Parameter


@explains_arguments
def widget(
    model: Model,
    numbers: Sequence[str] | None = None,
    *,
    periods: int | None = None,
    duration: float | None = None,
    start: Mapping[str, Any] | None = None,
) -> Any:
    """A robot or machine with sliders, for a cell of a notebook: velocities and displacements follow as a slider moves.

    While a slider moves, a run has at most 40 drive periods; after its release, `periods`. The widget needs
    ``pip install "stickslip[widget]"``, and no network.

    Parameters
    ----------
    model : Robot, mechanism or machine
        A single one, not a batch.
    numbers : sequence of str, optional
        Dotted names of the numbers that get a slider, in this order; by default all.
    periods : int, optional
        Drive periods of a run when a slider is released; 200 by default.
    duration : float, optional
        Length of a run of a machine without a period [s].
    start : dict, optional
        Initial state, as for `solve`.

    Returns
    -------
    Widget
        ``w.machine`` is the machine with the numbers of the sliders; ``w.values`` has these numbers by name, and may be set.

    Raises
    ------
    InputError
        For a batch, for unknown names, and if anywidget is not installed.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static")
    >>> w = ss.widget(robot, ["drive.amplitude", "friction.mu_plus"])
    >>> w.values = {"drive.amplitude": "0.6 mm"}
    >>> w.machine.drive.amplitude
    0.0006
    """
    given = {"periods": periods, "duration": duration, "start": start}
    shown = Shown(model, type(model).__name__, {name: value for name, value in given.items() if value is not None})
    return _widget_class()(shown, _chosen(shown, numbers))


def _chosen(shown: Shown, numbers: Sequence[str] | None) -> list[tuple[str, Parameter]]:
    """The sliders with the parts to which they belong: all of them, or the named ones."""
    problems, part_of = Problems("widget"), {p.name: part for part, of in shown.groups.items() for p in of}
    names = [numbers] if isinstance(numbers, str) else list(part_of if numbers is None else numbers)
    for name in names:
        if name not in shown.numbers:
            problems.add(f"numbers: {name!r} is not a number of {shown.title}; {did_you_mean(str(name), shown.numbers)}")
    problems.check()
    return [(part_of[name], shown.numbers[name]) for name in names]


def _slider(part: str, p: Parameter) -> dict[str, Any]:
    """A slider as the front end needs it, with ends and value in the displayed unit."""
    shown = {"low": p.low * p.factor, "high": p.high * p.factor, "value": p.default * p.factor}
    return {"name": p.name, "part": part, "label": p.label, "symbol": p.symbol, "unit": p.unit, "factor": p.factor, **shown}


def _asset(name: str) -> str:
    return importlib.resources.files("stickslip.show.explorer").joinpath("assets", name).read_text(encoding="utf-8")


@functools.lru_cache(maxsize=1)
def _widget_class() -> Any:
    """The class, made on first use: its base class is installed by an extra."""
    missing = 'it needs anywidget, which is not installed; type pip install "stickslip[widget]"'
    anywidget, traitlets = (library("widget", name, missing) for name in ("anywidget", "traitlets"))
    base: Any = anywidget.AnyWidget

    class Widget(base):
        """Sliders and curves of one machine; `state` is the request of the page, `answer` the data that it draws."""

        _esm = _asset("widget.js")
        _css = _asset("widget.css")
        title = traitlets.Unicode().tag(sync=True)
        sliders: Any = traitlets.List().tag(sync=True)
        state = traitlets.Dict().tag(sync=True)
        answer = traitlets.Dict().tag(sync=True)

        def __init__(self, shown: Shown, chosen: list[tuple[str, Parameter]]):
            self._shown = shown
            super().__init__(title=shown.title, sliders=[_slider(*each) for each in chosen], state={"values": {}, "fine": True, "id": None})
            self._compute(None)
            self.observe(self._compute, names="state")

        @property
        def values(self) -> dict[str, float]:
            """The numbers that have been moved, by name."""
            return dict(self.state["values"])

        @values.setter
        def values(self, values: Mapping[str, float]) -> None:
            own = dict(leaves(self._shown.with_values(values)))  # text with a unit has become a number here
            self.state = {"values": {name: own[numbers_meant(name, own)[0]] for name in values}, "fine": True, "id": None}

        @property
        def machine(self) -> Any:
            """The machine with these numbers."""
            return self._shown.with_values(self.state["values"])

        def _compute(self, _change: Any) -> None:
            self.answer = {"id": self.state.get("id"), **_answered(self._shown, self.state)}

    return Widget


def _answered(shown: Shown, state: Mapping[str, Any]) -> dict[str, Any]:
    """The data that the page draws for a state; an error message for numbers that are not allowed."""
    try:
        return picture(shown, bool(state.get("fine")), shown.with_values(_values_of(state)), lambda done, most: None)
    except StickslipError as error:
        return {"error": str(error)}


def _values_of(state: Mapping[str, Any]) -> Mapping[str, Any]:
    values = state.get("values")
    if not isinstance(values, Mapping):
        raise InputError("widget", [f"values = {values!r}; allowed is a dict of numbers by name"])
    return values
