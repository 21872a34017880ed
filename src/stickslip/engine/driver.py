"""The driver of all lane kernels: it assigns cases to lanes, steps them and observes them; compiled once, for every law.

A law's own kernel (`lanes.py`) holds only what depends on the law: the numbers of a case, its flags, its step. The driver
calls these functions at their addresses. It finds its way by the kernel's table: how many states and flags there are,
where each field of a lane stands, and the addresses. So a new law costs the compilation of its step alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import Any

from stickslip.engine import cache
from stickslip.engine.kernel_text import FUNCTIONS, LOOKS, KernelSource, kernel_text
from stickslip.engine.machine_code import Compiled
from stickslip.engine.shared_arrays import SHARED
from stickslip.engine.taylor import ORDER
from stickslip.engine.texts import recurrence_text, status_text
from stickslip.engine.unforeseen import MISFIT, POINTS, ROUNDING_OF_SLOPES

#: What few kernels need of the driver, compiled where one does: its functions, its texts, and what a person is told.
_APART = {
    "parts": (
        ("begin_parts", "begin_signals", "hold", "reduce_step", "widen", "widen_all", "note_parts"),
        ("columns", "turning", "noting_segments", "reducing"),
        "what machines of several parts share",
    ),
    "changes": (("rates_now", "settle_changes", "note_late", "shift_changes"), ("columns", "flags", "changes"), "what all tangents share"),
}
_LOOKS = tuple(f"{name} = {i}" for i, name in enumerate(LOOKS))

#: The first entries of a table: numbers of things, places of a case's constants, places of a lane's fields (-1: there is none).
_COLUMNS = (
    "LANES", "STATES", "GUARDS", "SIGNS", "FIELDS", "CONSTANTS", "DEGREE", "MODES", "KEPT_MODES", "CLOCKS", "IMPULSES", "BREAKS", "FLAGS",
    "SET_VALUED", "SERIES", "OFFERED", "CYCLIC", "PERIOD", "FREE", "BREAK_AT", "F_C", "F_Y", "F_SIGN", "F_B", "F_ON", "F_M", "F_K",
    "F_MODE", "F_CLK", "F_G", "F_HELD", "F_T", "F_H", "F_TEND", "F_X", "F_LE", "F_LH", "F_GROW", "F_STAT", "F_NACC", "F_NREJ", "F_RATIO",
    "F_T0", "F_HH", "F_X0", "F_SIDE", "F_LAST", "F_TOP", "WATCHED", "EXPONENTS", "F_CLEAR", "COORDINATES", "CONTACTS", "SHARES",
    "SHARE_AT", "PASSIVE", "CARRIED", "DELAY_AT", "ORDERED", "SIGNALS", "RATIOS", "BODIES", "ARMS", "PLACES", "F_FIRED", "LOOKED",
    "F_LOOKED", "SAMPLE_AT", "F_SOON", "F_MARKS", "F_LIM", "F_SORT", "F_TAIL", "F_HIGH", "F_LOW", "LASTING",
    "F_ENDS", "F_MEAN", "F_RATES", "F_FITS", "F_WORK",
)  # fmt: skip

#: Of these the places of a lane's fields.
FIELDS = tuple(name for name in _COLUMNS if name.startswith("F_"))

#: Lists at the end of a table, of what is noted of several bodies and contacts: of each contact the place of its side, or mode, among
#: what a step holds; of each signal its kind, and the state that it is (-1: none); of each body its coordinate, and the signal that is its
#: velocity; the states that signals are made of. The table says where each begins.
_LISTS = ("SIDES", "KINDS", "STATE_OF", "BODY_MOVES", "BODY_SIGNAL", "LOOKED_AT")


def table(kernel: Compiled, layout: dict[str, int], scale_at: tuple[int, ...], lists: tuple[tuple[int, ...], ...]) -> Any:
    """The whole numbers by which the driver finds its way in a law's kernel: layout, addresses, places of lists, scales, lists."""
    units = [kernel, *([_landing(layout["LANES"], layout["DEGREE"])] if layout["SERIES"] else ())]
    units += [_apart(name) for name, needed in (("parts", layout["SIGNALS"]), ("changes", layout["CARRIED"])) if needed]
    where = dict.fromkeys(FUNCTIONS, 0) | {name: at for unit in units for name, at in unit.addresses.items()}
    return table_of(where, layout, scale_at, lists)


def table_of(where: dict[str, int], layout: dict[str, int], scale_at: tuple[int, ...], lists: tuple[tuple[int, ...], ...]) -> Any:
    """The table of a kernel whose functions are at these addresses; 0 is that of none."""
    import numpy as np

    head = [*(layout[name] for name in _COLUMNS), *where.values()]
    first = len(head) + len(_LISTS) + len(scale_at)
    begins = [first + sum(map(len, lists[:k])) for k in range(len(_LISTS))]
    return np.array([*head, *begins, *scale_at, *(number for numbers in lists for number in numbers)], dtype=np.int64)


def gauss(count: int) -> tuple[list[float], list[float]]:
    """Nodes in [0, 1] and weights of Gauss's rule."""
    import numpy as np

    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (0.5 * (nodes + 1)).tolist(), (0.5 * weights).tolist()


def column(name: str) -> int:
    """Where an entry of a table stands."""
    return _COLUMNS.index(name)


#: What follows the driver's own texts where it does more: for more cases than lanes, and for a case that is held between calls.
_BEHIND = {"advance": (), "advance_pooled": ("pooling",), "advance_to": ("advancing",), "follow": ("advancing", "following")}
_TAKES = {"follow": "int64(f1, int64, i1, f2, i1, f2)"}  # what takes otherwise than the others


@lru_cache
def load(name: str = "advance") -> Any:
    """The compiled driver, `advance`; for more cases than lanes `advance_pooled`; for a held one `advance_to`, or leg by leg `follow`."""
    texts = ("columns", "flags", "polynomials", "turning", "noting_segments", "watching", "driving_lanes", *_BEHIND[name])
    constants = [*_shared_constants(), "STRIDE = 1"]
    made = source({name: _TAKES.get(name, "int64(f1, int64, int64, i1)")}, constants, texts, short_loops=True)
    return cache.load(made, f"driver_{name}", "what all kernels share")[name]


def _shared_constants() -> list[str]:
    return [*_LOOKS, status_text(), recurrence_text()]


def plain_texts(order: int) -> dict[str, str]:
    """The Python text of the driver of one held case of which nothing is noted, and of where its Taylor steps end."""
    texts = map(kernel_text, ("columns", "flags", "driving_lanes", "advancing", "alone"))
    return {
        "driver": "\n".join([*_places(), *_shared_constants(), *texts]),
        "landing": "\n".join([*_places(), _of_landing(1, order), *map(kernel_text, ("polynomials", "arcs"))]),
    }


@lru_cache
def _apart(name: str) -> Any:
    """The compiled functions that few kernels need."""
    functions, texts, label = _APART[name]
    rules = zip(("FEW_NODES", "FEW_WEIGHTS", "MANY_NODES", "MANY_WEIGHTS"), (*gauss(4), *gauss(6)), strict=True)
    constants = [*_LOOKS, *(f"{name} = {part!r}" for name, part in rules)]
    return cache.load(source(_kinds(functions), constants, texts), name, label)


@lru_cache
def _landing(lanes: int, order: int) -> Any:
    """Where Taylor steps of an order end; compiled for a number of lanes, because it is most of their work."""
    label = f"what all Taylor kernels share ({'one case' if lanes == 1 else 'many cases'})"
    name = f"arcs_{lanes}" if order == ORDER else f"arcs_{lanes}_{order}"
    return cache.load(source(_kinds(["land"]), [_of_landing(lanes, order)], ("polynomials", "arcs")), name, label)


def _of_landing(lanes: int, order: int) -> str:
    numbers = (order, lanes, lanes, POINTS, MISFIT, ROUNDING_OF_SLOPES)
    return f"ORDER, L, STRIDE, POINTS, MISFIT, ROUNDING_OF_SLOPES = {', '.join(map(repr, numbers))}"


def _kinds(names: Iterable[str]) -> dict[str, str]:
    """Functions that the driver calls at their addresses, with their types."""
    return {name: FUNCTIONS[name] for name in names}


def source(entries: dict[str, str], constants: list[str], texts: tuple[str, ...], short_loops: bool = False) -> KernelSource:
    """The source of some functions of the texts."""
    text = "\n".join([*_places(), *constants, *map(kernel_text, texts)])
    return KernelSource(text, entries, calls=FUNCTIONS, shared=SHARED, short_loops=short_loops)


def _places() -> list[str]:
    """Where the entries of a table stand, by name."""
    names = [*_COLUMNS, *(f"AT_{name.upper()}" for name in FUNCTIONS), *_LISTS, "SCALE_AT"]
    return [f"{name} = {i}" for i, name in enumerate(names)]
