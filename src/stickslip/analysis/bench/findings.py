"""Results of the bench: numbers with units, curves and tables."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.arguments import described_as, explains_arguments
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.fields import leaves
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn, drawn_on
from stickslip.models.friction.law_adapter import adapted


@dataclass(frozen=True)
class Quantity:
    """One measured number.

    Parameters
    ----------
    key : str
        Short name.
    label : str
        Heading in a table.
    value : float or bool
        SI units; nan if the law has no such number, inf if it is unbounded.
    unit : str
        Unit; empty for a dimensionless number.
    meaning : str
        How it was measured.
    """

    key: str
    label: str
    value: Any
    unit: str
    meaning: str

    def text(self, digits: int = 4) -> str:
        """The value with its unit, as text.

        Examples
        --------
        >>> Quantity("drift", "drift", 2.34735e-6, "m", "").text(), Quantity("sticks", "sticks", True, "", "").text()
        ('2.347e-06 m', 'yes')
        """
        if isinstance(self.value, bool):
            return "yes" if self.value else "no"
        if math.isnan(self.value):
            return "-"
        return "unbounded" if math.isinf(self.value) else f"{self.value:.{digits}g} {self.unit}".rstrip()


@sealed
class ExperimentCurve:
    """One line of a figure: a name and two arrays of equal length, in the units of its experiment."""

    name: str
    x: Any
    y: Any


@sealed
class Experiment:
    """One experiment on one law.

    Parameters
    ----------
    key, title : str
        Short name and title.
    x, y : tuple of str
        Label and unit of the axes.
    curves : tuple of ExperimentCurve
    numbers : tuple of Quantity
    conditions : dict
        Settings: name -> (value, unit).
    remark : str
        A note for the reader, for example that the law has no memory and the result is trivial; often empty.
    logarithmic : str
        The axes that are logarithmic: "", "x" or "xy".
    """

    key: str
    title: str
    x: tuple[str, str]
    y: tuple[str, str]
    curves: tuple[ExperimentCurve, ...]
    numbers: tuple[Quantity, ...]
    conditions: dict[str, tuple[float, str]] = field(default_factory=dict)
    remark: str = ""
    logarithmic: str = ""

    def to_dict(self) -> dict[str, Any]:
        """The experiment as plain numbers and text."""
        return {
            "title": self.title,
            "x": {"label": self.x[0], "unit": self.x[1]},
            "y": {"label": self.y[0], "unit": self.y[1]},
            "curves": [{"name": c.name, "x": [float(v) for v in c.x], "y": [float(v) for v in c.y]} for c in self.curves],
            "conditions": {name: {"value": value, "unit": unit} for name, (value, unit) in self.conditions.items()},
            "remark": self.remark,
        }


class _Tabled(Drawn):
    """Base of the results that print as a table of their rows."""

    _drawn_by = "bench"

    @property
    @abstractmethod
    def table(self) -> str:
        """The numbers as a table of text."""

    @abstractmethod
    def rows(self) -> list[tuple[str, ...]]:
        """Rows of text, the heading first."""

    def __str__(self) -> str:
        return self.table

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return [self.rows()]


@described_as("a bench; type for example ss.bench(law)")
@sealed
class Bench(_Tabled):
    """The behaviour of one law by itself; `print` shows the table, `stickslip.plot.bench` the figure.

    Parameters
    ----------
    law : law
        The law that was tested.
    load, mass : float
        Normal force [N] and moved mass [kg] of the experiments.
    experiments : tuple of Experiment
        Also by name: ``found["hysteresis"]``.
    notes : tuple of str
        Remarks on the law, such as that it is an approximation.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.bench(ss.Coulomb, experiments=["steady"])
    >>> found, found.numbers["slow_forward"], found["steady"].curves[0].name
    (<Bench of Coulomb: 3 numbers from 1 experiments>, 0.18, 'forwards')
    """

    law: Any
    load: float
    mass: float
    experiments: tuple[Experiment, ...]
    notes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the law."""
        return adapted(self.law).name

    @explains_arguments
    def __getitem__(self, key: str) -> Experiment:
        for experiment in self.experiments:
            if experiment.key == key:
                return experiment
        raise InputError("bench", [f"there is no experiment {key!r}; {did_you_mean(key, [e.key for e in self.experiments])}"])

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Each measured number with its unit and meaning."""
        return tuple(q for experiment in self.experiments for q in experiment.numbers)

    @property
    def numbers(self) -> dict[str, Any]:
        """The measured numbers alone, SI units: ``found.numbers["drift"]``."""
        return {q.key: q.value for q in self.quantities}

    def rows(self) -> list[tuple[str, ...]]:
        """The numbers as rows of text, the heading first."""
        head = ("experiment", "number", "value", "meaning")
        return [head, *((e.title, q.label, q.text(), q.meaning) for e in self.experiments for q in e.numbers)]

    @property
    def table(self) -> str:
        """The numbers as a table of text, with remarks below it."""
        return "\n".join([self._title(), aligned_rows(self.rows()), *self._remarks()])

    def _remarks(self) -> list[str]:
        return [*(f"{e.title}: {e.remark}" for e in self.experiments if e.remark), *(f"note: {note}" for note in self.notes)]

    def to_dict(self) -> dict[str, Any]:
        """The results as plain numbers and text."""
        return {
            "law": self.name,
            "parameters": {name: float(value) for name, value in leaves(self.law)},
            "load": self.load,
            "mass": self.mass,
            "numbers": {q.key: {"value": q.value, "unit": q.unit, "label": q.label, "meaning": q.meaning} for q in self.quantities},
            "experiments": {e.key: e.to_dict() for e in self.experiments},
            "notes": list(self.notes),
        }

    def __repr__(self) -> str:
        return f"<Bench of {self.name}: {len(self.quantities)} numbers from {len(self.experiments)} experiments>"

    def _figures(self) -> list[Any]:
        return drawn_on(self.plot, (9.8, 4.5) if len(self.experiments) > 3 else (2.45 * (len(self.experiments) + 1), 2.25))

    def _title(self) -> str:
        return f"{self.name}, load {self.load:g} N, mass {self.mass:g} kg"


@described_as("a bench; type for example ss.bench(law)")
@sealed
class Benches(_Tabled):
    """Several laws on the same bench, side by side; `print` shows one row for each law.

    Parameters
    ----------
    benches : tuple of Bench
        In the order requested; also by number or name: ``found[0]``, ``found["LuGre"]``.

    Examples
    --------
    >>> import stickslip as ss
    >>> print(ss.bench([ss.Coulomb, ss.friction.Tabulated], experiments=["steady"]).table)
    law                           Coulomb  Tabulated
    static or slow, forwards [N]  0.18     0.18
    static or slow, backwards [N] 0.24     0.24
    fall with speed [N]           0.03     0.0297
    """

    benches: tuple[Bench, ...]

    def __iter__(self) -> Iterator[Bench]:
        return iter(self.benches)

    def __len__(self) -> int:
        return len(self.benches)

    @explains_arguments
    def __getitem__(self, key: int | str) -> Bench:
        if isinstance(key, int):
            return self.benches[key]
        for bench in self.benches:
            if bench.name.lower() == key.lower():
                return bench
        raise InputError("bench", [f"there is no law {key!r} here; {did_you_mean(key, [b.name for b in self.benches])}"])

    def rows(self) -> list[tuple[str, ...]]:
        """One row of text for each law, the heading (with units) first."""
        head = ("law", *(f"{q.label} [{q.unit}]" if q.unit else q.label for q in self.benches[0].quantities))
        return [head, *((b.name, *(_bare(q) for q in b.quantities)) for b in self.benches)]

    @property
    def table(self) -> str:
        """All numbers, a column for each law if there are few of them, else a row."""
        rows = self.rows()
        return aligned_rows(rows if len(self.benches) > len(rows[0]) else [tuple(column) for column in zip(*rows, strict=True)])

    def to_dict(self) -> dict[str, Any]:
        """The results as plain numbers and text."""
        return {"laws": [bench.to_dict() for bench in self.benches]}

    def __repr__(self) -> str:
        return f"<Benches of {', '.join(bench.name for bench in self.benches)}>"

    def _figures(self) -> list[Any]:
        return drawn_on(self.plot, (1.75 * (len(self.benches[0].experiments) + 0.9), 0.5 + 1.0 * len(self)))

    def _title(self) -> str:
        return "Friction laws on the bench"


def _bare(quantity: Quantity) -> str:
    """A value without its unit, which is in the heading."""
    return quantity.text(3).removesuffix(quantity.unit).rstrip() if quantity.unit else quantity.text(3)


def aligned_rows(rows: list[tuple[str, ...]]) -> str:
    """Rows of text as aligned columns."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)
