"""A friction law as MATLAB source, which Octave runs too: one function file that returns a struct of numbers and function handles."""

from __future__ import annotations

from stickslip.engine.lines import literal
from stickslip.engine.portable import Language
from stickslip.engine.symbols import Sym
from stickslip.engine.traced_law import TracedLaw
from stickslip.exporting.source import Source
from stickslip.maths import LARGEST

__all__ = ["MATLAB", "written_in_matlab"]

MATLAB = Language(
    "{name} = {value};",
    "choose({held} > 0, {yes}, {no})",
    {
        **{name: name for name in ("log", "sqrt", "sin", "cos", "atan", "tanh", "asinh")},
        **{name: f"limited_{name}" for name in ("exp", "sinh", "cosh", "bell")},
    },
)
#: Functions with the limits that they have in `stickslip.maths`.
LIMITED = {
    "exp": f"exp(min(x, {LARGEST}))",
    "sinh": f"sinh(max(min(x, {LARGEST}), -{LARGEST}))",
    "cosh": f"cosh(max(min(x, {LARGEST}), -{LARGEST}))",
    "bell": "1 / cosh(max(min(x, 300), -300))^2",
}


class _File(Source):
    """The functions of the file; the public ones stand in the struct."""

    language, number, state, memory, first = MATLAB, "p.{}", "s.z({})", "s.mode({})", 1

    def __init__(self, law: TracedLaw):
        super().__init__(law)
        self.public: list[str] = []

    def function(self, head: str, lines: list[str]) -> None:
        """One function."""
        self.parts.append("\n".join([f"function {head}", *lines, "end"]))

    def values(self, head: str, roots: dict[str, Sym], before: str = "") -> None:
        """A function that fills in places."""
        lines, ends = self.body(roots.values())
        filled = [f"    {place} = {end};" for place, end in zip(roots, ends, strict=True)]
        self.function(head, [*([f"    {before}"] if before else []), *lines, *filled])

    def text(self, told: list[str], name: str) -> str:
        """The whole file."""
        used = "\n".join(self.parts)
        helpers = [f"function y = limited_{key}(x)\n    y = {text};\nend" for key, text in LIMITED.items() if f"limited_{key}(" in used]
        if "choose(" in used:
            helpers.append("function y = choose(held, yes, no)\n    if held\n        y = yes;\n    else\n        y = no;\n    end\nend")
        lines = [f"function law = {name}()", *(f"% {line}" for line in told), "    law.numbers = struct();"]
        lines += [f"    law.numbers.{field} = {literal(value)};" for field, value in self.fields.items()]
        lines += [f"    law.{one} = @{one};" for one in self.public]
        return "\n\n".join(["\n".join([*lines, "end"]), *self.parts, *helpers]) + "\n"


def written_in_matlab(law: TracedLaw, name: str, told: list[str]) -> str:
    """The file."""
    made = _File(law)
    if not law.law.dynamic:
        _set_valued(made)
    elif law.z or law.mode:
        _with_memory(made)
    else:
        made.values(f"R = force(p, v, load{made.applied})", {"R": law.force})
        made.public = ["force"]
    return made.text(told, name)


def _set_valued(made: _File) -> None:
    backward, forward = made.law.breakaway
    made.values("R = sliding(p, v, load)", {"R": made.law.force})
    made.values("[backward, forward] = breakaway(p, load)", {"backward": backward, "forward": forward})
    made.parts.append(_AT_REST)
    made.public = ["sliding", "breakaway", "force", "step"]


def _with_memory(made: _File) -> None:
    law, n, modes = made.law, len(made.law.z), len(made.law.mode)
    fresh = f"s = struct('z', zeros({n}, 1), 'mode', zeros({modes}, 1), 'side', 0);"
    made.values("s = start(p, load)", {f"s.z({i + 1}, 1)": z for i, z in enumerate(law.start)}, fresh)
    made.values(f"R = force(p, s, v, load{made.applied})", {"R": law.force})
    made.values("f = rate(p, s, v, load)", {f"f({i + 1}, 1)": rate for i, rate in enumerate(law.rates)}, f"f = zeros({n}, 1);")
    if law.alone:
        slopes, columns = {f"J({i + 1}, 1)": law.slopes[i][i] for i in range(n)}, 1
    else:
        slopes, columns = {f"J({i + 1}, {j + 1})": law.slopes[i][j] for i in range(n) for j in range(n)}, n
    made.values("J = slopes(p, s, v, load)", slopes, f"J = zeros({n}, {columns});")
    made.parts.append(_ALONE if law.alone else _TOGETHER)
    if law.switches:
        _switching(made)
    step = _SWITCHING_STEP if law.switches else _STEP
    made.parts.append(step.replace("COUNT", str(len(law.switches))).replace("MORE", made.applied))
    made.public = ["start", "force", "rate", "step"]


def _switching(made: _File) -> None:
    law = made.law
    guards = {f"g({k + 1}, 1)": guard for k, (guard, _, _) in enumerate(law.switches)}
    made.values("g = guards(p, s, v, load)", guards, f"g = zeros({len(guards)}, 1);")
    cases = ["    after = s;"]
    for k, (_, modes, z) in enumerate(law.switches):
        lines, ends = made.body([*modes, *z])
        places = [f"after.mode({i + 1}) = {end};" for i, end in enumerate(ends[: len(modes)])]
        places += [f"after.z({i + 1}) = {end};" for i, end in enumerate(ends[len(modes) :])]
        cases += [f"    if which == {k + 1}", *(f"    {line}" for line in lines), *(f"        {place}" for place in places), "    end"]
    made.function("after = switched(p, s, v, load, which)", cases)


_AT_REST = """\
function R = force(p, v, load, holding)
% Friction force; at rest it is what would hold the body, as far as the contact bears it.
    if v ~= 0
        R = sliding(p, v, load);
    else
        [backward, forward] = breakaway(p, load);
        R = min(max(holding, backward), forward);
    end
end

function R = step(p, v, load, needed)
% Friction force of one time step; needed = applied + mass v / dt would leave the body at rest at its end.
    if v ~= 0
        R = sliding(p, v, load);
        if (needed - R) * v >= 0
            return % it does not turn round in this step
        end
    end
    R = force(p, 0, load, needed);
end"""
_ALONE = """\
function s = advance(p, s, v, load, dt)
% The states after a time for which v, load and memory are held.
    x = dt * slopes(p, s, v, load);
    grown = expm1(x) ./ x;
    grown(x == 0) = 1;
    s.z = s.z + dt * rate(p, s, v, load) .* grown;
end"""
_TOGETHER = """\
function s = advance(p, s, v, load, dt)
% The states after a time for which v, load and memory are held.
    n = numel(s.z);
    E = expm([dt * slopes(p, s, v, load), dt * rate(p, s, v, load); zeros(1, n + 1)]);
    s.z = s.z + E(1:n, n + 1);
end"""
_STEP = """\
function [s, R] = step(p, s, v, load, dtMORE)
% Advances the states over dt; R is the friction force at its end.
    s = advance(p, s, v, load, dt);
    R = force(p, s, v, loadMORE);
end"""
_SWITCHING_STEP = """\
function s = turned(p, s, v, load)
% What switches where v comes to zero from a side, and for nothing else.
    if s.side ~= 0 && sign(v) ~= s.side
        done = false(COUNT, 1);
        for tries = 1:COUNT
            due = find(~done & guards(p, s, 0, load) <= 0 & guards(p, s, s.side * 1e-300, load) > 0, 1);
            if isempty(due)
                break
            end
            s = switched(p, s, 0, load, due);
            done(due) = true;
        end
    end
    s.side = sign(v);
end

function [s, R] = step(p, s, v, load, dtMORE)
% Advances the states over dt, from switch to switch; R is the friction force at its end.
    held = v;
    if v == 0
        held = 1e-300 * choose(s.side < 0, -1, 1);
    end
    s = turned(p, s, v, load);
    left = dt;
    done = false(COUNT, 1);
    for turns = 1:1000
        first = guards(p, s, held, load);
        fallen = find(first <= 0 & ~done, 1);
        if ~isempty(fallen) % a guard that has fallen already
            s = switched(p, s, held, load, fallen);
            done(fallen) = true;
            continue
        end
        after = advance(p, s, held, load, left);
        which = find(first > 0 & guards(p, after, held, load) <= 0, 1);
        if isempty(which)
            s = after;
            break
        end
        low = 0;
        high = left;
        for halvings = 1:60
            middle = 0.5 * (low + high);
            fallen = find(first > 0 & guards(p, advance(p, s, held, load, middle), held, load) <= 0, 1);
            if isempty(fallen)
                low = middle;
            else
                high = middle;
                which = fallen;
            end
        end
        s = switched(p, advance(p, s, held, load, high), held, load, which);
        left = left - high;
        done(:) = false;
        done(which) = true;
    end
    R = force(p, s, v, loadMORE);
end"""
