"""Errors that state the value given, the values allowed and the text to type."""

from __future__ import annotations

import difflib
import errno
import math
import operator
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard

if TYPE_CHECKING:
    from stickslip.basics.contracts import Model


class StickslipError(Exception):
    """Base class of the errors of this package."""


class InputError(StickslipError, ValueError):
    """An invalid input; `problems` holds one sentence for each mistake.

    Examples
    --------
    >>> import stickslip as ss
    >>> try:
    ...     ss.Harmonic(amplitude=-1e-3, omega=float("nan"))
    ... except ss.InputError as error:
    ...     len(error.problems)
    2
    """

    def __init__(self, what: str, problems: Iterable[str]):
        self.what = what
        self.problems = tuple(problems)
        super().__init__(self._message())

    def __reduce__(self) -> tuple[Any, ...]:
        # By default an exception is pickled with its message; a process pool needs the arguments of its constructor.
        return type(self), (self.what, self.problems)

    def _message(self) -> str:
        if len(self.problems) == 1:
            return f"{self.what}: {self.problems[0]}"
        return f"{self.what}: {len(self.problems)} problems\n" + "\n".join(f"  - {p}" for p in self.problems)


class OneContactNeeded(InputError, AttributeError):
    """A machine that lists its bodies and contacts, where one body on one contact is needed.

    It is an AttributeError too, so that `hasattr` is False for a law or a load of its own.

    Examples
    --------
    >>> import stickslip as ss
    >>> try:
    ...     ss.analysis.dimensionless(ss.Chain.example())
    ... except ss.InputError as error:
    ...     print(str(error)[:89])
    dimensionless: Chain has no friction of its own, because it lists its bodies and contacts
    """

    @classmethod
    def of(cls, model: Model, name: str) -> OneContactNeeded:
        """The error for a request of `name` from the only body or contact of a model that has several."""
        kind = type(model).__name__
        why = f"{kind} has no {name} of its own, because it lists its bodies and contacts"
        allowed = "allowed are machines of one body on one contact, such as a Robot, a BlockOnBelt or a ForcedOscillator"
        typed = f'type ss.solve({kind.lower()}) for its motion; the docs\' page "Which machine" lists what takes it'
        return cls(kind, [f"{why}; {allowed}; {typed}"])


class NoBodies(InputError, AttributeError):
    """A flow's run, where a run of bodies is needed. It is an AttributeError too, so that `hasattr` is False for what bodies have."""


class SolveError(StickslipError, RuntimeError):
    """A single run that could not be finished; in a batch it becomes a status.

    `status` is its number among those of `stickslip.basics.status.Status`, where the solver knows one.
    """

    def __init__(self, message: str = "", status: int | None = None):
        super().__init__(message)
        self.status = status


class Problems:
    """Collects the problems with one input, so that all of them are reported at once."""

    def __init__(self, what: str):
        self.what = what
        self.mistakes: list[str] = []

    def add(self, sentence: str) -> None:
        """Note one problem."""
        self.mistakes.append(sentence)

    def whole(self, name: str, value: Any, least: int, example: int, what: str = "", most: int = 10**12) -> None:
        """Note a value that is not a Python or NumPy whole number from `least` to `most`; `what` names the things counted.

        Examples
        --------
        >>> problems = Problems("sweep")
        >>> problems.whole("workers", 2.5, 1, example=2)
        >>> problems.mistakes
        ['workers = 2.5; allowed is a whole number from 1; type for example workers=2']
        """
        if not is_whole(value) or not least <= value <= most:
            end = f" to {most}" if is_whole(value) and value > most else ""
            self.add(f"{name} = {value!r}; allowed is a whole number{what} from {least}{end}; type for example {name}={example}")

    def include(self, error: InputError, prefix: str = "") -> None:
        """Take over the problems of another error, each with `prefix` before it."""
        self.mistakes.extend(prefix + p for p in error.problems)

    def check(self) -> None:
        """Raise one `InputError` with all problems found, if there are any."""
        if self.mistakes:
            raise InputError(self.what, self.mistakes)


def without_advice(sentence: str) -> str:
    """A problem or a note without the parts that say what to type, for readers who do not type Python.

    Examples
    --------
    >>> without_advice("the motion has not settled: no steady value is in sight; type more periods, such as periods=400")
    'the motion has not settled: no steady value is in sight'
    """
    return "; ".join(part for part in sentence.split("; ") if not part.startswith("type "))


def is_number(value: Any) -> bool:
    """Whether a value is one finite number, of Python or NumPy; True and False do not count.

    Examples
    --------
    >>> is_number(3), is_number(float("nan")), is_number(True), is_number([1.0])
    (True, False, False, False)
    """
    import numpy as np

    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool) and bool(np.isfinite(value))


def is_whole(value: Any) -> bool:
    """Whether a value is one whole number, of Python or NumPy; True and False do not count.

    Examples
    --------
    >>> is_whole(3), is_whole(3.0), is_whole(True)
    (True, False, False)
    """
    try:
        operator.index(value)
    except TypeError:
        return False
    return not isinstance(value, bool) and getattr(value, "ndim", 0) == 0 and getattr(getattr(value, "dtype", None), "kind", "i") in "iu"


def is_one_of(value: Any, known: Iterable[str]) -> TypeGuard[str]:
    """Whether a value of any type is one of these words.

    Examples
    --------
    >>> is_one_of("auto", ("auto", "exact")), is_one_of(["auto"], ("auto", "exact"))
    (True, False)
    """
    return isinstance(value, str) and value in known


def as_path(value: Any, what: str, example: str = "run.nc") -> Path:
    """The path of a file or a folder, with ~ expanded; `InputError` named after `what` if the value is not a path.

    Examples
    --------
    >>> as_path("runs/a.nc", "save").name
    'a.nc'
    """
    text = os.fspath(value) if isinstance(value, (str, os.PathLike)) else None
    if isinstance(text, str) and "\0" not in text:
        path = Path(os.path.expanduser(text))  # leaves the ~ of an unknown user unchanged
        try:
            path.is_file()
            return path
        except OSError as error:
            if error.errno != errno.ENAMETOOLONG:
                return path  # a path without access is reported when it is opened
    shown = value if not isinstance(text, str) or len(text) < 200 else f"{text[:60]}... of {len(text)} characters"
    raise InputError(what, [f"{shown!r} is not a path of a file; type for example {example!r}"])


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """A phrase that suggests the closest known name; `otherwise` where none is close, or without it a list of all.

    Examples
    --------
    >>> did_you_mean("coulom", ["coulomb", "lugre"]), did_you_mean("x", ["coulomb", "lugre"])
    ("did you mean 'coulomb'?", 'known: coulomb, lugre')
    """
    known = list(known)
    small = {word.lower(): word for word in known}
    near = [small[word] for word in difflib.get_close_matches(str(name).lower(), small, n=1, cutoff=0.55)]
    return f"did you mean {near[0]!r}?" if near else otherwise or f"known: {', '.join(known)}"


_INCLINE = 'ss.Incline(tilt="{:g} deg")'


def no_attribute(thing: object, name: str, renamed: Mapping[str, str]) -> Any:
    """What `__getattr__` does where there is no such attribute: an `AttributeError` that says what a renamed one is called now.

    Examples
    --------
    >>> no_attribute(1.0, "found", {"found": "special_points"})
    Traceback (most recent call last):
    ...
    AttributeError: float has no 'found'; type special_points
    """
    if name in dir(type(thing)):
        return object.__getattribute__(thing, name)  # a property that failed: its own error again
    raise AttributeError(f"{type(thing).__name__} has no {name!r}" + (f"; type {renamed[name]}" if name in renamed else ""))


_OF_WORKERS = ("n_jobs", "jobs", "parallel", "threads", "cores", "processes", "nproc", "num_workers", "n_workers", "max_workers")


def other_options(name: str, options: Iterable[str]) -> str | None:
    """A suggestion for an option that other packages call otherwise; None for an unknown name.

    Examples
    --------
    >>> other_options("n_jobs", ["workers", "executor"])
    'type workers=4 for threads, executor="processes:4" for processes'
    """
    return 'type workers=4 for threads, executor="processes:4" for processes' if name in _OF_WORKERS and "workers" in options else None


def other_words(name: str, value: Any, known: Iterable[str], equals: str = "=") -> str | None:
    """A suggestion for a number given under a name or in a unit that is not used here; None for an unknown name.

    Examples
    --------
    >>> other_words("tilt_deg", 1.7, ["track.tilt"])
    'angles are in radians here; type track.tilt=0.0296706 for 1.7 degrees'
    >>> other_words("drive.frequency", 30, ["drive.omega"])
    'the frequency is omega, in rad/s; type drive.omega="30 Hz"'
    >>> other_words("freq", 30, ["amplitude", "omega", "frequency"])
    'a frequency is in Hz here; type frequency=30'
    >>> other_words("tilt_deg", 3, ["body_mass", "track"])
    'an incline is a track; type track=ss.Incline(tilt="3 deg")'
    >>> other_words("mu0", 0.18, ["mu_plus", "mu_minus"], " = ")
    'friction has a value for each direction here; type mu_plus = 0.18 and mu_minus = 0.18'
    """
    part, dot, last = name.rpartition(".")
    known = [*known]

    def typed(word: str, given: Any) -> str | None:
        there = [k for k in known if k == f"{part}{dot}{word}"] or [k for k in known if k.rpartition(".")[2] == word]
        return f"{there[0]}{equals}{given if isinstance(given, str) else f'{given:.6g}'}" if there else None

    def given(usual: float) -> float:
        return value if isinstance(value, (int, float)) and abs(value) < 1e300 else usual

    if last in ("frequency", "freq", "f", "hz"):
        if last != "frequency" and (line := typed("frequency", given(40.0))):
            return f"a frequency is in Hz here; type {line}"
        if line := typed("omega", f'"{given(40.0):g} Hz"'):
            return f"the frequency is omega, in rad/s; type {line}"
    if last in ("tilt", "tilt_deg", "slope", "incline") and "tilt" not in known and (line := typed("track", _INCLINE.format(given(1.7)))):
        return f"an incline is a track; type {line}"
    if last in ("tilt_deg", "angle_deg") and (line := typed("tilt", math.radians(given(1.7)))):
        return f"angles are in radians here; type {line} for {given(1.7):g} degrees"
    for words, symbol, usual in ((("mu", "mu0", "mu_k"), "mu", 0.18), (("f0", "mu_s", "fs"), "f", 0.21)):
        sides = [typed(f"{symbol}_{side}", given(usual)) for side in ("plus", "minus")]
        if last in words and all(sides):
            return f"friction has a value for each direction here; type {sides[0]} and {sides[1]}"
    return None
