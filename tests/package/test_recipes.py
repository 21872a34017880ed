"""Each recipe of CONTRIBUTING: a registered thing has all that its recipe names, and what is forgotten is told in a sentence."""

import importlib
import pkgutil
import re
import sys
import types
from dataclasses import dataclass, field

import numpy as np
import pytest

import stickslip as ss
from every import all_machines, without_line
from house import ROOT
from kinds import LAWS
from registries import (
    FOLDERS,
    OF_OTHERS,
    all_that_is_forgotten,
    classes,
    drive_lacks,
    examples,
    lacking,
    law_lacks,
    machine_lacks,
    own,
    prose,
    tell,
    text_of,
    unfinished,
    unregistered,
    wordless,
)
from rows import each_row
from stickslip import presets, records
from stickslip.engine import tableaux
from stickslip.engine.tableaux import TABLEAUX
from stickslip.mechanisms import MECHANISMS
from stickslip.models.friction.law import Law
from stickslip.models.machines import parts
from stickslip.models.machines.parts import LINKS
from stickslip.records import formats
from stickslip.records.raw import Raw, RawColumn
from stickslip.results.storage import from_text
from stickslip.show.cli import COMMANDS
from stickslip.show.cli.declaring import commands_in, declaration, summary_line
from stickslip.solvers.methods import METHODS
from stickslip.solvers.part_results import OF_SEVERAL
from stickslip.studies import solving
from stickslip.studies.result_columns import COLUMNS, END, with_missing_cases
from stickslip.tracks import TRACKS
from stickslip.variables import VARIABLES

RIG = {"amplitude": [6e-4], "tilt_deg": 1.7, "law": "coulomb"}
OF_ONE_BODY = "compute it in columns_of in src/stickslip/studies/solving.py"
OR_SEVERAL = "or add it to OF_SEVERAL in src/stickslip/solvers/part_results.py, if only machines of several parts have it"
OF_SEVERAL_BODIES = "compute it in columns_of_parts in src/stickslip/solvers/part_results.py"
OR_ONE = "or add it to OF_ONE in src/stickslip/studies/solving.py, if only one body on one contact has it"


@each_row("folder", FOLDERS)
def test_what_is_written_is_registered(folder):
    tell(unregistered(folder))


def test_what_only_helps_others_is_there():
    left = OF_OTHERS - {cls.__name__ for folder in FOLDERS for cls in classes(folder.package)}
    assert not left, f"{', '.join(sorted(left))}: take it out of OF_OTHERS in tests/registries.py"


def test_every_preset_is_registered():
    modules = [importlib.import_module(f"stickslip.presets.{found.name}") for found in pkgutil.iter_modules(presets.__path__)]
    names = [function.__name__ for module in modules for function in own(module, types.FunctionType)]
    left = [name for name in names if not (name.startswith("_") or (name in presets.PRESETS and name in presets.__all__))]
    assert not left, f"{', '.join(left)}: add to _ALL and to __all__ in src/stickslip/models/presets/__init__.py"


def test_every_link_is_registered():
    """Those that a file can hold: a `Link` is made of functions."""
    names = [cls.__name__ for cls in own(parts, type) if cls not in (*LINKS.values(), ss.Body, ss.Contact, ss.Stop, ss.machines.Link)]
    left = [name for name in names if not name.startswith("_")]
    assert not left, f'{", ".join(left)}: add a line such as "spring": Spring to LINKS at the end of src/stickslip/models/machines/parts.py'


@each_row("folder", ["laws", "drives", "machines"])
def test_every_page_is_in_a_list_of_pages(folder):
    listed = text_of(f"docs/{folder}/index.md")
    pages = [page.stem for page in (ROOT / "docs" / folder).glob("*.md") if page.stem != "index"]
    left = [name for name in pages if not re.search(rf"^({folder}/)?{name}$", listed, re.MULTILINE)]
    assert not left, f"{', '.join(left)}: add to the list of pages (toctree) of docs/{folder}/index.md"


@each_row("name", ss.friction.LAWS)
def test_a_law_has_what_its_recipe_names(name):
    tell(law_lacks(name))


@each_row("name", ss.drives.DRIVES)
def test_a_drive_has_what_its_recipe_names(name):
    tell(drive_lacks(name))


@each_row("name", TRACKS)
def test_a_track_has_what_its_recipe_names(name):
    kind = TRACKS[name]
    numbers = [f for f in kind.__dataclass_fields__.values() if "float" in str(f.type)]
    assert all({"label", "unit", "example"} <= set(f.metadata) for f in numbers), f"describe the numbers of {kind.__name__}"
    assert callable(kind.across) and callable(kind.along)


@each_row("name", LINKS)
def test_a_link_has_what_its_recipe_names(name):
    link = LINKS[name]
    moves = hasattr(link, "of_pair") or all(hasattr(link, need) for need in ("position", "velocity", "acceleration"))
    assert moves or hasattr(link, "force"), f"{link.__name__}: write force(distance, rate), or position, velocity and acceleration of t"
    tell(unfinished(link, "docs/your-own-machine.md"))


@each_row("name", MECHANISMS)
def test_a_machine_has_what_its_recipe_names(name):
    tell([*machine_lacks(name), *without_line(MECHANISMS[name])])
    machine = next(machine for machine, *_ in all_machines.values() if isinstance(machine, MECHANISMS[name]))
    assert type(from_text(machine.to_toml())) is MECHANISMS[name]


@each_row("known", formats.FORMATS)
def test_a_format_of_records_has_what_its_recipe_names(known):
    assert callable(known.reader()), f"write {known.read_by} in src/stickslip/records"
    for name in known.names:
        told = name in text_of("docs/records.md") and name in ss.read.__doc__
        assert told, f"name {name} in docs/records.md and in the docstring of read"


def test_every_reader_is_in_the_table_of_formats():
    """A function of bytes that makes a `Raw` reads a format, or a part of one."""
    places = [importlib.import_module(f"stickslip.records.{found.name}") for found in pkgutil.iter_modules(records.__path__)]
    made = [
        (place.__name__.rpartition(".")[2], function) for place in places for function in vars(place).values() if reads(place, function)
    ]
    left = {f"{place}.{function.__name__}" for place, function in made} - {known.read_by for known in formats.FORMATS}
    assert not left, f"{', '.join(sorted(left))}: add a line to FORMATS in src/stickslip/records/formats.py"


def reads(place, function):
    notes = getattr(function, "__annotations__", {})
    own = getattr(function, "__module__", "") == place.__name__ and not function.__name__.startswith("_")
    return own and next(iter(notes.items()), None) == ("data", "bytes") and notes.get("return") == "Raw"


def test_a_format_is_a_line_and_its_reader(monkeypatch, tmp_path):
    """Nobody else asks what a file is: the record, its source and the errors know the new one."""
    reader = types.ModuleType("stickslip.records.strain_logger")
    reader.parse = lambda data, allowance: Raw(
        "LOG", table=True, columns=[RawColumn("t", "s", np.arange(9.0)), RawColumn("v", "m/s", np.ones(9))]
    )
    monkeypatch.setitem(sys.modules, reader.__name__, reader)
    new = formats.Format(("LOG",), lambda data: data[:3] == b"LOG", "strain_logger.parse")
    monkeypatch.setattr(formats, "FORMATS", [new, *formats.FORMATS])
    (tmp_path / "a.log").write_bytes(b"LOG and numbers")
    (tmp_path / "b.log").write_bytes(bytes(range(1, 32)) * 9)
    assert ss.read(tmp_path / "a.log")["velocity"].values.tolist() == [1.0] * 9 and ss.read(tmp_path / "a.log").source["format"] == "LOG"
    with pytest.raises(ss.InputError, match=r"allowed are .*HDF5 and LOG"):
        ss.read(tmp_path / "b.log")


def test_every_tableau_is_in_the_tuple():
    left = [name for name, made in vars(tableaux).items() if isinstance(made, tableaux.Tableau) and made not in TABLEAUX.values()]
    assert not left, f"{', '.join(left)}: add to TABLEAUX at the end of src/stickslip/engine/tableaux.py"


@each_row("name", TABLEAUX)
def test_a_tableau_is_a_method(name):
    made = TABLEAUX[name]
    n = made.stages
    assert name in set(METHODS), f"add {name} to src/stickslip/solvers/methods.py"
    assert [len(row) for row in made.a] == [len(row) for row in made.C] == list(range(n)), (
        f"{name}: a and C have a row for each stage, of 0, 1, 2, ..."
    )
    assert len(made.d) == n, f"{name}: c and d have a number for each stage"
    dense = [len(row) for row in made.dense]
    assert dense == [n] * (made.dense_order - 1), f"{name}: dense has dense_order - 1 rows with a number for each stage"
    assert made.source, f"{name}: say its source"


@each_row("name", COMMANDS)
def test_a_command_has_its_line_in_the_list_and_an_example(name):
    file = f"src/stickslip/show/cli/commands/{name.replace('-', '_')}.py"
    assert summary_line(name), f'begin {file} with a docstring: """``stickslip {name}``: what it does."""'
    typed = [line.split()[:2] for line, _ in commands_in(declaration(name).example)]
    assert ["stickslip", name] in typed, f"{file}: give the command example=, of which one line is $ stickslip {name} ..."


@each_row("name", VARIABLES)
def test_a_column_has_a_unit_and_words(name):
    told = VARIABLES[name]
    assert told.name == name and told.long_name and told.symbol, f"{name}: say its symbol and what it is in variables.py"


def empty_columns(grid):
    return [name for name, column in grid.data_vars.items() if column.dtype.kind == "f" and np.isnan(column.values).all()]


def test_a_column_is_found_by_somebody():
    """What `variables.py` declares is computed: a robot that is all known leaves no column of its sweep empty."""
    left = [name for name in empty_columns(ss.sweep(ss.presets.piezo_rig, **RIG)) if name != "settling_error"]
    tell([f"{name}: a robot has nothing in this column; {OF_ONE_BODY}, {OR_SEVERAL}" for name in left])


def test_a_column_that_only_one_body_has_is_not_one_of_a_chain():
    left = empty_columns(ss.sweep(ss.Chain.example(), **{"phases.1": [0.5]}, periods=12))
    tell([f"{name}: a chain has nothing in this column; {OF_SEVERAL_BODIES}, {OR_ONE}" for name in left if name != "settling_error"])


def test_what_is_said_of_columns_is_said_of_columns_that_are():
    left = sorted({*solving.OF_ONE, *OF_SEVERAL} - set(COLUMNS))
    assert not left, f"{', '.join(left)}: in OF_ONE or OF_SEVERAL, and no column; add a line to src/stickslip/basics/variables.py"


def test_a_column_that_is_computed_is_declared(monkeypatch):
    computed = set()

    def spied(found, *more):
        computed.update(found)
        return with_missing_cases(found, *more)

    monkeypatch.setattr(solving, "with_missing_cases", spied)
    ss.sweep(ss.presets.piezo_rig, **RIG)
    left = sorted(name for name in computed if name not in COLUMNS and not name.startswith(END))
    assert computed and not left, f"{', '.join(left)}: add a line to src/stickslip/basics/variables.py"


@dataclass(frozen=True, eq=False)
class Stranger:
    """A law that was written beside the base class."""

    def sliding(self, v, load):
        return 0.2 * load


Stranger.__module__ = "stickslip.models.friction.stranger"


def test_a_law_without_the_base_class_is_found_in_its_folder(monkeypatch):
    module = types.ModuleType(Stranger.__module__)
    module.Stranger = Stranger
    monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setattr(pkgutil, "iter_modules", lambda path: [pkgutil.ModuleInfo(None, "stranger", False)])
    (told,) = unregistered(FOLDERS[0])
    assert told.startswith(
        "Stranger in src/stickslip/models/friction/stranger.py: write from stickslip.models.friction.law import Law, and class "
    )
    assert "class Stranger(Law); add it to _ALL in src/stickslip/models/friction/__init__.py" in told


def test_a_drive_without_words_is_told_where_to_write_them():
    (told,) = wordless(type("Waves", (), {}), "docs/drives")
    assert "Waves: no page of docs/drives describes it; write a paragraph with `Waves` in it" in told and "phases.md" in told
    assert "Sine" not in prose("# Sine\n\n| `Sine` |\n\n```python\nSine()\n```\n\nA word.\n")


@dataclass(frozen=True, eq=False)
class Forgetful(ss.Viscous):
    """A law of which nearly everything was forgotten."""

    depth: float = field(kw_only=True)


def test_what_a_law_forgets_is_told_in_sentences_and_hides_no_other(monkeypatch):
    finished = set(examples(ss.friction.LAWS))
    monkeypatch.setitem(ss.friction.LAWS, "forgetful", Forgetful)
    told = "\n".join(law_lacks("forgetful"))
    said = "Forgetful.depth has no label, unit, example; type depth: float", "example() gives no Forgetful", "bench_laws.py forgetful draws"
    assert all(words in told for words in (*said, "docs/laws", "__all__")), told
    assert set(examples(ss.friction.LAWS)) == finished <= set(LAWS)
    assert set(told.splitlines()) <= set(all_that_is_forgotten())


def test_a_law_in_the_registry_without_the_base_class_is_told_what_to_write(monkeypatch):
    monkeypatch.setitem(ss.friction.LAWS, "stranger", Stranger)
    assert "Stranger: write from stickslip.models.friction.law import Law, and class Stranger(Law)" in law_lacks("stranger")


@each_row("cls", [type("Odd", (), {}), type("Odd", (ss.Viscous,), {}), dataclass(frozen=True)(type("Odd", (ss.Viscous,), {}))])
def test_a_class_that_is_no_dataclass_as_ours_is_told_what_to_write(cls):
    """A class on one of ours is a dataclass without being declared as one, and its own fields are none."""
    assert lacking("odd", cls, ()) == ["Odd: write @dataclass(frozen=True, eq=False) above the class"]


def test_a_set_valued_law_that_does_not_slide_is_told_what_to_write(monkeypatch):
    half = dataclass(frozen=True, eq=False)(type("Half", (Law,), {"breakaway": lambda self, load: (-load, load)}))
    monkeypatch.setitem(ss.friction.LAWS, "half", half)
    told = law_lacks("half")
    assert "Half: write its method or property sliding" in told and not [line for line in told if "rate" in line.split()]


@each_row("error", [AttributeError("no dutty", name="dutty"), ModuleNotFoundError("no stickslip.dutty", name="stickslip.dutty")])
def test_a_public_name_that_is_not_where_the_stub_has_it_from_is_told_with_the_stub(error, monkeypatch):
    def nowhere(name):
        raise error

    monkeypatch.setattr(ss, "_load", nowhere)
    with pytest.raises(type(error)) as raised:
        ss.__getattr__("solve")
    assert any("src/stickslip/__init__.pyi" in note for note in raised.value.__notes__)


def test_an_import_that_fails_in_a_file_of_ours_is_told_with_that_file(request):
    unreadable = request.config.pluginmanager.get_plugin(str(ROOT / "conftest.py")).unreadable
    imported = "tests/x.py:1: in <module>\nsrc/stickslip/analysis/duty.py:10: in <module>\nE   ImportError: cannot import name 'motionn'"
    assert unreadable(imported) == "src/stickslip/analysis/duty.py, line 10: ImportError: cannot import name 'motionn'"
    spelt = 'tests/x.py:1: in <module>\nE     File "/home/src/stickslip/a.py", line 3\nE       def\nE   SyntaxError: invalid syntax'
    assert unreadable(spelt) == "src/stickslip/a.py, line 3: SyntaxError: invalid syntax"
    assert unreadable("src/stickslip/a.py:3: in f\nE   TypeError: no") is None
