"""Frozen records whose fields may be numbers, arrays of them, or part of the kind.

A field annotated ``float`` (or ``float | None``) is a number: it may hold a float, a NumPy array or a labelled
`xarray.DataArray`. A field annotated ``tuple[float, ...]`` holds several numbers, named ``field.0``, ``field.1``, …; their count
belongs to the kind. So do a record's parts: one record, or a tuple of records with numbers ``field.0.name``, …. A field annotated
``Mapping[str, float]`` holds numbers under names of their own. Every other field belongs to the kind. A user-defined law needs
nothing from this module.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Collection, Mapping
from typing import Any

from stickslip.basics.constructors import arguments_of, check_arguments, names_and_needed
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, did_you_mean, other_words
from stickslip.basics.field_types import field_types
from stickslip.basics.maths import is_symbol
from stickslip.basics.number_names import numbers_meant
from stickslip.basics.quantities import allowed_in, description_inside, example_of
from stickslip.basics.typed_numbers import in_unit

#: Limit for the magnitude of a record's numbers, so that their squares are finite.
LARGEST = 1e150


def is_array(value: Any) -> bool:
    """Whether a number is an array of numbers."""
    return getattr(value, "ndim", 0) > 0


def are_single(values: Collection[Any]) -> bool:
    """Whether no number is an array of numbers, so that they are those of one case.

    Examples
    --------
    >>> import numpy as np
    >>> are_single([1.0, 2]), are_single([1.0, np.array([2.0, 3.0])])
    (True, False)
    """
    return {*map(type, values)} <= {float} or not any(map(is_array, values))  # the usual case, without further checks


def number(value: Any, unit: str | None = None) -> Any:
    """A value as a float, or as an array of floats with its labels, else `ValueError`; with a unit, "0.55 mm" is accepted too."""
    if type(value) is float:  # the usual case, without further checks
        return value
    value = value if unit is None else in_unit(value, unit)
    if _only_looks_like_one(value):
        raise ValueError(_refused(value))
    if masked := masked_in(value):
        raise ValueError(f"{masked} of its values are masked; leave them out, type array.compressed(), or fill them, array.filled(0.0)")
    try:
        if isinstance(value, (int, float)):
            return float(value)
        if hasattr(value, "dims") and hasattr(value, "astype"):
            return value.astype(float)
        import numpy as np

        array = np.array(value, dtype=float)
    except OverflowError:
        raise ValueError("an integer is too large for a number; the largest is 1.8e308") from None
    except (TypeError, ValueError):
        raise ValueError(_refused(value)) from None
    if array.ndim == 0:
        return float(array)
    array.setflags(write=False)
    return array


def floats(value: Any) -> Any:
    """A number or an array of numbers as an array of floats; empty if `number` refuses the value.

    Examples
    --------
    >>> floats([1, 2]), floats("1").size
    (array([1., 2.]), 0)
    """
    import numpy as np

    try:
        return np.asarray(number(value), float)
    except ValueError:
        return np.empty(0)


def masked_in(value: Any) -> int:
    """Number of masked values of an array."""
    mask = getattr(value, "mask", None)
    return int(mask.sum()) if mask is not None and hasattr(value, "filled") else 0


def _refused(value: Any) -> str:
    many = f"an array of shape {value.shape} and of type {value.dtype} is not an array of numbers" if is_array(value) else ""
    return many or f"{value!r} is not a number"


def _only_looks_like_one(value: Any) -> bool:
    """Whether the value or an entry is one that NumPy may convert, but is not a number: text, True and False, complex numbers, None."""
    if isinstance(value, (list, tuple)):
        return any(map(_only_looks_like_one, value))
    kind = getattr(getattr(value, "dtype", None), "kind", "f")
    if kind == "O" and is_array(value):
        return any(map(_only_looks_like_one, getattr(value, "values", value).ravel().tolist()))
    return value is None or isinstance(value, (bool, str, bytes, complex)) or kind in "bSUcMm"


def everywhere(condition: Any) -> bool:
    """Whether a condition on a number holds; for an array, whether it holds for all entries.

    Examples
    --------
    >>> import numpy as np
    >>> everywhere(2.0 > 1), everywhere(np.array([2.0, 0.5]) > 1)
    (True, False)
    """
    return bool(condition.all()) if hasattr(condition, "all") else bool(condition)


def describe(value: Any) -> str:
    """A value as an error message shows it."""
    if not is_array(value):
        return repr(value)
    import numpy as np

    if value.dtype.kind not in "iuf":
        return f"an array of shape {np.shape(value)} and of type {value.dtype}"
    flat = np.asarray(value, float).ravel()
    numbers = flat[~np.isnan(flat)]
    if numbers.size == 0:
        return f"an array of shape {np.shape(value)}, without {'values' if flat.size == 0 else 'numbers'}"
    return f"an array of shape {np.shape(value)} from {numbers.min():.6g} to {numbers.max():.6g}"


def describe_bad(value: Any, good: Callable[[Any], Any]) -> str:
    """A value as an error message shows it; for an array the first entry that is not allowed, and the number of such entries."""
    if not is_array(value):
        return f" = {value!r}"
    import numpy as np

    array = np.asarray(value)
    bad = np.argwhere(~np.asarray(good(array), bool))
    if len(bad) == 0:
        return f" is {describe(value)}"
    where = tuple(int(i) for i in bad[0])
    return f"[{', '.join(map(str, where))}] = {array[where]:.6g} ({len(bad)} of {array.size} values are not allowed)"


def checked_number(
    name: str, value: Any, problems: Problems, rule: Callable[[Any], Any] | None, allowed: str, typed: str, unit: str | None = None
) -> Any:
    """A number, checked to be finite and to obey its rule; violations are added to `problems`.

    Parameters
    ----------
    name, allowed, typed : str
        Name of the number, the values that `rule` allows in words, and an example to type.
    value : float or array
        The given value.
    problems : Problems
        Receives the sentence.
    rule : callable or None
        Maps value(s) to truth value(s).
    unit : str, optional
        The unit in which it is stored; text such as "0.55 mm" is then allowed too.

    Returns
    -------
    float or array

    Examples
    --------
    >>> from stickslip.basics.quantities import positive
    >>> problems = Problems("robot")
    >>> checked_number("mass", 2, problems, positive, "a positive mass [kg]", "mass=0.06"), problems.mistakes
    (2.0, [])
    >>> _ = checked_number("mass", "2", problems, positive, "a positive mass [kg]", "mass=0.06")
    >>> problems.mistakes
    ["mass: '2' is not a number; allowed is a positive mass [kg]; type for example mass=0.06"]
    >>> checked_number("mass", "60 g", Problems("robot"), positive, "a positive mass [kg]", "mass=0.06", "kg")
    0.06
    """
    if type(value) is float and abs(value) < LARGEST and (rule is None or rule(value)):
        return value
    try:
        value = number(value, unit)
    except ValueError as error:
        problems.add(f"{name}: {error}; allowed is {allowed}; type for example {typed}")
        return value

    def allows(x: Array) -> Any:
        return (abs(x) < LARGEST) & (rule is None or rule(x))

    if is_array(value) and value.size == 0:
        problems.add(f"{name} is {describe(value)}; allowed is {allowed}, or an array with at least one value")
    elif not everywhere(allows(value)):
        problems.add(f"{name}{describe_bad(value, allows)}; allowed is {allowed}; type for example {typed}")
    return value


class Frozen:
    """Base class of the frozen records: checks its numbers once, and can be copied with changes."""

    def __new__(cls, *args: Any, **kwargs: Any) -> Any:
        """Create an empty record after checking the names of the arguments."""
        names, needed = names_and_needed(cls.__init__)
        if args or kwargs:  # copying makes an empty one first
            fits = kwargs.keys() <= names and all(position < len(args) or name in kwargs for position, name in needed)
            if not fits:
                check_arguments(cls.__name__, arguments_of(cls), args, kwargs, lambda: _descriptions_in(cls))
        return super().__new__(cls)

    def __post_init__(self) -> None:
        problems = Problems(type(self).__name__)
        for field, take in _taken(type(self)):  # type: ignore[arg-type]
            getattr(self, take)(field, problems)
        self._check_together(problems)
        problems.check()

    def _check_together(self, problems: Problems) -> None:
        """Check conditions on several fields; errors due to invalid fields are ignored, and records with symbols are not checked."""
        if _holds_symbols(self):
            return
        try:
            self._check(problems)
        except (TypeError, ValueError, ArithmeticError, Warning):
            if not problems.mistakes:
                raise

    def _take(self, field: dataclasses.Field[Any], problems: Problems) -> None:
        value = getattr(self, field.name)
        if value is None and field_types(type(self))[field.name].optional:
            return
        checked = self._checked(field, field.name, value, problems)
        if checked is not value:
            object.__setattr__(self, field.name, checked)

    def _take_tuple(self, field: dataclasses.Field[Any], problems: Problems) -> None:
        values = getattr(self, field.name)
        kind = field_types(type(self))[field.name]
        if values is None and kind.optional:
            return
        if kind.also_one and not isinstance(values, tuple):
            if isinstance(values, list):
                mistake = f"{field.name} = {values!r} is a list; a tuple means one for each part, an array means cases"
                problems.add(f"{mistake}; type {field.name}={tuple(values)!r}")
            else:
                self._take(field, problems)
            return
        if isinstance(values, (str, bytes, int, float)) or not hasattr(values, "__iter__") or getattr(values, "ndim", 1) == 0:
            typed = f"{field.name}={example_of(field.metadata, True)}"
            problems.add(f"{field.name} = {values!r}; allowed is a tuple of numbers; type for example {typed}")
            return
        taken = tuple(self._checked(field, f"{field.name}[{i}]", v, problems) for i, v in enumerate(values))
        object.__setattr__(self, field.name, taken)

    def _checked(self, field: dataclasses.Field[Any], name: str, value: Any, problems: Problems) -> Any:
        """A number, checked by its field's rule; violations are added to `problems`. A symbol is returned unchanged."""
        if type(value) is not float and is_symbol(value):
            return value
        return checked_number(name, value, problems, *_rule_of(type(self), field))  # type: ignore[arg-type]

    def _check(self, problems: Problems) -> None:
        """Checks that need more than one field; a subclass adds its own."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        mine, theirs = dict(leaves(self, kinds=True)), dict(leaves(other, kinds=True))
        return mine.keys() == theirs.keys() and all(same(mine[k], theirs[k]) for k in mine)

    def __hash__(self) -> int:
        return hash(tuple((name, _key(value)) for name, value in leaves(self, kinds=True)))

    def replace(self, changes: dict[str, Any] | None = None, /, **fields: Any) -> Any:
        """A copy with some fields changed; a dotted name reaches into a part: ``replace({"drive.amplitude": 1e-4})``.

        A name may stand for the numbers of several parts: ``"modules.drive.omega"`` for those of all modules, ``"*.omega"`` for every
        name with this ending.
        """
        problems = Problems(type(self).__name__)
        grouped = _spelled_out(self, {**(changes or {}), **fields}, problems)
        problems.check()
        parts = {}
        for head, sub in _by_head(grouped).items():
            parts[head] = _changed(getattr(self, head), sub.changes) if isinstance(sub, _Sub) else sub
        return dataclasses.replace(self, **parts)  # type: ignore[type-var]  # all at once: two fields may be valid only together


@functools.lru_cache(maxsize=256)
def _taken(cls: Any) -> tuple[tuple[dataclasses.Field[Any], str], ...]:
    """The fields of a record that hold numbers, each with the method that checks it."""
    holding = {"number": "_take", "numbers": "_take_tuple"}
    return tuple((f, holding[holds]) for f, (_, holds) in zip(dataclasses.fields(cls), _plan(cls), strict=True) if holds in holding)


@functools.lru_cache(maxsize=4096)
def _rule_of(cls: type, field: dataclasses.Field[Any]) -> tuple[Any, str, str, str | None]:
    """The rule for a number of a field: its test, description, example and unit."""
    kind = field_types(cls)[field.name]
    description, several = field.metadata, kind.holds == "numbers"
    allowed = allowed_in(description, kind.optional and not several)
    return description.get("rule"), allowed, f"{field.name}={example_of(description, several)}", description.get("unit")


def _changed(part: Any, changes: dict[str, Any]) -> Any:
    """A part with some of its fields changed; in a tuple of parts or numbers the changes are selected by position."""
    if isinstance(part, tuple):
        parts = list(part)
        for position, sub in _by_head(changes).items():
            parts[int(position)] = _changed(part[int(position)], sub.changes) if isinstance(sub, _Sub) else sub
        return tuple(parts)
    if hasattr(part, "replace"):
        return part.replace(changes)
    whole = {head: _changed(getattr(part, head), sub.changes) if isinstance(sub, _Sub) else sub for head, sub in _by_head(changes).items()}
    return dataclasses.replace(part, **whole)


def _spelled_out(record: Any, changes: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """The changes with every name expanded to single fields or numbers."""
    expanded: dict[str, Any] = {}
    for path, value in changes.items():
        meant: tuple[str, ...] = (path,)
        try:
            _look_up(record, path, value)
        except InputError as error:
            meant = numbers_meant(path, (name for name, _ in leaves(record)))
            if not meant:
                problems.include(error)
        for name in meant:
            if name in expanded:
                problems.add(f"{name} is given twice, once by {path!r}; leave one of the two out")
            expanded[name] = value
    return expanded


@dataclasses.dataclass
class _Sub:
    changes: dict[str, Any]


def _by_head(changes: dict[str, Any]) -> dict[str, Any]:
    grouped: dict[str, Any] = {}
    for path, value in changes.items():
        head, _, rest = path.partition(".")
        if rest:
            grouped.setdefault(head, _Sub({})).changes[rest] = value
        else:
            grouped[head] = value
    return grouped


def _look_up(record: Any, path: str, given: Any) -> Any:
    head, _, rest = path.partition(".")
    if isinstance(record, tuple):
        names = [str(i) for i in range(len(record))]
        value = dict(zip(names, record, strict=True)).get(head)
    else:
        names = [f.name for f in dataclasses.fields(record)] if dataclasses.is_dataclass(record) else []
        value = getattr(record, head, None)
    if head not in names:
        hint = _of_parts(record, path) or other_words(head, given, names) or did_you_mean(head, names)
        raise InputError(type(record).__name__, [f"{head!r} is not a field; {hint}"])
    return _look_up(value, rest, given) if rest else value


def _of_parts(record: Any, path: str) -> str:
    """A suggestion for a number of a part that is given without the part's name; empty if no part has it."""
    owners = [name for name, _ in leaves(record) if name.endswith(f".{path}")] if dataclasses.is_dataclass(record) else []
    typed = " or ".join(f'replace({{"{name}": ...}})' for name in owners[:3])
    return f"{owners[0].rpartition('.')[0]} has it; type {typed}" if owners else ""


def _descriptions_in(cls: Any) -> dict[str, Mapping[str, Any]]:
    return {field.name: field.metadata for field in dataclasses.fields(cls)} if dataclasses.is_dataclass(cls) else {}


def described_by(cls: Any, name: str) -> Mapping[str, Any]:
    """A class's description of one of its numbers."""
    return next(field.metadata for field in dataclasses.fields(cls) if field.name == name)


def example_in(cls: Any) -> Any:
    """A record with the examples of its fields; fields with neither example nor default are reported in an `InputError`.

    Examples
    --------
    >>> from stickslip.friction import Coulomb
    >>> example_in(Coulomb)
    Coulomb(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24)
    """
    if not hasattr(cls, "__dataclass_fields__"):
        raise InputError(cls.__name__, ["it is not a dataclass; write @dataclass(frozen=True) above the class"])
    given = {f.name: _typed(f.metadata["example"]) for f in dataclasses.fields(cls) if "example" in f.metadata}
    nothing = dataclasses.MISSING
    lacking = [f.name for f in dataclasses.fields(cls) if f.name not in given and f.default is nothing and f.default_factory is nothing]
    problems = Problems(cls.__name__)
    for name in lacking:
        problems.add(
            f'{name} has no example; type {name}: float = field(metadata=ss.quantities.quantity("what it is", "its unit", example=1.0))'
        )
    problems.check()
    return cls(**given)


def _typed(example: Any) -> Any:
    """An example, converted to a number if it is text."""
    return float(example) if isinstance(example, str) else example


def _key(value: Any) -> Any:
    """A hashable key of a field's value: equal for equal values."""
    if not is_array(value):
        return value
    import numpy as np

    array = np.asarray(value)
    return array.shape, (array + 0.0).tobytes() if array.dtype.kind in "fiu" else array.tobytes()


def same(a: Any, b: Any) -> bool:
    """Whether two values of a field are the same, arrays number by number."""
    if is_array(a) or is_array(b):
        import numpy as np

        return np.array_equal(np.asarray(a), np.asarray(b))
    return bool(a == b)


@functools.lru_cache(maxsize=256)
def _plan(cls: type) -> tuple[tuple[str, str], ...]:
    """Names of a record's fields, and what each holds: a number, numbers, or a kind."""
    return tuple((name, kind.holds) for name, kind in field_types(cls).items())


def is_record(value: Any) -> bool:
    """Whether a value is a dataclass with fields of its own."""
    return hasattr(value, "__dataclass_fields__") and not isinstance(value, type)


def is_frozen(record: Any) -> bool:
    """Whether a record and all its parts are immutable; numbers under names of their own are in a mapping, which is mutable."""
    cls: Any = type(record)
    if not _is_frozen_class(cls):
        return False
    for name, _ in _plan(cls):
        value = getattr(record, name)
        if type(value) is float:  # the usual case, without further checks
            continue
        if is_record(value):
            if not is_frozen(value):
                return False
        elif _are_records(value) and not all(map(is_frozen, value)):
            return False
    return True


@functools.lru_cache(maxsize=256)
def _is_frozen_class(cls: Any) -> bool:
    """Whether the fields of a class's records stay as they are, and none of them is a mapping."""
    return cls.__dataclass_params__.frozen and all(holds != "named" for _, holds in _plan(cls))


def _are_records(value: Any) -> bool:
    """Whether a value is several parts of one machine."""
    return isinstance(value, tuple) and bool(value) and all(map(is_record, value))


def leaves(record: Any, prefix: str = "", kinds: bool = False, number_as: Callable[[str, Any], Any] | None = None) -> list[tuple[str, Any]]:
    """Every number of a record and of its parts, as (dotted name, value); with `kinds` also the fields that are not numbers.

    A field of ``None`` is not a number. The order is the order of the fields, so it is the same for every record of a kind. With
    `number_as` each number is what this function makes of its name and its value.
    """
    numbers: list[tuple[str, Any]] = [(prefix + "__class__", type(record))] if kinds else []
    for name, full, holds in _named_plan(type(record), prefix):  # type: ignore[arg-type]
        value = getattr(record, name)
        if type(value) is float and holds == "number":  # the usual case, without further checks
            numbers.append((full, value if number_as is None else number_as(full, value)))
        elif is_record(value):
            numbers += leaves(value, f"{full}.", kinds, number_as)
        elif _are_records(value):
            for i, part in enumerate(value):
                numbers += leaves(part, f"{full}.{i}.", kinds, number_as)
        elif holds != "kind" and value is not None:
            own = _several(full, prefix, holds, value)
            numbers += own if number_as is None else [(each, number_as(each, v)) for each, v in own]
        elif kinds:
            numbers.append((full, value))
    return numbers


def _several(full: str, prefix: str, holds: str, value: Any) -> list[tuple[str, Any]]:
    """The numbers of a field by name: one, a tuple of them, or a mapping of those with names of their own."""
    if holds == "named":
        return [(prefix + own, v) for own, v in value.items()]
    if holds == "numbers" and isinstance(value, tuple):
        return [(f"{full}.{i}", v) for i, v in enumerate(value)]
    return [(full, value)]


def _holds_symbols(record: Any) -> bool:
    """Whether one of the numbers of a record or of its parts is a symbol."""
    for name, holds in _plan(type(record)):  # type: ignore[arg-type]
        value = getattr(record, name)
        if type(value) is float or value is None:
            continue
        if is_record(value):
            if _holds_symbols(value):
                return True
        elif _are_records(value):
            if any(map(_holds_symbols, value)):
                return True
        elif holds == "named":
            if any(map(is_symbol, value.values())):
                return True
        elif holds != "kind" and (any(map(is_symbol, value)) if isinstance(value, tuple) else is_symbol(value)):
            return True
    return False


@functools.lru_cache(maxsize=1024)
def _named_plan(cls: type, prefix: str) -> tuple[tuple[str, str, str], ...]:
    """The plan of a record that is a part: name of each field, the same with its prefix, and what the field holds."""
    return tuple((name, prefix + name, holds) for name, holds in _plan(cls))


def field_description(record: Any, name: str) -> Mapping[str, Any]:
    """The metadata of the field that a dotted name stands for; empty if there is no such field.

    What a number measures may depend on the record around it, whose `measured_inside` then says so: field -> what `holding` gives.

    Examples
    --------
    >>> import stickslip as ss
    >>> field_description(ss.Chain.example(), "link.stiffness")["label"]
    'stiffness of the spring'
    >>> joint = ss.Joint(0.01, ss.Coulomb(0.1), control=ss.machines.PID(kp=2.0, ki=0.0, kd=0.0, target=0.0))
    >>> [field_description(each, "control.kp")["unit"] for each in (joint, joint.replace(motor=ss.machines.Motor(k_t=0.5, resistance=2.0)))]
    ['N m/rad', 'V/rad']
    """
    description: Mapping[str, Any] = {}
    outer: Mapping[str, Any] = {}
    for step in name.split("."):
        if step.isdigit():
            record = record[int(step)] if isinstance(record, tuple) else record
            continue
        own = {f.name: f.metadata for f in dataclasses.fields(record)} if dataclasses.is_dataclass(record) else {}
        here = getattr(record, "measured_inside", {}).get(step)
        description, record = own.get(step, {}), getattr(record, step, None)
        outer = here or (description if "words" in description else outer)
    return description_inside(description, outer)


def replace_leaf(record: Any, values: dict[str, Any], prefix: str = "") -> Any:
    """A copy, made without any check, in which the named numbers are replaced (by symbols in the engine)."""
    copy = object.__new__(type(record))
    for name, value in _extra_attributes(record).items():
        object.__setattr__(copy, name, value)
    for field, holds in _plan(type(record)):  # type: ignore[arg-type]
        value, name = getattr(record, field), prefix + field
        if holds == "named":
            value = {own: values.get(prefix + own, v) for own, v in value.items()}
        elif is_record(value):
            value = replace_leaf(value, values, name + ".")
        elif _are_records(value):
            value = tuple(replace_leaf(part, values, f"{name}.{i}.") for i, part in enumerate(value))
        elif isinstance(value, tuple):
            value = tuple(values.get(f"{name}.{i}", v) for i, v in enumerate(value))
        object.__setattr__(copy, field, values.get(name, value))
    return copy


def _extra_attributes(record: Any) -> dict[str, Any]:
    """Attributes that are not fields; refused in a record with numbers, where they would be outdated once the numbers are replaced."""
    cls: Any = type(record)
    plan = _plan(cls)
    names = {name for name, _ in plan}
    extras = {n: v for n, v in getattr(record, "__dict__", {}).items() if n not in names and not _is_cached(cls, n)}
    lost = [*extras, *_derived(cls)]
    if lost and any(holds != "kind" for _, holds in plan):
        mistake = f"sets {', '.join(lost)} when it is made, which would stay as it is when its numbers are replaced"
        what = "compute it in the method that needs it, or make it an argument: a field with float"
        raise InputError(cls.__name__, [f"{mistake}; {what}"])
    return extras


def _is_cached(cls: type, name: str) -> bool:
    return isinstance(getattr(cls, name, None), functools.cached_property)


@functools.lru_cache(maxsize=256)
def _derived(cls: Any) -> tuple[str, ...]:
    """Fields that are neither arguments of a class nor numbers that could be replaced with the others."""
    kinds = {name for name, holds in _plan(cls) if holds == "kind"}
    return tuple(f.name for f in dataclasses.fields(cls) if not f.init and f.name in kinds)
