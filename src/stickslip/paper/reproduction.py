"""`reproduce`: the whole paper again, into one folder."""

from __future__ import annotations

import dataclasses
import json
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip.callbacks import progress_callback
from stickslip.errors import InputError
from stickslip.jsontext import strict
from stickslip.paper.amplitudes import Amplitudes, infer
from stickslip.paper.cases import CASES, EXPERIMENTS, rig
from stickslip.paper.claims_page import VERDICTS, Claim, Study
from stickslip.paper.coexistence import Coexistence
from stickslip.paper.drawing import Picture
from stickslip.paper.equations import Equation, equations
from stickslip.paper.errata import Erratum
from stickslip.paper.errata_checks import errata
from stickslip.paper.judging import claims, study_of
from stickslip.paper.parameter_map import Around
from stickslip.paper.section5_motions import Motion
from stickslip.paper.solved_runs import Runs, Tell, solve_all
from stickslip.paper.table import Row, rows
from stickslip.paper.words import speed

__all__ = ["FORMAT", "Reproduction", "reproduce"]

#: Of ``numbers.json``; docs/paper-revisited.md says what stands in it.
FORMAT = "stickslip-paper-3"


@dataclass(frozen=True, eq=False, repr=False)
class Reproduction:
    """The results of `reproduce`.

    Parameters
    ----------
    folder, report, numbers : Path
        Where it was written: the folder, the HTML page, and all numbers as JSON.
    table : tuple of Row
        Section 4.
    cases : tuple of dict
        Sections 5.1 to 5.4, figure by figure.
    motions : dict
        By the number of the figure: the kind of motion, from multipliers and exponents.
    around : Around
        Period number and largest exponent over amplitude and kinetic coefficient.
    claims : tuple of Claim
    errata : tuple of Erratum
    equations : tuple of Equation
        The equations solved, as LaTeX.
    coexistence : Coexistence
        Where two motions exist over static coefficient and amplitude.
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
    report: Path
    numbers: Path
    table: tuple[Row, ...]
    cases: tuple[dict[str, Any], ...]
    motions: dict[int, Motion]
    around: Around
    claims: tuple[Claim, ...]
    errata: tuple[Erratum, ...]
    equations: tuple[Equation, ...]
    coexistence: Coexistence
    amplitudes: Amplitudes
    figures: tuple[Picture, ...]
    provenance: dict[str, Any]
    fast: bool
    seconds: float

    def to_dict(self) -> dict[str, Any]:
        """All numbers, words and file names as plain data for strict JSON; velocities in m/s, lengths in m."""
        return as_dict(self)

    def __str__(self) -> str:
        counts = Counter(c.verdict for c in self.claims)
        lines = ["Section 4, mean velocities (printed / computed; amplitudes inferred)"]
        for r in self.table:
            e = r.experiment
            lines.append(
                f"  {e.tilt_deg}°  type {e.type:>3} / {r.type:<3}  Coulomb {speed(e.coulomb, 3)} / {speed(r.coulomb, 6)}"
                f"  LuGre {speed(e.lugre, 3)} / {speed(r.lugre, 6)}  measured {speed(e.measured, 3)}"
            )
        kinds = Counter(m.word for m in self.motions.values())
        lines += [f"Section 5, by multipliers and exponents: {', '.join(f'{n} {word}' for word, n in kinds.most_common())}"]
        shares = ", ".join(f"{name} {100 * share:.1f} %" for name, share in self.around.shares.items())
        lines += [f"Around it, {self.around.grid.period.size} pairs of A and mu0: {shares}"]
        lines += [f"Claims: {', '.join(f'{counts[v]} {v}' for v in VERDICTS)}"]
        lines += [f"  {c.verdict:<{max(map(len, VERDICTS))}}  {c.section:>6}  {c.claim}" for c in self.claims]
        lines += [
            f"Errata: {len(self.errata)}; figures: {len(self.figures)}; {self.seconds:.0f} s",
            f"Report:  {self.report}",
            f"Numbers: {self.numbers}",
        ]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<Reproduction: {len(self.claims)} claims, {len(self.errata)} errata, {len(self.figures)} figures in {str(self.folder)!r}>"


def reproduce(out: str | Path = "stickslip-paper", fast: bool = False, progress: Tell | bool | None = None) -> Reproduction:
    """Reproduce the paper: the table of section 4, Figures 6 to 30, every claim with a verdict, and the errata.

    Parameters
    ----------
    out : path
        Folder to write to; it is made if it is not there.
    fast : bool
        A subset in about a minute: coarser scans, fewer figures, no Runge-Kutta runs of more than 5000 steps per period.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (current task, amount done, amount in all).

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
    begun, tell = time.perf_counter(), progress_callback(progress, "reproduce") or _silent
    folder = _folder(Path(out))
    runs = solve_all(tell)
    study = study_of(fast, runs, rows(runs), infer(fast, tell), tell)
    judged = claims(study)
    tell("checking the errata", 0, 1)
    found = errata(study.table, study.amplitudes)
    result = _gathered(folder, study, judged, found)
    result = dataclasses.replace(result, seconds=time.perf_counter() - begun)
    _write(result, tell)
    return result


def _gathered(folder: Path, study: Study, judged: tuple[Claim, ...], found: tuple[Erratum, ...]) -> Reproduction:
    from stickslip.paper import evidence, figures

    drawn = figures.draw(study.runs, study.table, study.motions, folder / "figures", study.fast, study.tell) + evidence.draw(
        study, judged, folder / "figures"
    )
    return Reproduction(
        folder=folder,
        report=folder / "report.html",
        numbers=folder / "numbers.json",
        table=study.table,
        cases=tuple(_case(study.runs, c, study.motions[c.figure]) for c in CASES),
        motions=study.motions,
        around=study.around,
        claims=judged,
        errata=found,
        equations=equations(),
        coexistence=study.coexistence,
        amplitudes=study.amplitudes,
        figures=drawn,
        provenance=_provenance(study.runs, study.fast),
        fast=study.fast,
        seconds=0.0,
    )


def _silent(what: str, done: int, of: int) -> None:
    """No progress."""


def _folder(folder: Path) -> Path:
    try:
        (folder / "figures").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "reproduce", [f"out = {str(folder)!r} cannot be made: {error.strerror}; give a folder that can be written"]
        ) from None
    return folder


def _case(runs: Runs, case: Any, judged: Motion) -> dict[str, Any]:
    from stickslip.analysis.motion import motion
    from stickslip.analysis.steady import mean_velocity

    run, twin = runs.figures[case.figure], runs.twins[case.figure]
    told, exact = motion(run), motion(twin)
    return {
        **{
            name: getattr(case, name) for name in ("figure", "section", "tilt_deg", "amplitude", "changes", "statement", "amplitude_source")
        },
        "lugre": {"mean_velocity": mean_velocity(run), "period": told.period, "word": told.type, "pattern": told.pattern},
        "coulomb": {"mean_velocity": mean_velocity(twin), "period": exact.period, "type": exact.type, "margin": exact.margin},
        "verdict": judged.as_data(),
    }


def _provenance(runs: Runs, fast: bool) -> dict[str, str]:
    import matplotlib as mpl

    made = runs.lugre[EXPERIMENTS[0].name].provenance
    versions = {**made["versions"], "matplotlib": mpl.__version__}
    return {
        "Versions": ", ".join(f"{name} {version}" for name, version in versions.items()),
        "Coulomb friction": "Eq. 2.4, exact arcs; switching times to machine precision, no regularisation, no tolerance",
        "LuGre friction": f"Eqs 2.5 and 2.6, {made['settings']['method']}, relative tolerance {made['settings']['rtol']:g} for the "
        "table and the figures, "
        "10⁻⁶ for scans (10⁻⁵ where only types are needed)",
        "Start and window": "from rest (v = z = 0); mean velocity over drive periods 100 to 200",
        "Thresholds of LuGre labels": f"slip ratio {made['settings']['slip_ratio']:g}, dwell {made['settings']['dwell']:g} of a period, "
        "unless said otherwise",
        "Parameters": "m = 9.48 g, M = 62.59 g, g = 9.81 m/s², ω = 65.4π s⁻¹, μ₀ = 0.18, f₀ = 0.21, σ₀ = 4·10⁵ N/m, σ₁ = 100 N s/m, σ₂ "
        "= 0.04 N s/m, "
        "v_s = 0.002 m/s, incline folded into the coefficients, unless said otherwise",
        "Extent": "fast subset: coarser scans, fewer figures" if fast else "everything",
    }


def _write(result: Reproduction, tell: Tell) -> None:
    from stickslip.paper.content import content
    from stickslip.report import page, write

    tell("writing the report", 0, 1)
    text = json.dumps(result.to_dict(), indent=1, ensure_ascii=False, allow_nan=False)
    write(result.numbers, text + "\n")
    write(result.report, page("paper.html", **content(result, notes=rig(EXPERIMENTS[0]).notes)))
    tell("writing the report", 1, 1)


def as_dict(result: Reproduction) -> dict[str, Any]:
    """A reproduction as plain data."""
    a = result.amplitudes
    brackets = [{f.name: getattr(b, f.name) for f in dataclasses.fields(b) if f.name not in ("scan", "experiment")} for b in a.section4]
    data = {
        "format": FORMAT,
        "fast": result.fast,
        "table": [{**dataclasses.asdict(r), "closer": r.closer, "closer_printed": r.closer_printed} for r in result.table],
        "cases": result.cases,
        "around": result.around.as_data(),
        "claims": [dataclasses.asdict(c) for c in result.claims],
        "errata": [dataclasses.asdict(e) for e in result.errata],
        "equations": [dataclasses.asdict(e) for e in result.equations],
        "coexistence": result.coexistence.as_data(),
        "amplitudes": {
            "section4": [
                {"tilt_deg": b.experiment.tilt_deg, "taken": b.experiment.amplitude, **rest}
                for b, rest in zip(a.section4, brackets, strict=True)
            ],
            "section5": {**dataclasses.asdict(a.section5), "chosen": a.section5.chosen},
            "common": a.common,
        },
        "figures": [
            {"key": p.key, "section": p.section, "title": p.title, "caption": p.caption, "files": [f"figures/{f.name}" for f in p.files]}
            for p in result.figures
        ],
        "report": result.report.name,
        "provenance": result.provenance,
        "seconds": result.seconds,
    }
    return strict(data, _key)


def _key(key: Any) -> str:
    return f"{key:g}" if isinstance(key, float) else str(key)
