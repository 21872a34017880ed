"""The public names of a package, as its `__init__.pyi` lists them: each is imported when it is first used."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Callable, Mapping
from pathlib import Path


def names_of_stub(package: str, file: str) -> tuple[dict[str, tuple[str, str]], set[str]]:
    """Each public name of a package with the module and the name that it has there; and which are second spellings of another.

    Parameters
    ----------
    package, file : str
        ``__name__`` and ``__file__`` of the package; its stub lies beside the file.

    Examples
    --------
    >>> import stickslip
    >>> names, spellings = names_of_stub("stickslip", stickslip.__file__)
    >>> names["solve"], spellings
    (('stickslip.solvers', 'solve'), {'optimize'})
    """
    tree = ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf-8"))
    places = {
        alias.asname or alias.name: (_absolute(package, node), alias.name)
        for node in tree.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    spellings = set()
    for node in tree.body:  # optimize = optimise
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Name) and isinstance(node.targets[0], ast.Name):
            places[node.targets[0].id] = places[node.value.id]
            if not node.value.id.startswith("_"):
                spellings.add(node.targets[0].id)
    return {name: module for name, module in places.items() if not name.startswith("_")}, spellings


def _absolute(package: str, node: ast.ImportFrom) -> str:
    if not node.level:
        return node.module or ""
    parts = package.split(".")[: len(package.split(".")) - node.level + 1]
    return ".".join([*parts, *([node.module] if node.module else [])])


def lazy_names(
    package: str, file: str, elsewhere: Callable[[str], object] | None = None, renamed: Mapping[str, str] | None = None
) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """`__getattr__`, `__dir__` and `__all__` of a package whose stub lists its names; second spellings load, but are not listed.

    Parameters
    ----------
    package, file : str
        ``__name__`` and ``__file__`` of the package.
    elsewhere : callable, optional
        Gives the value of a name that the stub does not list, or raises AttributeError; without it the name is refused.
    renamed : dict of str, optional
        What to type for names that there were, in lower case.

    Examples
    --------
    >>> import stickslip
    >>> load, listed, names = lazy_names("stickslip", stickslip.__file__)
    >>> listed() == names and load("solve").__name__
    'solve'
    """
    places, spellings = names_of_stub(package, file)
    listed = sorted(places.keys() - spellings)

    def load(name: str) -> object:
        if name not in places:
            if name.startswith("__"):  # asked for by the interpreter, nearly always
                raise AttributeError(f"{package} has no {name!r}")
            if elsewhere:
                return elsewhere(name)
            from stickslip.basics.errors import did_you_mean

            instead = (renamed or {}).get(name.lower())
            hint = f"type {instead}" if instead else did_you_mean(name, listed)
            raise AttributeError(f"{package} has no {name!r}; {hint}")
        module, attribute = places[name]
        imported = importlib.import_module(module)
        if attribute not in vars(imported) and (module == package or attribute not in dir(imported)):
            importlib.import_module(f"{module}.{attribute}")  # a package within the package
        value = getattr(imported, attribute)
        vars(importlib.import_module(package))[name] = value
        return value

    return load, lambda: listed, listed


def listing(names: list[str]) -> Callable[[], list[str]]:
    """`__dir__` of a module that shows its public names only, so that completion shows what there is to choose from.

    Examples
    --------
    >>> listing(["Coulomb", "LuGre"])()
    ['Coulomb', 'LuGre']
    """
    return lambda: list(names)


#: Whose names can be typed at the top as well, where they are not listed: ``ss.GMS`` is ``ss.friction.GMS``.
PACKAGES = (
    "friction", "drives", "tracks", "machines", "presets", "dynamics", "analysis", "identification", "optimisation", "studies", "designs",
    "results", "quantities",
)  # fmt: skip


def from_a_package(name: str) -> tuple[str, object] | None:
    """The package that has a public name which is not listed at the top, and what it stands for.

    Examples
    --------
    >>> from_a_package("GMS")[0], from_a_package("Mascot")
    ('friction', None)
    """
    top = importlib.import_module("stickslip")
    packages = ((package, getattr(top, package)) for package in PACKAGES)
    return next(((package, getattr(module, name)) for package, module in packages if name in module.__all__), None)


def typed_name(name: str) -> str:
    """What to type for a public name after ``import stickslip as ss``; empty if there is none.

    Examples
    --------
    >>> typed_name("LuGre"), typed_name("GMS"), typed_name("Mascot")
    ('ss.LuGre', 'ss.friction.GMS', '')
    """
    top = importlib.import_module("stickslip")
    if name in top.__all__:
        return f"ss.{name}"
    if package := from_a_package(name):
        return f"ss.{package[0]}.{name}"
    return f"ss.plot.{name}" if name in top.plot.__all__ else ""  # last, since figures load Matplotlib
