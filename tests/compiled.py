"""Exported laws as functions that Python can call: compiled C through ctypes, and Octave for the MATLAB text."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.models.friction.law_adapter import adapted

__all__ = ["CC", "OCTAVE", "CompiledLaw", "compiled_laws", "octave_steps"]

CC = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
OCTAVE = shutil.which("octave-cli") or shutil.which("octave")


@dataclass(frozen=True)
class CompiledLaw:
    """The functions of one law in a shared library, and the law itself."""

    name: str
    law: Any
    library: Any

    def _call(self, what: str, *arguments: Any) -> Any:
        function = getattr(self.library, f"{self.name}_{what}_c")
        function.restype = ctypes.c_double
        return function(*(a if isinstance(a, ctypes.Array) else ctypes.c_double(a) for a in arguments))

    def force(self, v: float, load: float, z: Any = (), mode: Any = (), applied: float = 0.0) -> float:
        """Friction force."""
        return float(self._call("force", v, load, _doubles(z), _ints(mode), applied))

    def rate(self, v: float, load: float, z: Any, mode: Any = ()) -> list[float]:
        """Rates of the inner states."""
        found = _doubles((0.0,) * len(z))
        self._call("rate", v, load, _doubles(z), _ints(mode), found)
        return list(found)[: len(z)]

    def breakaway(self, load: float) -> tuple[float, float]:
        """What it holds."""
        found = _doubles((0.0, 0.0))
        self._call("breakaway", load, found)
        return found[0], found[1]

    def held(self, v: float, load: float, needed: float) -> float:
        """The force of a time step of a set-valued law."""
        return float(self._call("step", v, load, needed))

    def steps(self, velocities: Any, load: float, dt: float) -> list[float]:
        """Forces after each of some steps from a fresh contact, at one velocity each."""
        found = _doubles((0.0,) * len(velocities))
        function = getattr(self.library, f"{self.name}_steps_c")
        function(ctypes.c_int(len(velocities)), _doubles(velocities), ctypes.c_double(load), ctypes.c_double(dt), found)
        return list(found)


def _doubles(values: Any) -> Any:
    return (ctypes.c_double * max(len(values), 1))(*values)


def _ints(values: Any) -> Any:
    return (ctypes.c_int * max(len(values), 1))(*(int(v) for v in values))


def _wrapped(name: str, law: Any) -> str:
    """Functions of one shape around those of a law."""
    own = adapted(law)
    lines = [f'#include "{name}.h"', f"static const {name}_numbers *const p_{name} = &{name}_fitted;"]
    if not own.dynamic:
        return "\n".join([*lines, f"""
double {name}_force_c(double v, double load, double *z, int *mode, double applied) {{
    (void)z; (void)mode; return {name}_force(p_{name}, v, load, applied); }}
double {name}_step_c(double v, double load, double needed) {{ return {name}_step(p_{name}, v, load, needed); }}
double {name}_breakaway_c(double load, double *found) {{ {name}_breakaway(p_{name}, load, &found[0], &found[1]); return 0.0; }}
"""])  # fmt: skip
    applied = ", applied" if own.needs_applied else ""
    if not own.states and not own.modes:
        return "\n".join([*lines, f"""
double {name}_force_c(double v, double load, double *z, int *mode, double applied) {{
    (void)z; (void)mode; (void)applied; return {name}_force(p_{name}, v, load{applied}); }}
"""])  # fmt: skip
    fill = "".join(f" s.z[{i}] = z[{i}];" for i in range(own.states)) + "".join(f" s.mode[{i}] = mode[{i}];" for i in range(own.modes))
    return "\n".join([*lines, f"""
static {name}_state {name}_of(double load, double *z, int *mode) {{
    {name}_state s = {name}_start(p_{name}, load); (void)mode;{fill} return s; }}
double {name}_force_c(double v, double load, double *z, int *mode, double applied) {{
    {name}_state s = {name}_of(load, z, mode); (void)applied; return {name}_force(p_{name}, &s, v, load{applied}); }}
double {name}_rate_c(double v, double load, double *z, int *mode, double *f) {{
    {name}_state s = {name}_of(load, z, mode); {name}_rate(p_{name}, &s, v, load, f); return 0.0; }}
void {name}_steps_c(int n, double *v, double load, double dt, double *R) {{
    {name}_state s = {name}_start(p_{name}, load);
    for (int i = 0; i < n; i++) R[i] = {name}_step(p_{name}, &s, v[i], load, dt{', 0.0' if applied else ''}); }}
"""])  # fmt: skip


def compiled_laws(laws: dict[str, Any], folder: Path) -> dict[str, CompiledLaw]:
    """All of them in one library, compiled as strict C99 in which every warning is an error."""
    for name, law in laws.items():
        ss.export_law(law, "c", name=name).save(folder)
    (folder / "all.c").write_text("\n".join(_wrapped(name, law) for name, law in laws.items()))
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-fPIC", "-shared"]
    done = subprocess.run([str(CC), *strict, "all.c", "-o", "all.so", "-lm"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    library = ctypes.CDLL(str(folder / "all.so"))
    return {name: CompiledLaw(name, law, library) for name, law in laws.items()}


def octave_steps(laws: dict[str, Any], velocities: Any, load: float, dt: float, folder: Path) -> dict[str, Any]:
    """Forces after each step by the MATLAB text, run in Octave; of a law without states its force at each velocity."""
    lines = [f"w = [{' '.join(repr(float(v)) for v in velocities)}];"]
    for name, law in laws.items():
        ss.export_law(law, "matlab", name=name).save(folder)
        own = adapted(law)
        remembers = own.states or own.modes
        call = f"[s, R(k)] = l.step(l.numbers, s, w(k), {load!r}, {dt!r});"
        if not remembers:
            more = "" if own.dynamic and not own.needs_applied else ", 0.07"
            call = f"R(k) = l.force(l.numbers, w(k), {load!r}{more});"
        begin = f"s = l.start(l.numbers, {load!r});" if remembers else ""
        lines += [f"l = {name}(); {begin} R = zeros(size(w));", "for k = 1:numel(w)", call, "end", "printf('%.17g ', R); printf('\\n');"]
    (folder / "every_law.m").write_text("\n".join(lines) + "\n")
    done = subprocess.run(
        [str(OCTAVE), "--no-gui", "--norc", "--quiet", "every_law.m"], cwd=folder, capture_output=True, text=True, check=False
    )
    rows = [np.array(row.split(), float) for row in done.stdout.splitlines() if row.strip()]
    assert len(rows) == len(laws), done.stderr
    return dict(zip(laws, rows, strict=True))
