"""The value of a formula in LaTeX, read from its text alone: the second opinion on what `ss.latex` prints."""

import math
import re

_TOKEN = re.compile(
    r"\\begin\{cases\}|\\end\{cases\}|\\text\{for\}\\:|\\text\{otherwise\}|\\left[(|]|\\right[)|]|\\operatorname\{\w+\}|\\mathrm\{[^{}]*\}"
    r"|\\dot|\\Delta|\\\\|\\[a-z]+|\\,|\d+(?:\.\d+)?(?:e-?\d+)?|[A-Za-z]'*|\S"
)
_FUNCTIONS = {"sin", "cos", "tan", "sinh", "cosh", "tanh", "log", "asinh", "atan"}
_COMPARISONS = {">": lambda a, b: a > b, "<": lambda a, b: a < b, r"\geq": lambda a, b: a >= b, r"\leq": lambda a, b: a <= b}


class _Reader:
    """Reads sums of products; letters stand for numbers by their text without blanks."""

    def __init__(self, text, numbers):
        self.tokens, self.numbers = [t for t in _TOKEN.findall(text) if t != r"\,"], numbers

    def peek(self):
        return self.tokens[0] if self.tokens else ""

    def take(self, wanted=None):
        token = self.tokens.pop(0)
        assert wanted in (None, token), (wanted, token, self.tokens[:5])
        return token

    def sum(self):
        total = -self.take_product("-") if self.peek() == "-" else self.product()
        while self.peek() in ("+", "-"):
            sign = 1 if self.take() == "+" else -1
            total += sign * self.product()
        return total

    def take_product(self, sign):
        self.take(sign)
        return self.product()

    def product(self):
        value = self.factor()
        while self.peek() and self.peek() not in "+-}&,=<>" and self.peek() not in (
            r"\right)", r"\right|", r"\\", r"\end{cases}", r"\geq", r"\leq", r"\wedge", r"\vee", r"\text{for}\:",
        ):  # fmt: skip
            if self.peek() == r"\cdot":  # before a power of ten
                self.take()
            value *= self.factor()
        return value

    def factor(self):
        value = self.base()
        return value ** self.braced() if self.raised() else value

    def raised(self):
        return self.peek() == "^" and bool(self.take())

    def braced(self):
        self.take("{")
        value = self.sum()
        self.take("}")
        return value

    def bracketed(self):
        self.take(r"\left(")
        values = [self.sum()]
        while self.peek() == ",":
            self.take()
            values.append(self.sum())
        self.take(r"\right)")
        return values

    def base(self):
        token = self.peek()
        name = token.removeprefix(r"\operatorname{").rstrip("}").removeprefix("\\")
        if token == r"\frac":
            self.take()
            above = self.braced()
            return above / self.braced()
        if token == r"\sqrt":
            return self.take() and math.sqrt(self.braced())
        if token == r"\left(":
            return self.bracketed()[0]
        if token == r"\left|":
            self.take()
            value = abs(self.braced())
            return self.take(r"\right|") and value
        if name in _FUNCTIONS and token.startswith("\\"):
            return self.called(name)
        if token in (r"\max", r"\min"):
            self.take()
            return (max if name == "max" else min)(self.bracketed())
        if token == r"\begin{cases}":
            return self.cases()
        if token == "e" and self.tokens[1:2] == ["^"]:
            self.take()
            return math.e
        return float(self.take()) if token[0].isdigit() else self.letter()

    def called(self, name):
        self.take()
        power = self.braced() if self.raised() else 1
        self.take("{")
        value = getattr(math, name)(self.bracketed()[0])
        self.take("}")
        return value**power

    def cases(self):
        self.take()
        found = []
        while True:
            value = self.sum()
            self.take("&")
            holds = True if self.peek() == r"\text{otherwise}" and self.take() else self.take(r"\text{for}\:") and self.condition()
            found.append((holds, value))
            if self.take() == r"\end{cases}":
                return next(value for holds, value in found if holds)

    def condition(self):
        left = self.sum()
        return _COMPARISONS[self.take()](left, self.sum())

    def letter(self):
        text = self.take()
        if text in (r"\dot", r"\Delta"):
            text += self.take()
        if self.peek() == "_":
            text += self.take() + self.take("{")
            depth = 1
            while depth:
                token = self.take()
                depth += (token == "{") - (token == "}")
                text += token
        return math.pi if text == r"\pi" else self.numbers[text]


def value(text, numbers):
    """The number that a formula stands for, its letters being these."""
    reader = _Reader(text, {name.replace(" ", ""): number for name, number in numbers.items()})
    found = reader.sum()
    assert not reader.tokens, reader.tokens
    return found
