"""What files are taken for before anything is fitted: channels, the kind of machine, its numbers, and what has to be typed first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.phrases import counted
from stickslip.basics.typed_numbers import in_unit
from stickslip.inverse.logs.joints import JointChoice, of_first_joint
from stickslip.inverse.logs.kinds import kind_named, kinds_but_for_times, kinds_for
from stickslip.inverse.logs.machines import Kind
from stickslip.inverse.logs.proposals import Proposal, missing_units, of_channels, table
from stickslip.records.candidates import candidate_unit, typed_units, without_unit

if TYPE_CHECKING:
    from stickslip.records import Record

_WANTED = (
    "a force over a position or velocity, a torque or a current over an angle, a command beside an angle, a velocity over time, "
    "or a table of forces over speeds or of mean speeds over amplitude and frequency"
)


@dataclass(frozen=True)
class Plan:
    """What `fit` is about to do with some records.

    Parameters
    ----------
    records : tuple of Record
    channels : tuple of Proposal
        What each channel is taken for.
    given : dict
        Numbers of the machine that were typed.
    kind : Kind or None
        The kind of machine; None where no kind suits the channels.
    why : str
        What of the records speaks for it.
    able : dict of str -> Kind
        All kinds that the channels suit.
    problem : str
        What has to be typed before anything can be fitted; empty where nothing is missing.
    joint : JointChoice
        The joint that is proposed of several.
    """

    records: tuple[Record, ...]
    channels: tuple[Proposal, ...]
    given: dict[str, Any]
    kind: Kind | None
    why: str
    able: dict[str, Kind]
    problem: str
    joint: JointChoice = field(default_factory=JointChoice)

    @property
    def rivals(self) -> list[Kind]:
        """Other kinds that the same laws may be compared with, where nobody typed one."""
        if self.kind is None or self.why == "typed":
            return []
        return [other for other in self.able.values() if other is not self.kind and set(self.kind.laws) <= set(other.laws)]

    @property
    def assumed(self) -> dict[str, tuple[str, str]]:
        """Numbers that nobody gave: name -> (value in words, why)."""
        return {} if self.kind is None else self.kind.assumed(self.records, self.given)

    def checked(self) -> Kind:
        """The kind of machine; `InputError` with the table of channels where something has to be typed first."""
        if self.problem or self.kind is None:
            raise InputError("fit", [f"{self.problem}\n{table(self.channels)}"])
        return self.kind


def plan_of(records: Sequence[Record], units: dict[str, str], roles: dict[str, str], machine: str | None, given: dict[str, Any]) -> Plan:
    """What is to be done with some records, of which units and roles were typed.

    Examples
    --------
    >>> from stickslip.records import read
    >>> rec = read({"time_s": [0.0, 0.1, 0.2], "pos_mm": [0.0, 1.0, 0.0], "F_N": [1.0, 2.0, -1.0]})
    >>> plan = plan_of([rec], {}, {}, None, {})
    >>> plan.kind.name, plan.why, plan.problem
    ('rig', 'a force beside a position', '')
    >>> plan_of([read({"time_s": [0.0, 0.1], "v_mm_s": [1.0, 2.0]})], {}, {}, None, {}).problem[:34]
    'amplitude and tilt_deg are missing'
    >>> plan_of([read({"pos_mm": [0.0, 1.0], "F_N": [1.0, 2.0]})], {}, {}, None, {}).problem
    'the file has no times, and looks like a friction rig, whose motion needs them; type rate=1000.0 with the samples per second'
    """
    records, joint = of_first_joint(records, roles)
    channels = tuple(dict.fromkeys(line for rec in records for line in of_channels(rec, units, roles, joint)))
    try:
        possible, doubt = kinds_for(records), ""
    except InputError as error:  # several channels for one role
        possible, doubt = {}, error.problems[0]
    able = {name: kind for name, (kind, _) in possible.items()}
    kind, why = next(iter(possible.values()), (None, ""))
    problem = doubt or _bare(records, bool(able))
    if machine is not None:
        named = kind_named(machine)
        if named.name in able:
            kind, why = named, "typed"
        else:
            suits = f"it suits {', '.join(able)}" if able else "it suits none"
            problem = problem or f"machine = {machine!r} needs other channels than these: {suits}"
    if kind is None:
        problem = problem or _unsuited(records)
    elif not problem:
        given = _checked_numbers(kind, given, len(records))
        problem = kind.lacks(records, given)
    return Plan(tuple(records), channels, given, kind, why, able, problem, joint)


def _unsuited(records: Sequence[Record]) -> str:
    """Why no machine suits some records, and what to type."""
    if timed := kinds_but_for_times(records):
        what = timed[0].words.partition(":")[0]
        return f"the file has no times, and looks like {what}, whose motion needs them; type rate=1000.0 with the samples per second"
    return f'no machine suits the file: it needs {_WANTED}; type roles={{"...": "force"}} where a channel is one'


def _bare(records: Sequence[Record], suits: bool) -> str:
    """One line to paste, where units are missing."""
    if not any(missing_units(rec) for rec in records) and suits:
        return ""
    bare = {name: values for rec in records for name, values in without_unit(rec.channels.values()).items()}
    bare = {name: values for name, values in bare.items() if candidate_unit(name, values) != "1"}
    return f"units are missing; type {typed_units(bare)} with the right ones" if bare else ""


def _checked_numbers(kind: Kind, typed: dict[str, Any], files: int) -> dict[str, Any]:
    """Numbers as they were typed, those with a unit in the one of the machine; `InputError` with all that is wrong with them."""
    problems = Problems("fit")
    given = dict(typed)
    for name, value in typed.items():
        many = isinstance(value, (list, tuple))
        try:
            given[name] = value = in_unit(value, _unit_of(kind.takes.get(name, "")))
        except ValueError as error:
            problems.add(f"{name}: {error}; type for example {name}=1.0")
            continue
        if name not in kind.takes:
            able = ", ".join(f"{known} ({words})" for known, words in kind.takes.items())
            problems.add(f"numbers names {name!r}; {did_you_mean(name, kind.takes)}; a {kind.name} takes {able}")
        elif many and name not in kind.by_file:
            problems.add(f"{name} = {value!r} is several numbers; of a {kind.name} it is one for all files; type for example {name}=1.0")
        elif many and len(value) != files:
            problems.add(
                f"{name} has {counted(len(value), 'number')} and there {'is' if files == 1 else 'are'} {counted(files, 'file')}; "
                f"type one for each file, or one for all"
            )
        elif not all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in (value if many else [value])):
            problems.add(f"{name} = {value!r} is not a number; type for example {name}=1.0")
    problems.check()
    return given


def _unit_of(words: str) -> str:
    """The unit in the words of a number: what stands in brackets."""
    return words.rpartition("[")[2].partition("]")[0] if "[" in words else "1"
