r"""The lines of a flow: rates of its states by modes, the switches between them, and for each contact its slip, load and law."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.engine.latex_laws import lines_of_law
from stickslip.engine.letters import Formula, symbol
from stickslip.engine.tex import letter_of, letters_of, subscripted, text_of, upright
from stickslip.models.friction.law_adapter import is_law


def lines_of_flow(flow: Model) -> list[str]:
    """All lines of a flow; `InputError` where one of its functions is no formula."""
    try:
        return _first_that_fits(flow)
    except (TypeError, ValueError, AttributeError):  # NumPy's functions, say, or an if
        why = "a function of this flow cannot be written as a formula"
        raise InputError("latex", [f"{why}; write it with stickslip.maths, whose `where` decides, or type ss.latex(law)"]) from None


_MOST = 33  # states without names
_OPEN = r"\dots"  # a mode that a function chooses


def _first_that_fits(flow: Any) -> list[str]:
    """The lines with as many states as have names, or, without names, with the fewest that the functions accept and give rates of."""
    for count in range(1, _MOST) if flow.states is None else (len(flow.states),):
        try:
            return _Flow(flow, count).lines()
        except IndexError:
            pass
    raise ValueError("no number of states fits")


class _Flow:
    """A flow whose functions are called with letters."""

    def __init__(self, flow: Any, count: int):
        self.flow = flow
        self.states = [f"y_{{{i}}}" for i in range(count)] if flow.states is None else [subscripted(*letter_of(n)) for n in flow.states]
        self.t, self.y = symbol("t", 0), [symbol(text, 0) for text in self.states]
        self.numbers = _letters_of_numbers(flow, self.states)
        self.given = (SimpleNamespace(**self.numbers),) if flow.numbers else ()
        self.indices = {name: "" if len(flow.contacts) == 1 else upright(name) for name in flow.contacts}
        self.forces = (SimpleNamespace(**{n: symbol(subscripted("R", i), 0) for n, i in self.indices.items()}),) if flow.contacts else ()

    def lines(self) -> list[str]:
        return [*self._rates(), *self._switches(), *(line for name in self.flow.contacts for line in self._contact(name))]

    def _called(self, function: Callable[..., Any], *more: Any) -> Any:
        return function(self.t, self.y, *more, *self.given)

    # ---- modes ----
    def _rates(self) -> list[str]:
        """The rates of the states: once where they are the same in all modes."""
        by_mode = {mode: list(map(text_of, _tuple(self._called(field, *self.forces)))) for mode, field in self.flow.fields.items()}
        lines = []
        if any(len(rates) != len(self.states) for rates in by_mode.values()):
            raise IndexError("another number of states")
        for i, letter in enumerate(self.states):
            texts = {mode: rates[i] for mode, rates in by_mode.items()}
            for text in dict.fromkeys(texts.values()):
                modes = ", ".join(_mode(mode) for mode, own in texts.items() if own == text)
                lines.append(f"{_dotted(letter)} &= {text}" + (f", && {modes}" if len(set(texts.values())) > 1 else ""))
        return lines

    def _switches(self) -> list[str]:
        """Where a mode is left, to which one, and what the states are then; a mode that a function chooses is left open."""
        lines = []
        for mode, exits in self.flow.switches.items():
            for switch in exits:
                target = _OPEN if callable(switch.to) else _mode(switch.to)
                way = rf"{_mode(mode)} \to {target}"
                lines.append(f"{text_of(_tuple(self._called(switch.guard))[0])} &= 0, && {way}")
                if switch.reset is not None:
                    after = zip(self.states, self.y, _tuple(self._called(switch.reset)), strict=False)
                    lines += [rf"{letter}^+ &= {text_of(new)}, && {way}" for letter, old, new in after if new is not old]
        return lines

    # ---- contacts ----
    def _contact(self, name: str) -> list[str]:
        """Slip, load and law of one contact; under a law whose letter is a state the slip has no line of its own."""
        contact, index = self.flow.contacts[name], self.indices[name]
        slip, load = _tuple(self._called(contact.slip))[0], contact.load
        load = _tuple(self._called(load))[0] if callable(load) else load
        law = contact.friction if is_law(contact.friction) else contact.friction(*self.given)
        own, lines = text_of(slip) in self.states, []
        w, N = text_of(slip) if own else subscripted("w", index), symbol(subscripted("N", index))
        if not own:
            lines.append(f"{w} &= {text_of(slip)}")
        if text_of(load) != text_of(N):
            lines.append(f"{text_of(N)} &= {text_of(load)}")
        return [*lines, *lines_of_law(law, N, w, index)]


def _letters_of_numbers(flow: Any, states: list[str]) -> dict[str, Formula]:
    """A symbol for each number; one whose letter a state has is spelled out."""
    symbols = letters_of(flow, list(flow.numbers)).symbols
    return {name: symbol(upright(name)) if text_of(letter) in states else letter for name, letter in symbols.items()}


def _dotted(letter: str) -> str:
    return rf"\dot {letter}" if not letter.startswith(r"\mathrm") else rf"\dot{{{letter}}}"


def _mode(mode: Any) -> str:
    """A mode as it is called."""
    return rf"\mathrm{{mode}}\ {mode}" if isinstance(mode, (int, float)) else upright(str(mode))


def _tuple(value: Any) -> tuple[Any, ...]:
    return tuple(value) if isinstance(value, (tuple, list)) else (value,)
