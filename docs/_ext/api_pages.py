"""One page for each public object, made from the list in ``api.md``, whose own page becomes tables with a line for each.

``api.md`` has blocks of ``auto…`` directives with their options; a public name that it does not list comes at the end of the section of
its package. Before the build each directive moves to a page of its own in ``docs/api/`` (never committed). Files are in
folders by kind, as `ss.analysis.Motion` and `ss.motion` would be one file on some systems.
Classes show the signature of ``__init__``: ``__new__``, which checks arguments, takes anything.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # the list is completed, and tested, without Sphinx
    from sphinx.application import Sphinx

AFTER_NAPOLEON = 600
#: Package -> the section of ``api.md`` for its public names that are not listed.
_SECTIONS = {
    "basics": "Describe", "models": "Describe", "results": "Solve", "records": "Records and identification", "engine": "Solve",
    "solvers": "Solve", "analysis": "Analyse", "studies": "Solve many", "dynamics": "Dynamics", "inverse": "Records and identification",
    "show": "Show",
}  # fmt: skip
#: Modules with a page for each of their names; the others have one page.
_OF_OBJECTS = ("friction", "drives", "tracks", "machines", "dynamics", "analysis", "identification", "optimisation", "studies")
_BLOCK = re.compile(r"^```\{eval-rst\}\n(.*?)^```$", re.M | re.S)
_FOLDERS = {"autoclass": "classes", "autoexception": "classes", "autofunction": "functions", "automodule": "modules", "py:data": "data"}
_ROLES = {"autoclass": "class", "autoexception": "exc", "autofunction": "func", "automodule": "mod", "py:data": "data"}


@dataclass(frozen=True)
class Entry:
    """A directive of the list."""

    kind: str
    name: str
    text: str

    @property
    def page(self) -> str:
        """The document, from docs/."""
        return f"api/{_FOLDERS[self.kind]}/{self.name.removeprefix('stickslip.')}"

    @property
    def link(self) -> str:
        return f":doc:`{self.name.removeprefix('stickslip.')} </{self.page}>`"

    def written(self) -> str:
        """Its page. It stands in no table of contents: three hundred lines in the sidebar of every page would help nobody."""
        short = self.name.removeprefix("stickslip.")
        return f":orphan:\n\n{short}\n{'=' * len(short)}\n\n:doc:`All public names </api>`\n\n{self.text}\n"

    def summary(self) -> str:
        """Its first line."""
        if self.kind == "py:data":
            return next(line.strip() for line in self.text.splitlines()[1:] if line.strip() and not line.strip().startswith(":"))
        return (inspect.getdoc(found(self.name)) or "").partition("\n")[0]


def found(name: str) -> Any:
    """The object of a dotted name."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        try:
            value = import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for part in parts[length:]:
            value = getattr(value, part)
        return value
    raise ModuleNotFoundError(name)


def entries(block: str) -> list[Entry]:
    """The directives of a block."""
    made = []
    for text in re.split(r"^(?=\.\. )", block, flags=re.M):
        if head := re.match(r"\.\. ([\w:]+):: (\S+)", text):
            made.append(Entry(head[1], head[2], text.rstrip()))
    return made


def table(block: str) -> str:
    """What stands on the list's page instead of a block."""
    listed = entries(block)
    rows = [f"   * - {entry.link}\n     - {entry.summary()}" for entry in listed]
    head = ".. list-table::\n   :widths: 30 70\n"
    return "\n".join(["```{eval-rst}", head, *rows, "```"])


def completed(text: str) -> str:
    """The list, with every public name."""
    import stickslip

    listed = {e.name for block in _BLOCK.findall(text) for e in entries(block)}
    known = {found(name) for name in listed if not isinstance(found(name), dict)}
    for name, value in public_objects(stickslip).items():
        if not callable(value) or value in known or name in listed:
            continue
        known.add(value)
        directive = f".. autoclass:: {name}\n   :members:" if inspect.isclass(value) else f".. autofunction:: {name}"
        text = _added(text, _SECTIONS[value.__module__.split(".")[1]], directive)
    return text


def public_objects(package: Any) -> dict[str, Any]:
    """Every name of the package and of the modules that it shows, but for those of modules that draw."""
    objects = {}
    for name in package.__all__:
        value = getattr(package, name)
        if not inspect.ismodule(value):
            objects[f"stickslip.{name}"] = value
        elif name in _OF_OBJECTS:
            objects |= {f"stickslip.{name}.{each}": getattr(value, each) for each in value.__all__}
    return objects


def _added(text: str, section: str, directive: str) -> str:
    """The list with a directive at the end of the blocks of a section."""
    begin = text.index(f"\n## {section}\n")
    end = text.find("\n## ", begin + 1)
    last = text.rindex("\n```", begin, end if end >= 0 else len(text))
    return f"{text[:last]}\n\n{directive}{text[last:]}"


def write_pages(app: Sphinx) -> None:
    """Write all pages anew; what has not changed keeps its time, so that it is not read again."""
    folder = Path(app.srcdir)
    listed = [e for block in _BLOCK.findall(completed((folder / "api.md").read_text(encoding="utf-8"))) for e in entries(block)]
    wanted = {folder / f"{entry.page}.rst": entry.written() for entry in listed}
    for file in (folder / "api").rglob("*.rst"):
        if file not in wanted:
            file.unlink()
    for file, text in wanted.items():
        file.parent.mkdir(parents=True, exist_ok=True)
        if not file.exists() or file.read_text(encoding="utf-8") != text:
            file.write_text(text, encoding="utf-8")


def list_them(app: Sphinx, page: str, content: list[str]) -> None:
    """Tables instead of directives."""
    if page == "api":
        content[0] = _BLOCK.sub(lambda block: table(block[1]), completed(content[0]))


def signature(app: Sphinx, what: str, name: str, value: Any, options: Any, args: str, returns: str) -> tuple[str, str] | None:
    """The signature of a class: that of ``__init__``, with defaults as they print."""
    if what != "class":
        return None
    if value.__init__ is object.__init__:
        return "", ""
    parameters = [p.replace(annotation=p.empty) for p in inspect.signature(value.__init__).parameters.values()]
    fields = dataclasses.fields(value) if dataclasses.is_dataclass(value) else ()
    made = {field.name: field.default_factory for field in fields if callable(field.default_factory)}
    parameters = [p.replace(default=made[p.name]()) if p.name in made else p for p in parameters[1:]]
    return str(inspect.Signature(parameters)), ""


def whole_sentence(app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """Napoleon takes what stands before a colon in a property's docstring for its type; it is the first half of a sentence."""
    if what == "property":
        for i in [i for i, line in enumerate(lines) if line.startswith(":type: ")]:
            lines[0] = f"{lines.pop(i).removeprefix(':type: ')}: {lines[0]}"


def words_of_types(app: Sphinx, page: Any) -> None:
    """Words in the types of parameters, such as "numbers" in "array (numbers,)", are no members of classes that have such a name."""
    from sphinx.addnodes import pending_xref

    for reference in list(page.findall(pending_xref)):
        if reference.get("reftype") == "class" and reference["reftarget"].islower() and "." not in reference["reftarget"]:
            reference.replace_self(reference.children)


def setup(app: Sphinx) -> dict[str, bool]:
    """Pages before Sphinx looks for pages; tables and signatures as it reads."""
    app.connect("builder-inited", write_pages)
    app.connect("source-read", list_them)
    app.connect("autodoc-process-signature", signature)
    app.connect("autodoc-process-docstring", whole_sentence, priority=AFTER_NAPOLEON)
    app.connect("doctree-read", words_of_types)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
