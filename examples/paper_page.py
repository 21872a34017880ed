"""The docs' page on the paper: its claims with verdicts, and its errata, as `stickslip paper` finds them.

Run: python examples/paper_page.py [numbers.json of a finished `stickslip paper`]
"""

import json
import sys
import tempfile
from pathlib import Path

import stickslip as ss
from stickslip.paper.claims_page import VERDICTS

PAGE = Path(__file__).resolve().parents[1] / "docs" / "paper-revisited.md"
HEAD = """\
# The paper revisited

stickslip began as the code to one paper, “Comparative Analysis of Friction in Vibration-Driven System and Its Dynamic Behaviors”: a body
on an incline with a mass that vibrates inside it, Coulomb friction against LuGre friction, and an experiment. This page says what of it
can be confirmed. One command makes all of it again, with figures 6 to 30 and all numbers for machines:

```bash
stickslip paper
```

*This page is written by `examples/paper_page.py` from what that command found; a test compares the two.*

The report has the paper's equations too, read off the code that solves them, the beam of section 3, and every figure. What stands in
`numbers.json` (`"format": "stickslip-paper-3"`; SI units):

| key | what |
|---|---|
| `table` | section 4: printed and computed mean velocities, types; `intervals`: begin, length and sign of each slide and rest, in periods |
| `cases` | Figures 11 to 30: velocities, types, and the verdict with multipliers and exponents |
| `claims`, `errata` | verdicts with their evidence and numbers |
| `equations` | number, title, LaTeX, and whether it was read off the code (`traced`) |
| `amplitudes` | the inferred ones; `section5.period_two` has `low` and `high`, each with `value`, `kind` and `accuracy` |
| `around` | the map around Figure 23 and its flip curves |
| `coexistence` | section 5.4 from several starts: where two motions exist, and from where to where (`ranges`) |
| `figures`, `provenance`, `seconds`, `fast`, `report` | files, versions and tolerances, duration, extent |

Format 3 differs from format 2 by `equations`, `coexistence` and `intervals`; `period_two` and the rows of `round_values` were intervals and
period numbers of runs on a grid, and are orbits now.

**Amplitudes are inferred.** The paper prints none for section 4 and for sections 5.2 to 5.4. They were found by scanning the amplitude
and keeping what gives the printed numbers. Where a verdict rests on them, it says so.

## Four angles, two laws, one experiment

Mean steady velocities in mm/s, printed and computed (section 4).

| tilt | type, printed | exact type | Coulomb, printed | computed | LuGre, printed | computed | measured |
|---|---|---|---|---|---|---|---|
"""
CLAIMS = """
## What the paper claims

{counts}.

| section | claim | verdict |
|---|---|---|
"""
ERRATA = """
## Errata

What is printed, what is right. “Checked”: the check was computed and agrees; the proofs stand in the report.

| equation or section | printed | right | checked |
|---|---|---|---|
"""
END = """
## What follows for you

- *Folding* an incline into the coefficients is exact for Coulomb friction and another model for LuGre friction; `incline="gravity"` is the
  incline. See [equations of motion](theory/equations-of-motion.md).
- A motion that looks quasi-periodic may be the step size. See [why not my RK4 script?](why-not-rk4.md)
- At large static friction it matters how a LuGre robot is started: it slides from one start and stays near rest from another.
- What lies around Figure 23 is in [period doubling and chaos](tutorials/doubling-and-chaos.md).
"""


def numbers(argument: str | None) -> dict:
    """What a finished reproduction wrote, or a new one's numbers."""
    if argument:
        return json.loads(Path(argument).read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        return ss.paper.reproduce(Path(folder) / "paper").to_dict()


def row(*cells: object) -> str:
    """One row of a table; a bar within a cell would end it."""
    return "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells) + " |\n"


def section4(found: dict) -> str:
    """The table of section 4."""
    lines = []
    for r in found["table"]:
        e, printed, speeds = r["experiment"], "{:.1f}".format, "{:.3f}".format
        computed = [speeds(1e3 * r[law]) for law in ("coulomb", "lugre")]
        lines.append(
            row(f"{e['tilt_deg']}°", e["type"], r["type"], printed(1e3 * e["coulomb"]), computed[0], printed(1e3 * e["lugre"]), computed[1],
                printed(1e3 * e["measured"]))
        )  # fmt: skip
    return "".join(lines)


def claims(found: dict) -> str:
    """The list of claims, and then each with its evidence."""
    kinds = [c["verdict"] for c in found["claims"]]
    counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in VERDICTS)
    text = CLAIMS.format(counts=counts) + "".join(row(c["section"], c["claim"], f"**{c['verdict']}**") for c in found["claims"])
    for c in found["claims"]:
        evidence = "".join(f"- {sentence}\n" for sentence in c["evidence"])
        text += f"\n### {c['claim'].rstrip('.')}\n\n**{c['verdict'].capitalize()}** (section {c['section']}). *“{c['quote'].strip()}”*\n\n"
        text += f"{evidence}\nHow sure: {c['certainty']}.\n"
    return text


def errata(found: dict) -> str:
    """The table of errata."""
    said = {True: "yes", False: "no", None: "by reading"}
    return ERRATA + "".join(row(e["equation"], e["printed"], e["right"], said[e["holds"]]) for e in found["errata"])


def main(argument: str | None = None) -> None:
    """Write the page."""
    found = numbers(argument)
    PAGE.write_text(HEAD + section4(found) + claims(found) + errata(found) + END, encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main(*sys.argv[1:2])
