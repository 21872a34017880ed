"""Functions on plain numbers and arrays as C99: what `functions.py` writes as LLVM instructions, from the same texts, with the same bits.

A function is written where one that is written calls it, behind what it calls itself. Arguments that are known are put in their places, and
those that it does not use are left out, of arrays the lengths too.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import Any

from stickslip.engine.c_expressions import REAL, View, constant
from stickslip.engine.c_function_body import CFunction, write_c_body

#: A polynomial of a row of coefficients and its slope, at points of another row, into two further rows.
AT_POINTS = """\
static void at_points(const double *c, double *rows, int64_t x, int64_t to, int64_t slopes_to, int64_t order, int64_t count)
{
    for (int64_t j = 0; j < count; j++) {
        const double point = rows[x + j];
        double value = c[order], slope = 0.0;
        for (int64_t m = order - 1; m >= 0; m--) {
            slope = fma(slope, point, value);
            value = fma(value, point, c[m]);
        }
        rows[to + j] = value;
        rows[slopes_to + j] = slope;
    }
}
"""


@dataclass
class CProgram:
    r"""All functions of some texts, each text with constants of its own.

    Parameters
    ----------
    texts : dict of str
        Python texts by the letters that the names of their C functions begin with.
    shared : dict of View
        Arrays that all functions share, by the names that they have in ``NAME_of``.
    known : dict
        Numbers, or views, of arguments that are the same in every call, by their names.
    table : sequence of int
        The numbers of the array D.

    Examples
    --------
    >>> text = "@typed(void(int64, f1))\ndef put(k, x):\n    x[k] = 2.0\n"
    >>> program = CProgram({"my_": text}, {}, {}, ())
    >>> program.function("my_", "put").name, program.written[0].splitlines()[0]
    ('my_put', 'static void my_put(int64_t k, double *x)')
    """

    texts: dict[str, str]
    shared: dict[str, View]
    known: dict[str, Any]
    table: Any
    outside: dict[str, str] = field(default_factory=dict)  # C functions by the names of what is called at an address
    written: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._made = dict[tuple[str, str], CFunction]()
        self.declared = {letters: _declared(text) for letters, text in self.texts.items()}

    def function(self, letters: str, name: str) -> CFunction:
        """A function of a text, which is written now if it is not yet."""
        if (letters, name) not in self._made:
            self._made[letters, name] = made = write_c_body(self, letters, name)
            self.written.append(made.text)
        return self._made[letters, name]

    def at_address(self, name: str) -> CFunction:
        """What is called at an address: a function of C, or of the first text that has it."""
        if name in self.outside:
            return CFunction(self.outside[name], "", ((0, -1), (1, -1), (2, -1)), ())
        return self.function(next(letters for letters, known in self.declared.items() if name in known[0]), name)

    def whole_table(self) -> str:
        """The name of the array D, for those who ask for a number of it that is not known beforehand."""
        if ("", "D") not in self._made:
            self._made["", "D"] = CFunction("D", "", (), ())
            self.written.append(f"static const int64_t D[] = {{{', '.join(map(str, self.table))}}};\n")
        return "D"

    def row(self, letters: str, name: str) -> View:
        """An array of constants."""
        numbers = self.declared[letters][2][name]
        own = f"{letters}{name.lower()}"
        if (letters, name) not in self._made:
            self._made[letters, name] = CFunction(own, "", (), ())
            self.written.append(f"static double {own}[] = {{{', '.join(str(constant(float(n))) for n in numbers)}}};\n")
        return View(own, REAL, (constant(len(numbers)),))


def _declared(text: str) -> tuple[dict[str, ast.FunctionDef], dict[str, str], dict[str, Any]]:
    """The functions of a text, the types of each, and its constants."""
    functions, kinds = {}, {}
    constants: dict[str, Any] = {"__builtins__": {"range": range, "object": object}}
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            functions[node.name] = node
            kind = node.decorator_list[0].args[0]  # type: ignore[attr-defined]
            kinds[node.name] = kind.value if isinstance(kind, ast.Constant) else ast.unparse(kind)
        elif isinstance(node, ast.Assign):
            exec(ast.unparse(node), constants)
    return functions, kinds, constants
