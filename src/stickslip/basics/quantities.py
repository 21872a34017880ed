"""The description of a number, in its field's metadata: symbol, unit, words, bounds, example, and slider range.

Error messages, axes, the explorer, the equations, the command line and the notation page's test read it there and nowhere else.
"""

from __future__ import annotations

import functools
import math
import re
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.lazy_names import listing

__all__ = ["Rule", "at_least", "between", "positive", "quantity"]
__dir__ = listing(__all__)


@dataclass(frozen=True)
class Rule:
    """A rule for a number: a test of value(s), and its description, in which {kind} stands for the kind of its unit.

    Examples
    --------
    >>> positive(2.0), positive.words
    (True, 'a positive {kind}')
    """

    holds: Callable[[Any], Any]
    words: str

    def __call__(self, value: Numeric) -> Any:
        """Whether value(s) are allowed."""
        return self.holds(value)


positive = Rule(lambda value: value > 0, "a positive {kind}")


@functools.cache
def at_least(bound: float) -> Rule:
    """Not below `bound`."""
    return Rule(lambda value: value >= bound, {0.0: "zero", 1.0: "one"}.get(bound, f"{bound:g}") + " or more")


@functools.cache
def between(low: float, high: float) -> Rule:
    """From `low` to `high`."""
    return Rule(lambda value: (value >= low) & (value <= high), f"from {low:g} to {high:g}")


#: What a unit measures, as messages call it.
_KINDS = {
    "kg": "mass", "m": "length", "s": "time", "m/s": "velocity", "m/s^2": "acceleration", "rad/s": "angular frequency", "rad": "angle",
    "Hz": "frequency", "N": "force", "N/m": "stiffness", "N m/rad": "stiffness", "N/s": "force rate", "N/m^2": "modulus",
    "kg/m^3": "density", "kg m^2": "moment of inertia",
}  # fmt: skip
#: How many of a unit that is shown make one of the SI unit.
_FACTORS = {"m": 1e3, "µ": 1e6, "k": 1e-3}
_SHOWN = {"°": 180 / math.pi, "g": 1e3}


def quantity(
    label: str,
    unit: str = "1",
    symbol: str = "",
    *,
    example: Any = 1.0,
    rule: Rule | None = None,
    allowed: str = "",
    range: tuple[float, float] | None = None,
    shown: str = "",
) -> dict[str, Any]:
    r"""The description of a number, for the metadata of a field or for `Annotated`.

    Parameters
    ----------
    label : str
        What it is, in a few words.
    unit : str
        Its SI unit; "1" for a bare number.
    symbol : str
        Its letter in LaTeX, such as ``\mu_{+}``.
    example : float or tuple of float
        A typical value: the suggestion in messages, and the initial position of the slider.
    rule : Rule, optional
        The allowed values, such as ``stickslip.quantities.positive``; any finite number if not given.
    allowed : str, optional
        The allowed values in words, if those of the rule are not sufficient.
    range : (float, float), optional
        The two ends of its slider.
    shown : str, optional
        The unit in which the explorer shows it: mm, ms, kN/m, °.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        For arguments that are not text, numbers, an increasing range, or a unit that can be shown.

    Examples
    --------
    >>> from dataclasses import dataclass, field
    >>> from stickslip.basics.fields import Frozen
    >>> from stickslip.basics.quantities import positive
    >>> @dataclass(frozen=True, eq=False)
    ... class Pad(Frozen):
    ...     width: float = field(metadata=quantity("width of the pad", "m", "b", example=0.02, rule=positive, shown="mm"))
    >>> Pad(width=-1.0)
    Traceback (most recent call last):
    stickslip.basics.errors.InputError: Pad: width = -1.0; allowed is a positive length [m]; type for example width=0.02
    """
    _check(label, unit, symbol, example, rule, allowed, range, shown)
    optional = {"symbol": symbol, "rule": rule, "allowed": allowed, "range": range, "shown": shown}
    return {"label": label, "unit": unit, "example": example, **{name: value for name, value in optional.items() if value}}


def _check(label: Any, unit: Any, symbol: Any, example: Any, rule: Any, allowed: Any, range: Any, shown: Any) -> None:
    problems = Problems("quantity")
    for name, value in {"label": label, "unit": unit, "symbol": symbol, "allowed": allowed, "shown": shown}.items():
        if not isinstance(value, str):
            problems.add(f'{name} = {value!r}; allowed is text; type for example {name}="m"')
    if not all(map(_is_number, example if isinstance(example, tuple) else (example,))) and example is not None:
        problems.add(f"example = {example!r}; allowed is a number, or a tuple of numbers; type for example example=0.1")
    if not (rule is None or callable(rule)):
        problems.add(f"rule = {rule!r}; allowed is a function of a number; type rule=stickslip.quantities.positive")
    if range is not None and not (isinstance(range, tuple) and len(range) == 2 and all(map(_is_number, range)) and range[0] < range[1]):
        problems.add(f"range = {range!r}; allowed are two numbers that rise; type for example range=(0.0, 1.0)")
    if isinstance(shown, str) and shown and shown not in _SHOWN and shown[0] not in _FACTORS:
        problems.add(f"shown = {shown!r}; allowed is a unit with m, µ or k before it, g or °; type for example shown='mm'")
    problems.check()


def _is_number(value: Numeric) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def allowed_in(description: Mapping[str, Any], optional: bool = False) -> str:
    """The allowed values of a number, in words."""
    unit, rule = str(description.get("unit", "1")), description.get("rule")
    kind = _KINDS.get(unit, "number")
    words = description.get("allowed") or (rule.words.format(kind=kind) if rule else "a finite number")
    return words + (f" [{unit}]" if unit not in ("1", "") and "[" not in words else "") + (", or None" if optional else "")


def example_of(description: Mapping[str, Any], several: bool = False) -> str:
    """An example of a number, or of several."""
    example = description.get("example", (0.5, 0.5) if several else 1.0)
    return f"{example:.6g}" if isinstance(example, float) else str(example)


def holding(words: Mapping[str, str], units: Mapping[str, str] | None = None) -> dict[str, Any]:
    """For the metadata of a field that holds a record: what its numbers are of there, and in which units.

    A `Harmonic` is that of an inner mass [m]; as the target of a controller it is an angle [rad].

    Examples
    --------
    >>> told = description_inside(quantity("amplitude of the inner mass", "m"), holding({"the inner mass": "the target"}, {"m": "rad"}))
    >>> told["label"], told["unit"]
    ('amplitude of the target', 'rad')
    """
    return {"words": words, "units": units or {}}


def description_inside(description: Mapping[str, Any], held: Mapping[str, Any]) -> Mapping[str, Any]:
    """The description of a number within a field that was described by `holding`."""
    if "label" not in description or not held.get("words"):
        return description
    label = str(description["label"])
    for word, there in held["words"].items():
        label = label.replace(word, there)
    unit = held["units"].get(description.get("unit"))
    kept = (
        description if unit is None else {name: of for name, of in description.items() if name not in ("shown", "range")} | {"unit": unit}
    )
    return {**kept, "label": label}


def axis_in(description: Mapping[str, Any]) -> tuple[str, str] | None:
    r"""The axis label of a number, and its unit; None if its field has no description.

    Examples
    --------
    >>> axis_in(quantity("bristle stiffness", "N/m", r"\sigma_{0}")), axis_in({})
    (('bristle stiffness σ₀', 'N/m'), None)
    """
    if "label" not in description:
        return None
    return f"{description['label']} {symbol_text(description.get('symbol', ''))}".rstrip(), str(description.get("unit", "1"))


def shown_factor(description: Mapping[str, Any]) -> tuple[str, float]:
    """The unit in which a number is shown, and by what its value is multiplied for that."""
    unit, shown = str(description.get("unit", "1")), str(description.get("shown", ""))
    if unit == "degrees":
        return "°", 1.0
    if not shown:
        return "" if unit == "1" else pretty_unit(unit), 1.0
    return shown, _SHOWN.get(shown) or _FACTORS[shown[0]]


def pretty_unit(unit: str) -> str:
    """A unit with its powers raised: m/s²."""
    return re.sub(r"\^(\d)", lambda match: "⁰¹²³⁴⁵⁶⁷⁸⁹"[int(match[1])], unit)


#: Units that people think of in another one: a factor, and its name.
_ALSO = {"rad/s": (0.5 / math.pi, " Hz"), "rad": (180 / math.pi, "°")}


def with_unit(value: float, unit: str) -> str:
    """A number with its unit, and angles and angular frequencies in degrees and hertz too; first what was typed, the shorter number.

    Examples
    --------
    >>> with_unit(0.06, "kg"), with_unit(0.05236, "rad"), with_unit(0.15, "1")
    ('0.06 kg', '0.05236 rad (3.00001°)', '0.15')
    >>> with_unit(251.327412, "rad/s"), with_unit(205.5, "rad/s")
    ('40 Hz (251.327 rad/s)', '205.5 rad/s (32.7063 Hz)')
    """
    shown = f"{value:.6g}" if unit in ("", "1") else f"{value:.6g} {pretty_unit(unit)}"
    also = also_in(value, unit)
    if unit == "rad/s" and also and len(also.split()[0]) < len(shown.split()[0]):
        shown, also = also, shown
    return f"{shown} ({also})" if also else shown


def also_in(value: float, unit: str) -> str:
    """The number in the other unit that people think of; empty if there is none.

    Examples
    --------
    >>> also_in(251.327412, "rad/s"), also_in(0.06, "kg")
    ('40 Hz', '')
    """
    factor, other = _ALSO.get(unit, (0.0, ""))
    return f"{value * factor:.6g}{other}" if other and value else ""


_INDICES, SUBSCRIPTS = "0123456789+-aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉₊₋ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ"
#: Subscripts as letters and digits on the line.
LINES = str.maketrans(SUBSCRIPTS, _INDICES)
_SUBSCRIPTS = str.maketrans(_INDICES, SUBSCRIPTS)


def symbol_text(latex: str) -> str:
    r"""A symbol as plain text.

    Examples
    --------
    >>> [symbol_text(s) for s in (r"\mu_{+}", "v_{s}", "z_{ba}", r"\varphi", "D_{c}", r"u_{\mathrm{max}}")]
    ['μ₊', 'vₛ', 'z_ba', 'φ', 'D_c', 'uₘₐₓ']
    """
    upright = re.sub(r"\\mathrm\{([^{}]*)\}", r"\1", latex)
    text = re.sub(r"\\(?:var)?([A-Za-z]+)", _greek, upright).replace(" ", "")
    return re.sub(r"_\{?([^{}]+)\}?", _subscript, text)


def _greek(match: re.Match[str]) -> str:
    try:
        case = "CAPITAL" if match[1][0].isupper() else "SMALL"
        return unicodedata.lookup(f"GREEK {case} LETTER {match[1].replace('lambda', 'lamda')}")
    except KeyError:
        return {"ell": "ℓ"}.get(match[1], "")


def _subscript(match: re.Match[str]) -> str:
    raised = match[1].translate(_SUBSCRIPTS)
    return raised if all(one != other for one, other in zip(raised, match[1], strict=True)) else f"_{match[1]}"


# ---- numbers that records of several packages have ----
_FREQUENCY = "a positive angular frequency [rad/s] (or give frequency= in Hz)"
MASS = quantity("mass", "kg", "m", example=0.05, rule=positive)
BODY_MASS = quantity("mass of the body", "kg", "M", example=62.59e-3, rule=positive, range=(0.01, 0.2), shown="g")
INNER_MASS = quantity("inner mass", "kg", "m", example=9.48e-3, rule=positive, range=(1e-3, 0.05), shown="g")
#: Far beyond planets and centrifuges: below it nothing presses, and above it nothing slides.
_SMALL_GRAVITY, _LARGE_GRAVITY = 0.01, 100.0  # of an asteroid, and of the largest planets a few times over
GRAVITIES = between(1e-6, 1e6)
GRAVITY = quantity(
    "acceleration of gravity", "m/s^2", "g", example=9.81, rule=GRAVITIES, allowed="a positive acceleration from 1e-6 to 1e6 m/s^2",
    range=(1.0, 15.0),
)  # fmt: skip
#: Of |v/v_s| and the like: measured ones lie between 0.05 and 4; with larger ones than these the powers overflow.
EXPONENTS = between(0.01, 20.0)
#: Amplitudes [m] of the four experiments of the founding paper by the tilt of the track [degrees]. The paper does not print them: they are
#: inferred, those at which its eight simulated mean velocities and four motion types come out with break-away at f0 (`stickslip paper`).
PAPER_AMPLITUDES = {1.7: 5.56e-4, 2.7: 6.04e-4, 4.7: 4.58e-4, 5.7: 1.487e-3}
AMPLITUDE = quantity(
    "amplitude of the inner mass", "m", "A", example=PAPER_AMPLITUDES[1.7], rule=at_least(0.0), range=(0.0, 1.6e-3), shown="mm"
)  # fmt: skip
OMEGA = quantity("angular frequency", "rad/s", r"\omega", example=65.4 * math.pi, rule=positive, allowed=_FREQUENCY, range=(60.0, 400.0))
FREQUENCY = quantity("frequency", "Hz", "f", example=32.7, rule=positive, range=(5.0, 60.0))
PERIOD = quantity(
    "period", "s", "T", example=0.03, rule=positive, allowed="a positive period [s]", range=(0.005, 0.1), shown="ms"
)  # fmt: skip
PHASE = quantity("phase", "rad", r"\varphi", example=1.57, allowed="an angle [rad]", range=(-math.pi, math.pi), shown="°")
STIFFNESS = quantity("stiffness of the spring", "N/m", "k", example=1200.0, rule=at_least(0.0))
DAMPING = quantity("damping", "N s/m", "c", example=0.4, rule=at_least(0.0))
LENGTH = quantity("length at rest", "m", r"\ell", example=0.05)
LOAD = quantity("normal force", "N", "N", example=1.0, rule=positive)
STROKE = quantity("stroke of the inner mass", "m", "L", example=0.01, rule=positive, range=(1e-3, 0.03), shown="mm")
TILT = quantity(
    "tilt of the track", "rad", r"\theta", example=0.03, allowed='an angle between -pi/2 and pi/2 [rad], or text such as "3 deg"',
    shown="°", rule=Rule(lambda x: abs(x) < math.pi / 2, ""), range=(-0.15, 0.15),
)  # fmt: skip
TILT_DEG = quantity(
    "tilt of the track", "degrees", r"\theta", example=1.7, allowed="any angle below the friction angle [degrees]", range=(-8.0, 8.0)
)  # fmt: skip
VOLTAGE = quantity("voltage on the patches", "V", "V", example=20.0, rule=at_least(0.0), range=(0.0, 60.0))


def remarks_on_gravity(gravity: Numeric) -> list[str]:
    """A remark on a gravity that nobody has, such as one typed in mm/s^2.

    Examples
    --------
    >>> remarks_on_gravity(9.81), remarks_on_gravity(9810.0)
    ([], ['gravity = 9810 m/s^2 is 1e+03 times that of the Earth; if that is not meant, type gravity=9.81'])
    """
    import numpy as np

    far = [float(g) for g in np.unique(np.asarray(gravity, float)) if not _SMALL_GRAVITY <= g <= _LARGE_GRAVITY]
    return [f"gravity = {g:g} m/s^2 is {g / 9.81:.2g} times that of the Earth; if that is not meant, type gravity=9.81" for g in far[:1]]
