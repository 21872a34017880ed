"""Interruption of long calls: Ctrl-C, or a progress function that returns False, ends them where their numbers are complete.

A long call is a function decorated with `interruptible`. While one runs in the main thread, Ctrl-C raises nothing: it sets the call's
`StopRequest`, and `look`, which every loop asks between two pieces of work, raises `Interrupted`. So neither an import, nor the
compiler, nor a file is ever left half done. A block under `partial_result` ends there and goes on with what is finished; only the
outermost call has a partial result, since an inner one would be taken for a complete one by its caller. A second Ctrl-C before the call
has ended raises KeyboardInterrupt at once, and so do three at once, which end a loop of short calls.
"""

from __future__ import annotations

import contextlib
import contextvars
import functools
import math
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, ParamSpec, TypeVar

from stickslip.basics.errors import StickslipError

P = ParamSpec("P")
T = TypeVar("T")

try:  # what `signal` wraps: the wrappers look each handler up in an enumeration, which took a tenth of a short solve
    import _signal as _interpreter
except ImportError:  # another Python than CPython
    _interpreter = signal
_SIGINT = int(signal.SIGINT)

CTRL_C, PROGRESS, FAILED = "Ctrl-C", "progress", "an error"  # what ends work early
_AT_ONCE = 0.5  # three of Ctrl-C within this time raise KeyboardInterrupt [s]

#: Names of the long calls of this process that Ctrl-C ended early, and which returned what was finished.
ended_early: list[str] = []
#: Names of those that were complete when Ctrl-C came.
complete_before: list[str] = []


class Interrupted(KeyboardInterrupt):
    """Raised where a long call may end, after Ctrl-C or after its progress function returned False."""


class _AtOnce(KeyboardInterrupt):
    """Raised by Ctrl-C again: no partial result is made of it."""


class StopRequest:
    """Whether a call, or a part of its work in threads, is to end, and why.

    Examples
    --------
    >>> whole = StopRequest()
    >>> part = StopRequest(whole)
    >>> whole.set("Ctrl-C")
    >>> part.why, bool(part)
    ('Ctrl-C', True)
    """

    def __init__(self, whole: StopRequest | None = None):
        self._whole, self._why = whole, ""
        self.blocks, self.is_finishing = 0, False  # under `partial_result`: how many are open, and whether the last one was left

    @property
    def why(self) -> str:
        """What asked for it; "" while nothing has."""
        return self._why or ("" if self._whole is None else self._whole.why)

    def __bool__(self) -> bool:
        return self.why != "" and not self._finishes

    @property
    def _finishes(self) -> bool:
        """Whether all that could be interrupted is done, so that the rest is done in full."""
        return self.is_finishing if self._whole is None else self._whole._finishes

    def set(self, why: str) -> None:
        """Ask for the end of this work."""
        self._why = self._why or why

    def set_all(self, why: str) -> None:
        """Ask for the end of the call of which this work is a part."""
        self.set(why)
        if self._whole is not None:
            self._whole.set_all(why)

    @contextlib.contextmanager
    def on_error(self) -> Iterator[None]:
        """A block of which an error, or an interruption, ends the work too."""
        try:
            yield
        except BaseException:
            self.set(FAILED)
            raise

    def clear(self) -> None:
        """The end has come: what follows in this call is done in full."""
        self._why = ""
        if self._whole is not None:
            self._whole.clear()


class _Call(NamedTuple):
    """The long call that runs in this context."""

    name: str
    stop: StopRequest
    depth: int  # 1: the outermost call; 2: a call within it
    some_cases: bool  # whether a batch within it may end with cases that are not computed
    ended: list[str]  # why it ended early, where it did


_call: contextvars.ContextVar[_Call | None] = contextvars.ContextVar("stickslip_call", default=None)


# ---- long calls ----
def interruptible(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a long call: Ctrl-C and a progress function end it by the rule of this module.

    Where nothing is finished, or a part of the result means nothing, KeyboardInterrupt goes on to the caller.

    Examples
    --------
    >>> @interruptible
    ... def squares(count):
    ...     found = []
    ...     with partial_result() as ending:
    ...         for n in range(count):
    ...             look()
    ...             found.append(n * n)
    ...             if n == 2:
    ...                 stop_call(PROGRESS)
    ...     return found, ending.note(f"{len(found)} of {count} squares")
    >>> squares(5)
    ([0, 1, 4], 'stopped by progress: 3 of 5 squares')
    """

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> T:
        outer = _call.get()
        call = _Call(function.__name__, StopRequest(), 1, False, []) if outer is None else outer._replace(depth=outer.depth + 1)
        token, listens = _call.set(call), False
        try:
            if outer is not None:
                return function(*args, **kwargs)
            listens = _begin_listening(call.stop)
            result = function(*args, **kwargs)
        except Interrupted:
            if outer is not None:
                raise
            raise _without_result(call) from None
        finally:
            if listens:
                _end_listening()
            _call.reset(token)
        if call.stop.why or call.ended:
            _say(call)
        return result

    return run


def _without_result(call: _Call) -> BaseException:
    """What is raised where an interrupted call has no partial result."""
    if call.stop.why == PROGRESS:
        return StickslipError(f"{call.name}: progress returned False before there was a result")
    return KeyboardInterrupt(f"{call.name} was interrupted")


def _say(call: _Call) -> None:
    """A sentence on stderr after Ctrl-C, since the script goes on."""
    if CTRL_C in call.ended:
        ended_early.append(call.name)
        sentence = f"{call.name} was interrupted; what is finished is returned (Ctrl-C three times at once ends the program)"
    elif call.stop.why == CTRL_C:
        complete_before.append(call.name)
        sentence = f"{call.name} was complete when Ctrl-C came"
    else:
        return
    from stickslip.basics.notices import notify

    notify(f"stickslip: {sentence}")


def look() -> None:
    """Raise `Interrupted` if the call that runs is to end: asked between two pieces of work, where all numbers are complete."""
    call = _call.get()
    if call is not None and call.stop:
        raise Interrupted(f"{call.name} was interrupted")


def looking(function: Callable[P, T]) -> Callable[P, T]:
    """The same function, which looks first: for integrators and searches of other libraries, whose loops are not ours.

    Examples
    --------
    >>> looking(abs)(-1.0)
    1.0
    """

    def looked(*args: P.args, **kwargs: P.kwargs) -> T:
        look()
        return function(*args, **kwargs)

    return looked


def is_stopped() -> bool:
    """Whether the call that runs is to end."""
    call = _call.get()
    return call is not None and bool(call.stop)


def is_asked_to_end() -> bool:
    """Whether an end was asked for since the call that runs began, also where the rest is done in full."""
    call = _call.get()
    return call is not None and call.stop.why != ""


def is_outermost() -> bool:
    """Whether the call that runs has no other one around it: then a user gets what it returns."""
    call = _call.get()
    return call is not None and call.depth == 1


def stop_call(why: str) -> None:
    """Ask for the end of the call that runs."""
    call = _call.get()
    if call is not None:
        call.stop.set_all(why)


# ---- partial results ----
class Ending:
    """How a block under `partial_result` ended."""

    def __init__(self) -> None:
        self.why = ""

    @property
    def interrupted(self) -> bool:
        """Whether it ended early."""
        return self.why != ""

    @property
    def words(self) -> str:
        """How it ended early, such as "interrupted"; "" if it did not."""
        return {"": "", PROGRESS: "stopped by progress"}.get(self.why, "interrupted")

    def note(self, finished: str) -> str:
        """A note that says what is finished; "" where everything is."""
        return f"{self.words}: {finished}" if self.why else ""

    def needs(self, something: Any) -> None:
        """Go on with the interruption where nothing that it leaves makes a result."""
        if self.why and not something:
            stop_call(self.why)
            raise Interrupted


@contextlib.contextmanager
def partial_result() -> Iterator[Ending]:
    """A block of the outermost call that an interruption ends, so that the call goes on with what is finished.

    In a call within another one the interruption goes on. What follows the last such block is done in full: nothing that is finished gets
    lost, except by a second Ctrl-C.
    """
    ending, call = Ending(), _call.get()
    with _block(call):
        yield from _until_interrupted(ending, call)


@contextlib.contextmanager
def _block(call: _Call | None) -> Iterator[None]:
    """A block of the outermost call that may be interrupted; what comes after the last one is done in full."""
    if call is None or call.depth > 1:
        yield
        return
    call.stop.blocks, call.stop.is_finishing = call.stop.blocks + 1, False
    try:
        yield
    finally:
        call.stop.blocks -= 1
        call.stop.is_finishing = call.stop.blocks == 0


def _until_interrupted(ending: Ending, call: _Call | None) -> Iterator[Ending]:
    """The block itself, whose interruption is noted."""
    try:
        yield ending
    except KeyboardInterrupt as pressed:
        if call is None or call.depth > 1 or isinstance(pressed, _AtOnce):
            raise
        call.stop.set_all(CTRL_C)
        ending.why = call.stop.why
        accept_part()


def accept_part() -> None:
    """The outermost call returns a part, which says so: what follows in it is done in full."""
    call = _call.get()
    if call is not None and call.depth == 1 and call.stop.why:
        call.ended.append(call.stop.why)
        call.stop.clear()


def takes_some_cases() -> bool:
    """Whether a batch that is solved now may end with cases that are not computed: the user's own, and a sweep's in memory."""
    call = _call.get()
    return call is not None and call.some_cases


def taking_some_cases(taken: bool = True) -> contextlib.AbstractContextManager[None]:
    """A block of the outermost call in which a batch may end with cases that are not computed; or, within it, one in which it may not."""
    call = _call.get()
    some_cases = call is not None and taken and (call.some_cases or call.depth == 1)
    return _Block(call and _Call(call.name, call.stop, call.depth, some_cases, call.ended))


class _Block:
    """A block in which another `_Call` stands in the context; without a generator, which took a fiftieth of a short solve."""

    __slots__ = ("_inside", "_token")

    def __init__(self, inside: _Call | None):
        self._inside = inside

    def __enter__(self) -> None:
        self._token = _call.set(self._inside)

    def __exit__(self, *raised: object) -> None:
        _call.reset(self._token)


# ---- threads ----
def in_threads(whole: StopRequest | None = None) -> tuple[StopRequest, Callable[..., Any]]:
    """A `StopRequest` for work in threads, which that of the call ends too, and what runs a function in a thread as a part of the call.

    `whole` stands for the call where it is made in another process.
    """
    call = _call.get()
    stop = StopRequest(whole if call is None or whole is not None else call.stop)
    inside = _Call("", stop, 2, False, []) if call is None else call._replace(stop=stop, depth=call.depth + 1)

    context = contextvars.copy_context()
    context.run(_call.set, inside)
    return stop, lambda function, *args: context.copy().run(function, *args)


# ---- the signal ----
_listening: StopRequest | None = None  # of the outermost call of the main thread
_held = 0  # blocks of the main thread in which nothing is raised
_due = False  # whether KeyboardInterrupt is raised at their end
_pressed_at = (-math.inf, -math.inf)  # the last two times


def _pressed(number: int, frame: Any) -> None:
    """The handler of Ctrl-C while a long call runs, or a block is held together."""
    global _due, _pressed_at
    now = time.monotonic()
    at_once = _listening is None or _listening.why == CTRL_C or now - _pressed_at[0] < _AT_ONCE
    _pressed_at = (_pressed_at[1], now)
    if _listening is not None:
        _listening.set(CTRL_C)
    if _held:
        _due = _due or at_once
    elif at_once:
        raise _AtOnce


def _takes_signals() -> bool:
    """Whether Ctrl-C would raise KeyboardInterrupt here: in the main thread, and where nobody has a handler of their own."""
    return threading.current_thread() is threading.main_thread() and _interpreter.getsignal(_SIGINT) is signal.default_int_handler


def _begin_listening(stop: StopRequest) -> bool:
    """Let Ctrl-C set a `StopRequest`, where it would have raised KeyboardInterrupt; whether it would."""
    global _listening
    if not _takes_signals():
        return False
    _listening = stop
    _interpreter.signal(_SIGINT, _pressed)
    return True


def _end_listening() -> None:
    """Let Ctrl-C raise KeyboardInterrupt again."""
    global _listening
    _interpreter.signal(_SIGINT, signal.default_int_handler)
    _listening = None


@contextlib.contextmanager
def held_together() -> Iterator[None]:
    """A block within which Ctrl-C raises nothing: an import or a compilation, which would be left half done; it is raised at the end."""
    global _held, _due
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    mine = _listening is None and _takes_signals()  # a long call takes them already
    if mine:
        _interpreter.signal(_SIGINT, _pressed)
    _held += 1
    try:
        yield
    finally:
        _held -= 1
        if mine:
            _interpreter.signal(_SIGINT, signal.default_int_handler)
        if _due and not _held:
            _due = False
            raise _AtOnce
