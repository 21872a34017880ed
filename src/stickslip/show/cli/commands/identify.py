"""``stickslip identify``: parameters of a robot or a law from measured records."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems, as_path, did_you_mean
from stickslip.basics.progress import ProgressLine
from stickslip.show.cli import recorded
from stickslip.show.cli.arguments import range_ends, settings
from stickslip.show.cli.declaring import CODE, EXECUTOR, RECORDS, SENSOR, argument, command
from stickslip.show.cli.executors import executor_asked
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


_OPTIONS = ("tied", "using", "noise", "starts", "seed", "load", "frequency", "settle", "transient", "sensor", "harmonics")


@command(
    about="Fit parameters of a robot, or of a friction law, to measured records, with intervals and a check of the residuals.",
    more="""\
example: stickslip identify piezo_rig tilt_deg=1.7 amplitude=5e-4,8e-4 --record a.csv --record b.csv
           --free mu0=0.05..0.5 --free v_s=2e-4..2e-2:log

A study file says the same in TOML:
  [identify]
  make = "piezo_rig"
  records = ["a.csv", "b.csv"]      # or: means = [0.0017, 0.0036]
  [identify.arguments]
  tilt_deg = 1.7
  amplitude = [5e-4, 8e-4]
  [identify.free]
  mu0 = [0.05, 0.5]
  v_s = [2e-4, 2e-2, "log"]
  [identify.sensor]                 # left out: offset, drift, gain, delay are fitted; empty: an ideal sensor
  offset = 0.0
  gain = ["normal", 1.0, 0.02]
and `stickslip identify study.toml` does it.""",
    arguments=(
        argument(
            "robot",
            metavar="ROBOT",
            help="name of a preset, of a law (see `stickslip laws`; its force is fitted over the record's motion), or path of a TOML study file",
        ),
        argument(
            "settings", metavar="NAME=VALUE", nargs="*", default=[], help="numbers of the robot, and arguments of the solver (optional)"
        ),
        *CODE,
        argument("--record", action="append", metavar="FILE", default=[], help="a measured record (may be repeated)"),
        argument("--mean", metavar="V,V", help="mean velocities instead of records [m/s]"),
        argument(
            "--free",
            action="append",
            metavar="NAME=A..B",
            default=[],
            help="a free parameter and its bounds; append :log to search its logarithm",
        ),
        argument("--noise", type=float, help="standard deviation of one value [SI]"),
        argument("--transient", action="store_true", help="fit the transients of the records too, simulated from their first samples"),
        SENSOR,
        argument(
            "--harmonics",
            type=float,
            metavar="SD",
            help="how well harmonics of the drive are known, in parts of its amplitude (default 0.02; 0: a pure sine)",
        ),
        argument("--level", type=float, default=0.95, help="level of the intervals (default 0.95)"),
        argument("--profile", action="store_true", help="intervals from profile likelihoods"),
        *RECORDS,
        *EXECUTOR,
        argument("--report", metavar="FILE", ends=(".html",), help="write an offline HTML page (.html)"),
    ),
    example="""\
$ stickslip identify piezo_rig tilt_deg=1.7 amplitude=5e-4,8e-4 law=coulomb --mean 0.00161,0.00431 --free mu0=0.05..0.5
Coulomb fitted to 2 records, 2 values; 1 parameter free
  mu0 = 0.1808 ± 0.0016   95 % 0.1602 to 0.2013
  as given: tilt_deg = 1.7 degrees, amplitude = 0.0005 m and 0.0008 m, law = coulomb
  record 0, mean: rms 6.24e-05 m/s, neighbours correlated 0.00
  record 1, mean: rms 3.02e-05 m/s, neighbours correlated 0.00
  search: 64 starting points, 3 of the refined ones ended here
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    if not 0 < asked.level < 1:
        raise InputError("--level", [f"{asked.level:g}; allowed is above 0 and below 1; type for example --level 0.95"])
    job = _study(asked) if _is_study(asked.robot) else _typed(asked)
    make = _maker(job["make"])

    from stickslip.inverse.identification import identify

    with recorded.in_words_of_the_shell():
        records = [recorded.opened_record(path, asked) for path in job["records"]] or job["means"]
        how = {**job["options"], **executor_asked(asked.executor)}
        fit = identify(records, make, free=job["free"], progress=ProgressLine("starts"), **how, **job["arguments"])
    method = "profile" if asked.profile else "auto"
    intervals = {name: fit.interval(name, asked.level, method) for name in fit.values}
    if asked.report is not None:
        fit.report(asked.report)
    return Outcome(lambda: numbers_of(fit, intervals, asked.level, method), lambda: _text(fit, intervals, asked))


def _text(fit: Any, intervals: dict[str, Any], asked: Namespace) -> str:
    """The report, with the requested intervals."""
    from stickslip.inverse.identification.fit_text import NOT_DETERMINED

    lines, how = [recorded.in_command_words(fit.report())], " (profile)" if asked.profile else ""
    if asked.profile or asked.level != 0.95:
        for name, (low, high) in intervals.items():
            ends = NOT_DETERMINED if name in fit.undetermined else f"{100 * asked.level:g} % {low:.6g} to {high:.6g}{how}"
            lines.append(f"  {name}: {ends}")
    return "\n".join([*lines, *([] if asked.report is None else [f"written to {asked.report}"])])


def numbers_of(fit: Any, intervals: dict[str, Any], level: float, method: str) -> dict[str, Any]:
    """A fit as JSON."""
    from dataclasses import asdict

    from stickslip.inverse.identification.fit_text import NOT_DETERMINED

    lost = dict.fromkeys(fit.undetermined, NOT_DETERMINED)
    errors = {name: error if isfinite(error) else NOT_DETERMINED for name, error in fit.errors.items()}
    sensor = {name: [value, error if isfinite(error) else NOT_DETERMINED] for name, (value, error) in fit.sensor.items()}
    drive = {name: list(pair) for name, pair in fit.drive.items()}
    return {
        "law": fit.law, "values": fit.values, "errors": errors | lost, "intervals": intervals | lost, "level": level, "method": method,
        "sensor": sensor, "drive": drive, "combinations": [list(each) for each in fit.combinations],
        "correlations": fit.correlations.tolist(), "quality": [asdict(q) for q in fit.quality],
        "warnings": fit.warnings, "provenance": fit.provenance,
    }  # fmt: skip


def _maker(name: str) -> Any:
    """The preset, law or study robot of this name."""
    from stickslip.models.friction import LAWS
    from stickslip.models.presets import PRESETS

    if name in PRESETS:
        return PRESETS[name]
    if name.lower() in LAWS:
        return LAWS[name.lower()]
    path = as_path(name, "identify")
    if path.suffix.lower() == ".toml" and path.is_file():
        from stickslip.models.robot import Robot

        return Robot.from_toml(path.read_text(encoding="utf-8"))
    raise InputError("identify", [f"{name!r} is neither a preset nor a law nor a study file; {did_you_mean(name, [*PRESETS, *LAWS])}"])


def _is_study(name: str) -> bool:
    path = as_path(name, "identify")
    return path.suffix.lower() == ".toml" and path.is_file() and "[identify" in path.read_text(encoding="utf-8", errors="replace")


def _typed(asked: Namespace) -> dict[str, Any]:
    """The task, from the command line."""
    problems = Problems("identify")
    arguments = settings(asked.settings, True, problems)
    free = {}
    for word in asked.free:
        name, _, bounds = word.partition("=")
        text, _, log = bounds.partition(":")
        try:
            free[name] = (*range_ends(text), "log") if log == "log" else range_ends(text)
        except ValueError:
            problems.add(f"--free {word!r} is not NAME=A..B; type for example --free mu0=0.05..0.5")
    sensor = sensor_typed(asked.sensor, problems)
    means = _floats(asked.mean, problems)
    if bool(asked.record) == bool(means):
        problems.add("give records or mean velocities: --record run.csv (again for more), or --mean 0.0017,0.0036")
    problems.check()
    options: dict[str, Any] = {} if asked.noise is None else {"noise": asked.noise}
    options |= {"settle": recorded.settle(asked), "transient": asked.transient, "sensor": sensor}
    options |= {} if asked.harmonics is None else {"harmonics": asked.harmonics}
    return {"make": asked.robot, "records": asked.record, "means": means, "arguments": arguments, "free": free, "options": options}


def sensor_typed(words: list[str], problems: Problems) -> dict[str, Any] | None:
    """The parameters of the sensor; None if none were typed."""
    if not words:
        return None
    parameters: dict[str, Any] = {}
    for word in (word for word in words if word != "ideal"):
        name, _, text = word.partition("=")
        parts = text.split(":")
        try:
            parameters[name] = None if text == "fit" else float(text) if len(parts) == 1 else (parts[0], *map(float, parts[1:]))
        except ValueError:
            problems.add(f"--sensor {word!r} is not NAME=VALUE; type for example --sensor offset=0 --sensor gain=normal:1:0.02")
    return parameters


def _floats(text: str | None, problems: Problems) -> list[float]:
    try:
        return [float(part) for part in (text or "").split(",") if part.strip()]
    except ValueError:
        problems.add(f"--mean {text!r} is not a list of numbers; type for example --mean 0.0017,0.0036")
        return []


#: Types of the tables and lists of [identify] in a study file, with examples.
_SHAPES: dict[str, tuple[type, str]] = {
    "free": (dict, "mu0 = [0.05, 0.5] under [identify.free]"), "tied": (dict, 'mu_minus = "mu_plus" under [identify.tied]'),
    "units": (dict, 'Velocity = "mm/s" under [identify.units]'), "roles": (dict, 'Velocity = "velocity" under [identify.roles]'),
    "sensor": (dict, 'gain = ["normal", 1.0, 0.02] under [identify.sensor]'),
    "arguments": (dict, "tilt_deg = 1.7 under [identify.arguments]"), "records": (list, 'records = ["run.csv"]'),
    "means": (list, "means = [0.0017, 0.0036]"), "columns": (list, 'columns = ["time", "velocity"]'), "make": (str, 'make = "piezo_rig"'),
}  # fmt: skip


_KEYS = tuple(dict.fromkeys((*_SHAPES, *_OPTIONS)))


def _study(asked: Namespace) -> dict[str, Any]:
    """The task, from a study file; paths are relative to its folder."""
    path = as_path(asked.robot, "identify")
    table = _table(path)
    asked.unit += [f"{k}={v}" for k, v in table.get("units", {}).items()]
    asked.role += [f"{k}={v}" for k, v in table.get("roles", {}).items()]
    asked.columns = asked.columns or (",".join(table["columns"]) if "columns" in table else None)
    options = {k: table[k] for k in _OPTIONS if k in table}
    return {
        "make": table.get("make", str(path)),
        "records": [str(path.parent / name) for name in table.get("records", [])],
        "means": table.get("means", []),
        "arguments": table.get("arguments", {}),
        "free": table["free"],
        "options": options,
    }


def _table(path: Path) -> dict[str, Any]:
    """The table [identify] of a study file, with the types of its values checked."""
    from stickslip.models.tables import document_of

    what = f"study file {str(path)!r}"
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InputError(what, [f"not readable as TOML: {error}"]) from None
    problems, table = Problems(what), document_of(text, what).get("identify", {})
    if not isinstance(table, dict):
        raise InputError(what, [f'identify = {table!r}; allowed is a table; type [identify] and then for example make = "piezo_rig"'])
    for key, value in table.items():
        if key not in _KEYS:
            problems.add(f"identify.{key} is not known; {did_you_mean(key, _KEYS)}")
        elif key in _SHAPES and not isinstance(value, _SHAPES[key][0]):
            problems.add(f"identify.{key} = {value!r}; type for example {_SHAPES[key][1]}")
        elif key in ("records", "columns") and not all(isinstance(name, str) for name in value):
            problems.add(f"identify.{key} = {value!r}; allowed are texts; type for example {_SHAPES[key][1]}")
    if not table.get("free"):
        problems.add("has no [identify.free] table; type for example mu0 = [0.05, 0.5] in it")
    if bool(table.get("records")) == bool(table.get("means")):
        problems.add("needs records = [paths] or means = [numbers], one of them")
    problems.check()
    return table
