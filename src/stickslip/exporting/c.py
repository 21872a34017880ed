"""A friction law as C99: one file of static functions that includes nothing but <math.h>."""

from __future__ import annotations

import re

from stickslip.engine.lines import literal
from stickslip.engine.portable import Language
from stickslip.engine.symbols import Sym
from stickslip.engine.traced_law import TracedLaw
from stickslip.exporting.source import Source
from stickslip.maths import LARGEST

__all__ = ["C", "written_in_c"]

C = Language(
    "const double {name} = {value};",
    "{held} > 0.0 ? {yes} : {no}",
    {
        **{name: name for name in ("log", "sqrt", "sin", "cos", "atan", "tanh", "asinh")},
        **{name: f"§_{name}_" for name in ("exp", "sinh", "cosh", "bell")},
    },
)  # fmt: skip
#: Functions with the limits that they have in `stickslip.maths`.
LIMITED = {
    "exp": f"exp(x > {LARGEST} ? {LARGEST} : x)",
    "sinh": f"sinh(x > {LARGEST} ? {LARGEST} : (x < -{LARGEST} ? -{LARGEST} : x))",
    "cosh": f"cosh(x > {LARGEST} ? {LARGEST} : (x < -{LARGEST} ? -{LARGEST} : x))",
    "bell": "1.0 / (cosh(x > 300.0 ? 300.0 : (x < -300.0 ? -300.0 : x)) * cosh(x > 300.0 ? 300.0 : (x < -300.0 ? -300.0 : x)))",
}
_P = "const §_numbers *p"


class _File(Source):
    """The file's functions, which get the numbers as p and the state as s."""

    language, number, state, memory, first = C, "p->{}", "s->z[{}]", "(double)s->mode[{}]", 0

    def function(self, gives: str, name: str, takes: str, lines: list[str]) -> None:
        """One function; what it does not use is named as unused, so that no compiler complains."""
        own = [part.split()[-1].lstrip("*") for part in takes.split(", ")]
        text = "\n".join(lines)
        unused = [f"    (void){word};" for word in own if not _uses(text, word)]
        self.parts.append("\n".join([f"static inline {gives} §_{name}({takes})", "{", *unused, *lines, "}"]))

    def value(self, name: str, takes: str, root: Sym) -> None:
        """A function of one number."""
        lines, (end,) = self.body([root])
        self.function("double", name, takes, [*lines, f"    return {end};"])

    def values(self, name: str, takes: str, roots: dict[str, Sym]) -> None:
        """A function that fills in places."""
        lines, ends = self.body(roots.values())
        self.function("void", name, takes, [*lines, *(f"    {place} = {end};" for place, end in zip(roots, ends, strict=True))])

    def text(self, told: list[str], name: str) -> str:
        """The whole file."""
        used = "\n".join(self.parts)
        limited = [
            f"static inline double §_{name}_(double x) {{ return {text}; }}" for name, text in LIMITED.items() if f"§_{name}_(" in used
        ]
        fields = [f"    double {field};" for field in self.fields or ["none"]]
        fitted = [f"    {literal(value)}, /* {field} */" for field, value in (self.fields or {"none": 0.0}).items()]
        lines = ["/*", *(f" * {line}" for line in told), " */"]
        lines += ["#ifndef STICKSLIP_§_H", "#define STICKSLIP_§_H", "", "#include <math.h>", ""]
        lines += ["typedef struct {", *fields, "} §_numbers;", "", "static const §_numbers §_fitted = {", *fitted, "};", ""]
        return "\n".join([*lines, *limited, *([""] if limited else []), "\n\n".join(self.parts), "", "#endif", ""]).replace("§", name)


def _uses(text: str, word: str) -> bool:
    return re.search(rf"\b{word}\b", text) is not None


def written_in_c(law: TracedLaw, name: str, told: list[str]) -> str:
    """The file."""
    made = _File(law)
    if not law.law.dynamic:
        _set_valued(made)
    elif law.z or law.mode:
        _with_memory(made)
    else:
        made.value("force", f"{_P}, double v, double load" + made.applied.replace(" ", " double "), law.force)
    return made.text(told, name)


def _set_valued(made: _File) -> None:
    law = made.law
    made.value("sliding", f"{_P}, double v, double load", law.force)
    backward, forward = law.breakaway
    made.values("breakaway", f"{_P}, double load, double *backward, double *forward", {"*backward": backward, "*forward": forward})
    made.parts.append(_AT_REST)


def _with_memory(made: _File) -> None:
    law, n, modes = made.law, len(made.law.z), len(made.law.mode)
    state = [f"    double z[{n}];"] if n else []
    state += [f"    int mode[{modes}];"] if modes else []
    state += ["    int side; /* of the velocity in the step before: 1, -1 or 0 */"] if law.switches else []
    made.parts.append("\n".join(["typedef struct {", *state, "} §_state;"]))
    lines, ends = made.body(law.start)
    places = [f"    s.z[{i}] = {end};" for i, end in enumerate(ends)]
    reset = [f"    s.mode[{i}] = 0;" for i in range(modes)] + (["    s.side = 0;"] if law.switches else [])
    made.function("§_state", "start", f"{_P}, double load", ["    §_state s;", *lines, *places, *reset, "    return s;"])
    at = f"{_P}, const §_state *s, double v, double load"
    applied = made.applied.replace(" ", " double ")
    made.value("force", at + applied, law.force)
    made.values("rate", f"{at}, double *f", {f"f[{i}]": rate for i, rate in enumerate(law.rates)})
    alone = {f"J[{i}]": law.slopes[i][i] for i in range(n)} if law.alone else {
        f"J[{i * n + j}]": slope for i, row in enumerate(law.slopes) for j, slope in enumerate(row)
    }  # fmt: skip
    made.values("slopes_", f"{at}, double *J", alone)
    made.parts.append((_ALONE if law.alone else _TOGETHER).replace("SIZE", str(n)) if n else _NOTHING)
    if law.switches:
        _switching(made, at)
    step = (_SWITCHING_STEP if law.switches else _STEP).replace("COUNT", str(len(law.switches)))
    made.parts.append(step.replace("TAKES", applied).replace("GIVES", made.applied))


def _switching(made: _File, at: str) -> None:
    law = made.law
    made.values("guards_", f"{at}, double *g", {f"g[{k}]": guard for k, (guard, _, _) in enumerate(law.switches)})
    cases = []
    for k, (_, modes, z) in enumerate(law.switches):
        lines, ends = made.body([*modes, *z])
        places = [f"after.mode[{i}] = (int)({end});" for i, end in enumerate(ends[: len(modes)])]
        places += [f"after.z[{i}] = {end};" for i, end in enumerate(ends[len(modes) :])]
        cases += [f"    if (which == {k}) {{", *(f"    {line}" for line in lines), *(f"        {place}" for place in places), "    }"]
    made.function("§_state", "switched_", f"{at}, int which", ["    §_state after = *s;", *cases, "    return after;"])


_AT_REST = """\
/* Friction force; at rest it is what would hold the body, as far as the contact bears it. */
static inline double §_force(const §_numbers *p, double v, double load, double holding)
{
    double backward, forward;
    if (v > 0.0 || v < 0.0) return §_sliding(p, v, load);
    §_breakaway(p, load, &backward, &forward);
    return holding > forward ? forward : (holding < backward ? backward : holding);
}

/* Friction force of one time step; needed = applied + mass v / dt would leave the body at rest at its end. */
static inline double §_step(const §_numbers *p, double v, double load, double needed)
{
    double sliding;
    if (v > 0.0 || v < 0.0) {
        sliding = §_sliding(p, v, load);
        if ((needed - sliding) * v >= 0.0) return sliding; /* it does not turn round in this step */
    }
    return §_force(p, 0.0, load, needed);
}"""
_NOTHING = """\
/* There are no states that change with time. */
static inline void §_advance_(const §_numbers *p, §_state *s, double v, double load, double dt)
{
    (void)p; (void)s; (void)v; (void)load; (void)dt;
}"""
_ALONE = """\
/* The states after a time for which v, load and memory are held. */
static inline void §_advance_(const §_numbers *p, §_state *s, double v, double load, double dt)
{
    double f[SIZE], J[SIZE];
    int i;
    §_rate(p, s, v, load, f);
    §_slopes_(p, s, v, load, J);
    for (i = 0; i < SIZE; i++) {
        const double x = dt * J[i];
        s->z[i] += dt * f[i] * (x > 0.0 || x < 0.0 ? expm1(x) / x : 1.0);
    }
}"""
_TOGETHER = """\
/* The states after a time for which v, load and memory are held: phi1 and exp of a short time by their series, doubled. */
static inline void §_advance_(const §_numbers *p, §_state *s, double v, double load, double dt)
{
    double f[SIZE], J[SIZE * SIZE], E[SIZE * SIZE], next[SIZE * SIZE], w[SIZE], term[SIZE], more[SIZE], size = 0.0, h = dt;
    int i, j, k, m, doublings = 0;
    §_rate(p, s, v, load, f);
    §_slopes_(p, s, v, load, J);
    for (i = 0; i < SIZE; i++) {
        double sum = 0.0;
        for (j = 0; j < SIZE; j++) sum += fabs(J[i * SIZE + j]);
        if (sum > size) size = sum;
    }
    while (size * h > 0.25 && doublings < 1000) { h *= 0.5; doublings++; }
    for (i = 0; i < SIZE; i++) w[i] = term[i] = h * f[i];
    for (k = 2; k < 14; k++) {
        for (i = 0; i < SIZE; i++) {
            more[i] = 0.0;
            for (j = 0; j < SIZE; j++) more[i] += h / k * J[i * SIZE + j] * term[j];
        }
        for (i = 0; i < SIZE; i++) { term[i] = more[i]; w[i] += more[i]; }
    }
    for (m = 0; m < SIZE; m++) { /* a column of exp(h J) */
        for (i = 0; i < SIZE; i++) { term[i] = i == m ? 1.0 : 0.0; E[i * SIZE + m] = term[i]; }
        for (k = 1; k < 14; k++) {
            for (i = 0; i < SIZE; i++) {
                more[i] = 0.0;
                for (j = 0; j < SIZE; j++) more[i] += h / k * J[i * SIZE + j] * term[j];
            }
            for (i = 0; i < SIZE; i++) { term[i] = more[i]; E[i * SIZE + m] += more[i]; }
        }
    }
    while (doublings-- > 0) {
        for (i = 0; i < SIZE; i++) {
            more[i] = w[i];
            for (j = 0; j < SIZE; j++) more[i] += E[i * SIZE + j] * w[j];
        }
        for (i = 0; i < SIZE; i++) {
            w[i] = more[i];
            for (m = 0; m < SIZE; m++) {
                next[i * SIZE + m] = 0.0;
                for (j = 0; j < SIZE; j++) next[i * SIZE + m] += E[i * SIZE + j] * E[j * SIZE + m];
            }
        }
        for (i = 0; i < SIZE * SIZE; i++) E[i] = next[i];
    }
    for (i = 0; i < SIZE; i++) s->z[i] += w[i];
}"""
_STEP = """\
/* Advances the states over dt and returns the friction force at its end. */
static inline double §_step(const §_numbers *p, §_state *s, double v, double load, double dtTAKES)
{
    §_advance_(p, s, v, load, dt);
    return §_force(p, s, v, loadGIVES);
}"""
_SWITCHING_STEP = """\
/* What switches where v comes to zero from a side, and for nothing else. */
static inline void §_turned_(const §_numbers *p, §_state *s, double v, double load)
{
    const int side = v > 0.0 ? 1 : (v < 0.0 ? -1 : 0);
    int k, tries, done[COUNT] = {0};
    double here[COUNT], beside[COUNT];
    if (s->side != 0 && side != s->side) {
        for (tries = 0; tries < COUNT; tries++) {
            §_guards_(p, s, 0.0, load, here);
            §_guards_(p, s, s->side * 1e-300, load, beside);
            for (k = 0; k < COUNT && (done[k] || here[k] > 0.0 || beside[k] <= 0.0); k++) { }
            if (k == COUNT) break;
            *s = §_switched_(p, s, 0.0, load, k);
            done[k] = 1;
        }
    }
    s->side = side;
}

/* Advances the states over dt, from switch to switch, and returns the friction force at its end. */
static inline double §_step(const §_numbers *p, §_state *s, double v, double load, double dtTAKES)
{
    const int before = s->side;
    double left = dt, first[COUNT], last[COUNT], held;
    int k, turns, halvings, done[COUNT] = {0};
    §_turned_(p, s, v, load);
    held = v > 0.0 || v < 0.0 ? v : (before < 0 ? -1e-300 : 1e-300);
    for (turns = 0; turns < 1000; turns++) {
        §_state after = *s;
        §_guards_(p, s, held, load, first);
        for (k = 0; k < COUNT && (first[k] > 0.0 || done[k]); k++) { }
        if (k < COUNT) { /* a guard that has fallen already */
            *s = §_switched_(p, s, held, load, k);
            done[k] = 1;
            continue;
        }
        §_advance_(p, &after, held, load, left);
        §_guards_(p, &after, held, load, last);
        for (k = 0; k < COUNT && !(first[k] > 0.0 && last[k] <= 0.0); k++) { }
        if (k == COUNT) { *s = after; break; }
        double low = 0.0, high = left;
        int which = k;
        for (halvings = 0; halvings < 60; halvings++) {
            const double middle = 0.5 * (low + high);
            after = *s;
            §_advance_(p, &after, held, load, middle);
            §_guards_(p, &after, held, load, last);
            for (k = 0; k < COUNT && !(first[k] > 0.0 && last[k] <= 0.0); k++) { }
            if (k < COUNT) { high = middle; which = k; }
            else low = middle;
        }
        §_advance_(p, s, held, load, high);
        *s = §_switched_(p, s, held, load, which);
        left -= high;
        for (k = 0; k < COUNT; k++) done[k] = 0;
        done[which] = 1;
    }
    return §_force(p, s, v, loadGIVES);
}"""
