"""What is registered, asked in one way: an entry that is not finished takes no test module away, and one sentence says what it lacks."""

from __future__ import annotations

import dataclasses
import functools
import importlib
import pkgutil
import re

import stickslip as ss
from house import ROOT
from stickslip.fields import is_number_field, is_tuple_field


def examples(registry):
    """The example of every entry that has one; `test_recipes.py` says what the others lack."""
    return {name: made for name, cls in registry.items() if (made := example(cls)) is not None}


def example(cls):
    """The example of a class; None where it gives none, whatever the reason."""
    try:
        return cls.example()
    except Exception:
        return None


def lacking(name, cls, needs, *pages):
    """Sentences on what a new law or drive lacks, by the steps of CONTRIBUTING."""
    found = unfinished(cls, *pages)
    if not dataclasses.is_dataclass(cls):
        return found
    if example(cls) is None:
        found.append(f"{cls.__name__}.example() gives no {cls.__name__}: give its fields examples, or write the classmethod example")
    found += [f"{cls.__name__}: write its method or property {need}" for need in needs if not hasattr(example(cls) or cls, need)]
    if name != cls.__name__.lower():
        found.append(f"{cls.__name__}: its name in the registry is {name!r}; allowed is {cls.__name__.lower()!r}")
    return found


def unfinished(cls, *pages):
    """Sentences on what a record of ours lacks, whatever it is: how it is declared, its numbers, its pages and its public name."""
    if not (dataclasses.is_dataclass(cls) and cls.__dataclass_params__.frozen):
        return [f"{cls.__name__}: write @dataclass(frozen=True, eq=False) above the class"]
    found = [sentence for field in dataclasses.fields(cls) for sentence in _of_field(cls, field)]
    if ">>> " not in (cls.__doc__ or ""):
        found.append(f"{cls.__name__}: give its docstring an example that runs")
    for page, words in (*((page, cls.__name__) for page in pages), ("docs/api.md", f"stickslip.{cls.__name__}")):
        if not re.search(rf"\b{words}\b", text_of(page)):
            found.append(f"{cls.__name__}: write about it in {page}")
    if f"{cls.__name__} as {cls.__name__}" not in text_of("src/stickslip/__init__.pyi"):
        found.append(f"{cls.__name__}: name it in src/stickslip/__init__.pyi")
    elif getattr(ss, cls.__name__, None) is not cls:
        found.append(f"{cls.__name__}: import it where src/stickslip/__init__.pyi has it from")
    package, _, _ = cls.__module__.rpartition(".")
    if cls.__name__ not in getattr(importlib.import_module(package), "__all__", [cls.__name__]):
        found.append(f"{cls.__name__}: name it in __all__ of {package}")
    return found


def unregistered(package, base, registry):
    """Records that a package defines, from which no other is made, and which its registry lacks."""
    modules = [importlib.import_module(f"{package.__name__}.{found.name}") for found in pkgutil.iter_modules(package.__path__)]
    mine = [cls for module in modules for cls in vars(module).values() if isinstance(cls, type) and cls.__module__ == module.__name__]
    return [
        cls.__name__
        for cls in mine
        if issubclass(cls, base) and dataclasses.is_dataclass(cls) and not cls.__subclasses__() and cls not in registry.values()
    ]


def _of_field(cls, field):
    if not (is_number_field(field) or is_tuple_field(field)) or field.name == "notes":
        return []
    wanted = [key for key in ("label", "unit", "example") if key not in field.metadata]
    kind = getattr(field.type, "__name__", field.type)
    typed = f'{field.name}: {kind} = field(metadata=quantity("what it is", "its unit", example=1.0))'
    return [f"{cls.__name__}.{field.name} has no {', '.join(wanted)}; type {typed}"] if wanted else []


@functools.cache
def text_of(place):
    """The text of a page, or of all pages of a folder but its index: "docs/laws/*.md"."""
    path = ROOT / place
    pages = sorted(page for page in path.parent.glob(path.name) if path.name == page.name or page.stem != "index")
    return "\n".join(page.read_text(encoding="utf-8") for page in pages)
