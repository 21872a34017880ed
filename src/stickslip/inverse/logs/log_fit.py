"""The result of fitting a file: proposals, fits, what they do not determine, what to measure next, and the Python that does the same."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Face, Text, drawn_on
from stickslip.basics.number_names import SIDES
from stickslip.basics.presenting import presenter
from stickslip.basics.whole_files import unwritable, write_whole
from stickslip.inverse.logs.proposals import HEAD, Proposal, table
from stickslip.models.naming import description_of

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit
    from stickslip.inverse.identification.ranking import Ranking
    from stickslip.inverse.identification.symmetry import Symmetry
    from stickslip.inverse.logs.machines import Task


def over_motor_constant(text: str) -> str:
    """A text with units of torques over a motor constant in N m/A: those of currents.

    Examples
    --------
    >>> over_motor_constant("mu = 1.1 N m, viscous = 0.2 N m s/rad, inertia = 0.2 kg m^2, motor_constant = 1 N m/A")
    'mu = 1.1 A, viscous = 0.2 A s/rad, inertia = 0.2 A s^2/rad, motor_constant = 1 N m/A'
    """
    return re.sub(r"\bkg m(?:\^2|²)", "A s^2/rad", re.sub(r"\bN m\b(?!/A)", "A", text))


def label_of(fit: Fit, name: str) -> str:
    """What a fitted parameter is; of one for both directions without the direction."""
    label = str(description_of(name.partition("[")[0], fit.problem.parameters.make).get("label", ""))
    return label if name.endswith(SIDES) else label.removesuffix(" forwards")


@sealed
@dataclass(frozen=True, eq=False, repr=False)
class LogFit(Face):
    """What `fit` makes of one or several files.

    Parameters
    ----------
    machine : str
        The kind of machine: "rig", "slider", "joint" or "robot".
    law : str
        The law that is reported, by its name.
    proposals : tuple of Proposal
        What each channel and each number was taken for, and why.
    fits : dict of str -> Fit
        Fits of all laws that were tried.
    tasks : dict of str -> Task
        How each was made.
    ranking : Ranking or None
        Of the laws, where several were tried.
    reading : tuple of str
        How the files are read, as Python.
    questions : tuple of str
        What the files leave open, with what to type.
    next : tuple of str
        What to measure next.
    notes : tuple of str
        What there was to remark when the files were read.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> t = np.arange(0, 4, 0.005)
    >>> F = 2.0 * np.sign(np.cos(3 * t)) + np.random.default_rng(0).normal(0, 0.05, len(t))
    >>> result = ss.fit({"time_s": t, "pos_mm": 5.0 * np.sin(3 * t), "F_N": F}, law="coulomb", starts=2)
    >>> result.verdict, result.symmetry[0].determined
    ('coulomb is supported: what is left is noise', False)
    """

    machine: str
    law: str
    proposals: tuple[Proposal, ...]
    fits: dict[str, Fit]
    tasks: dict[str, Task]
    ranking: Ranking | None = None
    reading: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()
    next: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def fit(self) -> Fit:
        """The fit of the law that is reported."""
        return self.fits[self.law]

    @property
    def symmetry(self) -> tuple[Symmetry, ...]:
        """Kinetic friction forwards and backwards: `Fit.symmetry`."""
        return self.fit.symmetry

    @property
    def values(self) -> dict[str, float]:
        """Its parameters [SI]."""
        return self.fit.values

    @property
    def supported(self) -> bool:
        """Whether the record bears the law out: noise is all that is left of it."""
        from stickslip.inverse.identification.uncertainty import faults

        return not faults(self.fit)

    @property
    def verdict(self) -> str:
        """Whether the record supports the law, in a sentence."""
        from stickslip.inverse.identification.uncertainty import faults

        why = faults(self.fit)
        alone = f"{self.law} is not supported: {why[0]}" if why else f"{self.law} is supported: what is left is noise"
        if self.ranking is None:
            return alone
        return f"{self.ranking.verdict}; on all samples {alone}" if why and self.ranking.supported else self.ranking.verdict

    @property
    def in_amperes(self) -> bool:
        """Whether torques are over a motor constant that nobody gave, and so in amperes."""
        return bool(self.fit.in_amperes)

    def model(self) -> Any:
        """The machine with the fitted numbers, as `Fit.model` gives it; `InputError` where its torques are in amperes."""
        if self.in_amperes:
            known = 'type numbers={"motor_constant": 0.05} with that of the motor [N m/A]'
            raise InputError("fit", [f"the torques of this fit are in amperes; {known}, or take result.fit, where N m stands for A"])
        return self.fit.model()

    @cached_property
    def python(self) -> str:
        """The script that makes the same fit, with the same numbers."""
        read = "\n".join(self.reading) if len(self.reading) == 1 else "records = [\n" + "".join(f"    {r},\n" for r in self.reading) + "]"
        head = "record = " + read if len(self.reading) == 1 else read
        call = self.tasks[self.law].written("record" if len(self.reading) == 1 else "records")
        over = "  # torques are over a motor constant of 1 N m/A: in amperes" if self.in_amperes else ""
        call += over
        return f"import stickslip as ss\n\n{head}\n{call}\nprint(fit.report())\n"

    def report(self, path: str | Path | None = None) -> Any:
        """Everything as text; with a path, as an HTML file (returns its path)."""
        if path is not None:
            page = presenter("report", "fit")(path, [self.fit], ranking=self.ranking)
            if self.in_amperes:
                write_whole(page, over_motor_constant(page.read_text(encoding="utf-8")), unwritable("report"))
            return page
        parts = [table(self.proposals), *(f"reading: {note}" for note in self.notes), "", self.fit.report()]
        labels = ((name, label_of(self.fit, name)) for name in self.fit.names)
        parts += [f"names: {words}"] if (words := ", ".join(f"{name} is the {label}" for name, label in labels if label)) else []
        parts.append(f"verdict: {self.verdict}")
        if names := self.fit.undetermined:
            parts.append(f"not determined by this record: {', '.join(names)}")
        parts += [f"measure next: {each}" for each in self.next]
        parts += [f"open: {each}" for each in self.questions]
        text = "\n".join(parts)
        return Text(over_motor_constant(text) if self.in_amperes else text)

    def plot(self, record: int = 0, ax: Ax = None) -> Any:
        """Friction against velocity, the measured cloud and the law; without a torque the angle over time; returns the axes."""
        figure = "over_time" if self.fit.problem.targets[0].kind == "angle" else "friction_curve"
        return presenter("figure", figure)(self.fit, record, ax)

    def save(self, folder: str | Path) -> list[Path]:
        """Write figures, report and Python into a folder; returns the paths.

        Parameters
        ----------
        folder : str or Path
            It is made if it is not there.

        Returns
        -------
        list of Path
            ``curve.png`` (the fit over the data), ``friction.png`` (friction against velocity, of forces), ``residuals.png``,
            ``report.html``, ``report.txt`` and ``fit.py``.
        """
        where = Path(folder)
        try:
            where.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError("fit", [f"the folder {str(where)!r} cannot be made: {error.strerror}; give another path"]) from None
        written = [*presenter("report", "log_figures")(where, self.fit), Path(self.report(where / "report.html"))]
        for name, text in (("report.txt", f"{self.report()}\n"), ("fit.py", self.python)):
            written.append(write_whole(where / name, text, unwritable("fit")))
        return written

    def _title(self) -> str:
        return f"{self.law} on a {self.machine}: {self.verdict}"

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return [[HEAD, *((p.what, p.taken, p.why, p.flag) for p in self.proposals)], *self.fit._tables()]

    def _remarks(self) -> list[str]:
        return [*map(str, self.symmetry), *self.questions, *self.fit.warnings]

    def _figures(self) -> list[Any]:
        return drawn_on(lambda figure: self.plot(ax=figure.subplots()))

    def __repr__(self) -> str:
        return f"<LogFit of a {self.machine}: {self.fit!r}>"
