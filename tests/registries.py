"""What is registered, asked in one way: an entry that is not finished takes no test module away, and one sentence says what it lacks."""

from __future__ import annotations

import dataclasses
import functools
import importlib
import pkgutil
import re
from dataclasses import dataclass
from typing import Any

import pytest

import stickslip as ss
from house import ROOT
from stickslip import drives, friction, machines
from stickslip.basics.field_types import field_types
from stickslip.basics.lazy_names import typed_name
from stickslip.mechanisms import MECHANISMS
from stickslip.models.drives.drive import Drive
from stickslip.models.friction.law import Law
from stickslip.models.machines.mechanism import Mechanism

#: Classes that only help others, and records that are made of others and never typed: in a registry they are not.
OF_OTHERS = {
    "Link",
    "BehindPlay", "BodyAndMass", "DynamicSum", "LawAdapter", "ModalSum", "PeriodicRecord", "Rigid", "Rippled", "Shifted", "SlidingSum",
    "Sum", "Together", "Turned", "TurnedCoordinates",
}  # fmt: skip


@dataclass(frozen=True)
class Folder:
    """A folder of which every class is in one registry: its base class, and the methods by which a class without it is known."""

    package: Any
    base: type
    registry: dict[str, Any]
    methods: tuple[str, ...]
    place: str


_OF_MACHINES = "MECHANISMS in src/stickslip/models/machines/__init__.py"
FOLDERS = (
    Folder(friction, Law, ss.friction.LAWS, ("rate", "force", "sliding", "breakaway"), "_ALL in src/stickslip/models/friction/__init__.py"),
    Folder(drives, Drive, ss.drives.DRIVES, ("position", "velocity", "acceleration"), "_ALL in src/stickslip/models/drives/__init__.py"),
    Folder(machines, ss.Machine, MECHANISMS, ("bodies",), _OF_MACHINES),
    Folder(machines, Mechanism, MECHANISMS, ("acceleration",), _OF_MACHINES),
)


def tell(sentences):
    """Fail with sentences, and with nothing else."""
    if sentences:
        pytest.fail("\n".join(sentences), pytrace=False)


def all_that_is_forgotten():
    """Every sentence on laws, drives and machines: told below errors at collection, which keep the tests that say it from running."""
    found = [sentence for folder in FOLDERS for sentence in unregistered(folder)]
    found += [sentence for name in ss.friction.LAWS for sentence in law_lacks(name)]
    found += [sentence for name in ss.drives.DRIVES for sentence in drive_lacks(name)]
    return found + [sentence for name in MECHANISMS for sentence in machine_lacks(name)]


_DYNAMIC, _SET_VALUED = ("rate", "force"), ("sliding", "breakaway")


def law_lacks(name):
    """Sentences on what a law lacks."""
    law = ss.friction.LAWS[name]
    needs = _DYNAMIC if any(hasattr(law, need) for need in _DYNAMIC) else _SET_VALUED  # bristles have break-away coefficients too
    page, picture = text_of("docs/laws/*.md"), f"images/laws/{name}.png"
    drawn = [] if picture in page else [f"{law.__name__}: python examples/bench_laws.py {name} draws docs/{picture}; show it on its page"]
    return [*lacking(name, law, needs, "docs/laws/index.md", "docs/laws/*.md", base=Law), *drawn]


def drive_lacks(name):
    """Sentences on what a drive lacks."""
    drive = ss.drives.DRIVES[name]
    needs = ("position", "velocity", "acceleration", "period", "stroke", "velocity_scale")
    return [*lacking(name, drive, needs, "docs/drives/index.md", base=Drive), *wordless(drive, "docs/drives")]


def machine_lacks(name):
    """Sentences on what a machine lacks; `tests/every.py` says the rest."""
    made = MECHANISMS[name]
    kind = [] if name else [f'{made.__name__}: write kind: ClassVar[str] = "{made.__name__.lower()}", its name in a study file']
    return kind + unfinished(made, "notes/which-machine.md", "docs/machines/*.md" if issubclass(made, ss.Machine) else "docs/mechanisms.md")


def examples(registry):
    """The example of every entry that has one; `test_recipes.py` says what the others lack."""
    return {name: made for name, cls in registry.items() if (made := example(cls)) is not None}


def example(cls):
    """The example of a class; None where it gives none, whatever the reason."""
    try:
        return cls.example()
    except Exception:
        return None


def lacking(name, cls, needs, *pages, base=object):
    """Sentences on what a new law or drive lacks, by the steps of CONTRIBUTING."""
    found = [] if issubclass(cls, base) else [f"{cls.__name__}: {on_base(cls, base)}"]
    found += unfinished(cls, *pages)
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
    own = vars(cls).get("__dataclass_params__")  # a base class has some too, and without its own the fields of the class are none
    if own is None or not own.frozen or own.eq:
        return [f"{cls.__name__}: write @dataclass(frozen=True, eq=False) above the class"]
    found = [sentence for field in dataclasses.fields(cls) for sentence in _of_field(cls, field)]
    if ">>> " not in (cls.__doc__ or ""):
        found.append(f"{cls.__name__}: give its docstring an example that runs")
    lacking_in = [page for page in pages if not re.search(rf"\b{cls.__name__}\b", text_of(page))]
    found += [f"{cls.__name__}: {_to_write(page)}" for page in lacking_in]
    package, _, _ = cls.__module__.rpartition(".")
    if not typed_name(cls.__name__) or cls.__name__ not in getattr(importlib.import_module(package), "__all__", [cls.__name__]):
        found.append(f"{cls.__name__}: name it in __all__ of {package}")
    return found


def _to_write(page):
    if "index" in page:
        return f"add a row about it to the table of {page}"
    return f"write a page about it, or a part of one, in {page.removesuffix('/*.md')}" if "*" in page else f"write about it in {page}"


def on_base(cls, base):
    """What to type so that a class has its base."""
    return f"write from {base.__module__} import {base.__name__}, and class {cls.__name__}({base.__name__})"


def unregistered(folder):
    """A sentence for each class of a folder that its registry lacks; it need not have the base."""
    return [_not_registered(cls, folder) for cls in classes(folder.package) if is_left_out(cls, folder)]


def classes(package):
    """The public classes that the modules of a package define."""
    modules = [importlib.import_module(f"{package.__name__}.{found.name}") for found in pkgutil.iter_modules(package.__path__)]
    return [cls for module in modules for cls in own(module, type) if not cls.__name__.startswith("_")]


def own(module, kind):
    """What a module defines itself, of a kind."""
    return [value for value in vars(module).values() if isinstance(value, kind) and value.__module__ == module.__name__]


def is_left_out(cls, folder):
    """Whether a class seems to be one of a folder's, and is neither in its registry nor a base of one there."""
    known = cls.__name__ in OF_OTHERS or any(issubclass(entry, cls) for entry in folder.registry.values())
    return not known and (issubclass(cls, folder.base) or any(hasattr(cls, method) for method in folder.methods))


def _not_registered(cls, folder):
    derive = "" if issubclass(cls, folder.base) else f"{on_base(cls, folder.base)}; "
    place = f"{cls.__name__} in src/{cls.__module__.replace('.', '/')}.py"
    return f"{place}: {derive}add it to {folder.place}; if it only helps others, name it in OF_OTHERS in tests/registries.py"


def wordless(cls, folder):
    """A sentence where no page of a folder has a line on a class outside of code, tables and headings; the index is no such page."""
    if re.search(rf"\b{cls.__name__}\b", prose(text_of(f"{folder}/*.md"))):
        return []
    pages = ", ".join(sorted(page.name for page in (ROOT / folder).glob("*.md") if page.stem != "index"))
    return [
        f"{cls.__name__}: no page of {folder} describes it; write a paragraph with `{cls.__name__}` in it, which says what is given, "
        f"its equation and when to choose it, on one of its pages ({pages}) or on a new one"
    ]


def prose(text):
    """A page without its code, tables and headings."""
    without_code = re.sub(r"^(```+).*?^\1 *$", "", text, flags=re.M | re.S)
    return "\n".join(line for line in without_code.splitlines() if not line.startswith(("|", "#")))


def _of_field(cls, field):
    if field_types(cls)[field.name].holds not in ("number", "numbers") or field.name == "notes":
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
