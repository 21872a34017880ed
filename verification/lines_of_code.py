"""Lines of code of each package, without docstrings, comments, blank lines and imports; and how long functions are.

    python verification/lines_of_code.py

Counted after the formatter. A line counts where a token of code stands on it. The length of a function is that of its body.
"""

import ast
import io
import statistics
import tokenize
from collections import Counter
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1] / "src" / "stickslip"
#: Counted, and told apart from the rest: what grows with the machines and results that there are.
APART = ("machines", "presets", "optimising", "paper")
_LAYOUT = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER)
_WITH_DOCSTRINGS = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def lines_of(node):
    """The lines that a node stands on."""
    return set(range(node.lineno, node.end_lineno + 1))


def without_code(tree):
    """Lines of imports and docstrings."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            found |= lines_of(node)
        if isinstance(node, _WITH_DOCSTRINGS) and ast.get_docstring(node) is not None:
            found |= lines_of(node.body[0])
    return found


def counted(text):
    """Lines of code of a file, and the lengths of its functions."""
    tree, found = ast.parse(text), set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _LAYOUT:
            found |= set(range(token.start[0], token.end[0] + 1))
    found -= without_code(tree)
    bodies = [range(node.body[0].lineno, node.end_lineno + 1) for node in ast.walk(tree) if isinstance(node, _FUNCTIONS)]
    return len(found), [len(found & set(body)) for body in bodies]


def main():
    """The table."""
    packages, functions = Counter(), []
    for path in sorted(SOURCE.rglob("*.py")):
        count, lengths = counted(path.read_text(encoding="utf-8"))
        parts = path.relative_to(SOURCE).parts
        packages[parts[0] if len(parts) > 1 else "(top)"] += count
        functions += lengths
    for name, count in packages.most_common():
        print(f"{name:14}{count:7}")
    apart = sum(packages[name] for name in APART)
    print(f"{'all':14}{packages.total():7}   without {', '.join(APART)}: {packages.total() - apart}")
    deciles = statistics.quantiles(functions, n=10)
    print(f"{len(functions)} functions, median {statistics.median(functions):g}, ninth decile {deciles[-1]:g}, longest {max(functions)}")


if __name__ == "__main__":
    main()
