"""`reproduce`: the whole paper again, in one folder."""

from __future__ import annotations

import dataclasses
import json
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip.basics.errors import InputError, as_path
from stickslip.basics.interruption import interruptible, look
from stickslip.basics.jsontext import strict
from stickslip.basics.progress import reporting
from stickslip.show.paper.amplitudes import infer
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, EXPERIMENTS, rig
from stickslip.show.paper.claims_page import VERDICTS, ClaimData, PaperClaim
from stickslip.show.paper.drawing import Picture
from stickslip.show.paper.equations import Equation, equations
from stickslip.show.paper.errata import Erratum
from stickslip.show.paper.errata_checks import errata
from stickslip.show.paper.judging import claims, study_of
from stickslip.show.paper.readings import STATED
from stickslip.show.paper.section5_motions import FigureMotion
from stickslip.show.paper.sentences import filled, texts
from stickslip.show.paper.solved_runs import Runs, Tell, solve_all
from stickslip.show.paper.table import rows

__all__ = ["FORMAT", "Reproduction", "reproduce"]

#: Format of ``numbers.json``, which notes/paper-revisited.md describes.
FORMAT = "stickslip-paper-4"


@dataclass(frozen=True, eq=False, repr=False)
class Reproduction(ClaimData):
    """The results of `reproduce`: the scans on which claims are judged, and their consequences.

    Parameters
    ----------
    folder : Path
        Where it was written.
    table : tuple of TableRow
        Section 4.
    cases : tuple of dict
        Sections 5.1 to 5.4, figure by figure.
    motions : dict
        Figure number -> kind of motion, from multipliers and exponents.
    around : ParameterMap
        Period number and largest exponent over amplitude and kinetic coefficient.
    claims : tuple of PaperClaim
    errata : tuple of Erratum
    equations : tuple of Equation
        The equations solved, as LaTeX.
    coexistence : Coexistence
        Coexisting motions over static coefficient and amplitude.
    amplitudes : Amplitudes
        The inferred amplitudes, with the intervals that fit as well.
    figures : tuple of Picture
        With the paths of their files.
    provenance : dict
        Versions and tolerances.
    fast : bool
        Whether this is the fast subset.
    seconds : float
        Computing time [s].
    """

    folder: Path
    cases: tuple[dict[str, Any], ...]
    claims: tuple[PaperClaim, ...]
    errata: tuple[Erratum, ...]
    equations: tuple[Equation, ...]
    figures: tuple[Picture, ...]
    provenance: dict[str, Any]
    seconds: float

    @property
    def report(self) -> Path:
        """The HTML page."""
        return self.folder / "report.html"

    @property
    def side_by_side(self) -> Path:
        """The page of figures, one to a screen: what was printed, what we get, and why."""
        return self.folder / "side-by-side.html"

    @property
    def numbers(self) -> Path:
        """All numbers as JSON."""
        return self.folder / "numbers.json"

    def to_dict(self) -> dict[str, Any]:
        """All numbers, words and file names as plain data for strict JSON; velocities in m/s, lengths in m."""
        return as_dict(self)

    def __str__(self) -> str:
        verdicts = Counter({verdict: 0 for verdict in VERDICTS})
        verdicts.update(c.verdict for c in self.claims)
        kinds = Counter(m.word for m in self.motions.values()).most_common()
        text: str = filled(texts("printed"), {"result": self, "verdicts": verdicts, "kinds": kinds})
        return text

    def __repr__(self) -> str:
        return f"<Reproduction: {len(self.claims)} claims, {len(self.errata)} errata, {len(self.figures)} figures in {str(self.folder)!r}>"


@interruptible
def reproduce(out: str | Path = "stickslip-paper", fast: bool = False, progress: Tell | bool | None = None) -> Reproduction:
    """Reproduce the paper: the table of section 4, Figures 6 to 30, every claim with a verdict, and the errata.

    Parameters
    ----------
    out : path
        Folder to write to; it is created if necessary.
    fast : bool
        A subset in about a minute: coarser scans, fewer figures, no Runge-Kutta runs of more than 5000 steps per period.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (current task, amount done, total amount).

    Returns
    -------
    Reproduction

    Raises
    ------
    InputError
        If the folder cannot be written.

    Examples
    --------
    >>> import stickslip as ss
    >>> result = ss.paper.reproduce("the-paper", fast=True)  # doctest: +SKIP
    >>> result.table[0].type  # doctest: +SKIP
    'I'
    """
    begun, tell = time.perf_counter(), _telling(progress)
    folder = _folder(as_path(out, "reproduce", "paper"))
    runs = solve_all(tell)
    study = study_of(fast, runs, rows(runs), infer(fast, tell), tell)
    judged = claims(study)
    tell("checking the errata", 0, 1)
    corrections = errata(study)
    result = _gathered(folder, study, judged, corrections)
    result = dataclasses.replace(result, seconds=time.perf_counter() - begun)
    _write(result, tell)
    return result


def _gathered(folder: Path, study: ClaimData, judged: tuple[PaperClaim, ...], corrections: tuple[Erratum, ...]) -> Reproduction:
    from stickslip.show.paper import evidence, figures

    drawn = figures.draw(study.runs, study.table, study.motions, folder / "figures", study.fast, study.tell) + evidence.draw(
        study, judged, folder / "figures"
    )
    return Reproduction(
        **vars(study),
        folder=folder,
        cases=tuple(_case(study.runs, c, study.motions[c.figure]) for c in CASES),
        claims=judged,
        errata=corrections,
        equations=equations(),
        figures=drawn,
        provenance=_provenance(study.runs, study.fast),
        seconds=0.0,
    )


def _telling(progress: Any) -> Tell:
    """A function that reports progress; the call may end there. A report is complete or not written at all."""
    report = reporting(progress, "reproduce")

    def tell(what: str, done: int, of: int) -> None:
        report(what, done, of)
        look()

    return tell


def _folder(folder: Path) -> Path:
    try:
        (folder / "figures").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "reproduce", [f"out = {str(folder)!r} cannot be made: {error.strerror}; give a folder that can be written"]
        ) from None
    return folder


def _case(runs: Runs, case: Any, judged: FigureMotion) -> dict[str, Any]:
    from stickslip.analysis.motion import motion
    from stickslip.analysis.steady import mean_velocity

    run, twin = runs.figures[case.figure], runs.twins[case.figure]
    judged_motion, exact = motion(run), motion(twin)
    return {
        **{name: value for name, value in vars(case).items() if name != "varied"},
        "lugre": {
            "mean_velocity": mean_velocity(run),
            "period": judged_motion.period,
            "word": judged_motion.type,
            "pattern": judged_motion.pattern,
        },
        "coulomb": {"mean_velocity": mean_velocity(twin), "period": exact.period, "type": exact.type, "margin": exact.margin},
        "verdict": judged.as_data(),
    }


def _provenance(runs: Runs, fast: bool) -> dict[str, str]:
    import matplotlib as mpl

    made = runs.lugre[EXPERIMENTS[0].name].provenance
    values = {**made["settings"], "versions": {**made["versions"], "matplotlib": mpl.__version__}, "fast": fast}
    return filled(texts("provenance"), values)


def _write(result: Reproduction, tell: Tell) -> None:
    from stickslip.show.paper.content import content, side_by_side
    from stickslip.show.reports import page, write

    tell("writing the report", 0, 1)
    text = json.dumps(result.to_dict(), indent=1, ensure_ascii=False, allow_nan=False)
    write(result.numbers, text + "\n")
    write(result.report, page("paper.html", **content(result, notes=rig(EXPERIMENTS[0]).notes)))
    write(result.side_by_side, page("side_by_side.html", **side_by_side(result)))
    tell("writing the report", 1, 1)


def as_dict(result: Reproduction) -> dict[str, Any]:
    """A reproduction as plain data."""
    a = result.amplitudes
    own = [{name: value for name, value in vars(b).items() if name not in ("scan", "experiment")} for b in a.section4]
    section5 = a.section5
    taken = [{"tilt_deg": b.experiment.tilt_deg, "taken": b.experiment.amplitude} for b in a.section4]
    data = {
        "format": FORMAT,
        "fast": result.fast,
        "table": [{**dataclasses.asdict(r), "closer": r.closer, "closer_printed": r.closer_printed} for r in result.table],
        "cases": result.cases,
        "around": result.around.as_data(),
        **{kind: [dataclasses.asdict(one) for one in getattr(result, kind)] for kind in ("claims", "errata", "equations")},
        "coexistence": result.coexistence.as_data(),
        "type_two": result.type_two.as_data(),
        "omitted": [one.as_data() for one in result.omitted.along],
        "amplitudes": {
            "section4": [one | rest for one, rest in zip(taken, own, strict=True)],
            "reading": vars(STATED),
            "readings": [f.as_data() for f in a.fits],
            "section5": {
                "taken": AMPLITUDE_5,
                "searches": [s.as_data() for s in section5.searches],
                "round_values": section5.round_values,
                "period_two": dataclasses.asdict(section5.period_two),
            },
            "common": a.common,
        },
        "figures": [
            {
                "key": p.key,
                "section": p.section,
                "title": p.title,
                "caption": p.caption,
                "alts": p.alts,
                "files": [f"figures/{f.name}" for f in p.files],
            }
            for p in result.figures
        ],
        "report": result.report.name,
        "side_by_side": result.side_by_side.name,
        "provenance": result.provenance,
        "seconds": result.seconds,
    }
    return strict(data, _key)


def _key(key: Any) -> str:
    return f"{key:g}" if isinstance(key, float) else str(key)
