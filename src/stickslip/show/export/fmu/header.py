"""``machine.h`` of an FMU: the machine in C, its numbers, and the tables by which ``state.c`` and ``fmu.c`` find their way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from stickslip.basics.status import Status
from stickslip.engine.lines import literal
from stickslip.solvers.machine_in_c import MachineInC

#: How a run may end before its time, and whether that is an end as the machine has it, and no error.
_ENDS = {
    Status.BUDGET: False, Status.TOO_SMALL: False, Status.NOT_A_NUMBER: False, Status.LOST: True, Status.CHATTERS: False,
    Status.UNBRAKED: False, Status.SWITCHES: False, Status.PAINLEVE: True,
}  # fmt: skip


def header(made: MachineInC, token: str, version: str) -> str:
    """The text of the file."""
    values = len(made.states) * 2 + len(made.outputs) + made.indicators
    settings = {
        **made.settings, "N_STATES": len(made.states), "N_VALUES": values, "FIRST_VALUE": 1 + len(made.numbers),
        "SPAN_PLACE": max(made.settings["SPAN_AT"], 0),
    }  # fmt: skip
    ends = ", ".join(f'{{{int(status)}, {str(ended).lower()}, "{status.sentence}"}}' for status, ended in _ENDS.items())
    numbers = made.numbers
    tables = [
        _row("double", "NUMBERS_AT_START", [number.value for number in numbers]),
        _row("int", "KINDS", [number.role for number in numbers]),
        _row("double", "STATES_AT_START", made.begin),
        _row("double", "MEMORIES_AT_START", made.memories),
        f"static const double SPAN_AT_START = {literal(made.span)};",
        *(_row("int", name, made.tables[name]) for name in ("SIDE_PLACES", "FLIGHT_PLACES", "FLIGHT_STATES", "MEMORY_OF")),
        *(_rows(name, made.tables[name]) for name in ("SLIP_ROWS", "STOP_ROWS")),
        f"static const struct {{ int status; bool is_end; const char *words; }} STATUS_WORDS[] = {{{ends}}};",
    ]
    return "\n".join(
        [
            f"/* Written by stickslip {version}: a machine that steps by itself. Do not edit it; export the machine again. */",
            "#define ROOM(count) ((count) > 0 ? (count) : 1)",
            f'#define TOKEN "{token}"',
            *(f"#define {name} {literal(value) if isinstance(value, float) else f'({value})'}" for name, value in settings.items()),
            "",
            made.text,
            *tables,
            "",
        ]
    )


def _row(kind: str, name: str, values: Sequence[Any]) -> str:
    text = ", ".join(literal(value) if kind == "double" else str(value) for value in values)
    return f"static const {kind} {name}[{max(len(values), 1)}] = {{{text or '0'}}};"


def _rows(name: str, rows: Sequence[Sequence[float]]) -> str:
    text = ", ".join(f"{{{', '.join(literal(float(value)) for value in row)}}}" for row in rows)
    return f"static const double {name}[{max(len(rows), 1)}][COORDINATES] = {{{text or '{0.0}'}}};"
