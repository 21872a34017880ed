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
from every import every_machine
from house import ROOT
from kinds import LAWS
from registries import examples, lacking, text_of, unfinished, unregistered
from stickslip import drives, friction, machines, mechanisms, records
from stickslip.cli import COMMANDS
from stickslip.drives.drive import Drive
from stickslip.engine import tableaux
from stickslip.engine.tableaux import TABLEAUX
from stickslip.friction.law import Law
from stickslip.machines.parts import LINKS
from stickslip.mechanisms import MECHANISMS
from stickslip.mechanisms.mechanism import Mechanism
from stickslip.records import formats
from stickslip.records.raw import Column, Raw
from stickslip.solvers.methods import METHODS
from stickslip.storage import from_text
from stickslip.sweeps import solving
from stickslip.sweeps.result_columns import COLUMNS, END, filled
from stickslip.tracks import TRACKS
from stickslip.variables import VARIABLES

#: Records that are made of others, and never typed: in a registry they are not.
OF_OTHERS = {"ModalSum", "Shifted", "SlidingSum", "Sum", "Turned"}
OF_LAWS = ("docs/laws/index.md", "docs/laws/*.md")
OF_DRIVES = ("position", "velocity", "acceleration", "period", "stroke", "velocity_scale")


def needs_of(law):
    return ("sliding", "breakaway") if hasattr(law, "sliding") else ("rate", "force")


@pytest.mark.parametrize(
    ("package", "base", "registry", "line"),
    [
        (friction, Law, ss.LAWS, "LAWS, src/stickslip/friction/__init__.py"),
        (drives, Drive, ss.DRIVES, "DRIVES, src/stickslip/drives/__init__.py"),
        (machines, ss.Machine, MECHANISMS, "MECHANISMS, src/stickslip/mechanisms/__init__.py"),
        (mechanisms, Mechanism, MECHANISMS, "MECHANISMS, src/stickslip/mechanisms/__init__.py"),
    ],
)  # fmt: skip
def test_what_is_written_is_registered(package, base, registry, line):
    left = set(unregistered(package, base, registry)) - OF_OTHERS
    assert not left, f"{', '.join(sorted(left))}: add to {line}"


@pytest.mark.parametrize("folder", ["laws", "drives", "machines"])
def test_every_page_is_in_a_list_of_pages(folder):
    listed = text_of(f"docs/{folder}/index.md" if folder != "machines" else "docs/index.md")
    pages = [page.stem for page in (ROOT / "docs" / folder).glob("*.md") if page.stem != "index"]
    left = [name for name in pages if not re.search(rf"^({folder}/)?{name}$", listed, re.MULTILINE)]
    assert not left, f"{', '.join(left)}: add to the list of pages (toctree) of docs/{'' if folder == 'machines' else folder + '/'}index.md"


@pytest.mark.parametrize("name", ss.LAWS)
def test_a_law_has_what_its_recipe_names(name):
    assert not lacking(name, ss.LAWS[name], needs_of(ss.LAWS[name]), *OF_LAWS)


@pytest.mark.parametrize("name", ss.DRIVES)
def test_a_drive_has_what_its_recipe_names(name):
    assert not lacking(name, ss.DRIVES[name], OF_DRIVES, "docs/drives/index.md")


@pytest.mark.parametrize("name", TRACKS)
def test_a_track_has_what_its_recipe_names(name):
    kind = TRACKS[name]
    numbers = [f for f in kind.__dataclass_fields__.values() if "float" in str(f.type)]
    assert all({"label", "unit", "example"} <= set(f.metadata) for f in numbers), f"describe the numbers of {kind.__name__}"
    assert callable(kind.across) and callable(kind.along)


@pytest.mark.parametrize("name", LINKS)
def test_a_link_has_what_its_recipe_names(name):
    link = LINKS[name]
    moves = hasattr(link, "of_pair") or all(hasattr(link, need) for need in ("position", "velocity", "acceleration"))
    assert moves or hasattr(link, "force"), f"{link.__name__}: write force(distance, rate), or position, velocity and acceleration of t"
    assert not unfinished(link, "docs/your-own-machine.md")


@pytest.mark.parametrize("name", MECHANISMS)
def test_a_machine_has_what_its_recipe_names(name):
    made = MECHANISMS[name]
    assert name, f'{made.__name__}: say kind: ClassVar[str] = "...", its name in a study file'
    assert not unfinished(made, "docs/which-machine.md", "docs/machines/*.md" if issubclass(made, ss.Machine) else "docs/mechanisms.md")
    machine = next((machine for machine, *_ in every_machine.values() if isinstance(machine, made)), None)
    assert machine is not None, f"give every_machine in tests/every.py a {name}"
    assert type(from_text(machine.to_toml())) is made


@pytest.mark.parametrize("known", formats.FORMATS, ids=lambda known: known.names[0])
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
        "LOG", table=True, columns=[Column("t", "s", np.arange(9.0)), Column("v", "m/s", np.ones(9))]
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


@pytest.mark.parametrize("name", TABLEAUX)
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


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_has_its_example(name):
    assert (ROOT / "src" / "stickslip" / "cli" / "examples" / f"{name}.txt").exists(), f"write src/stickslip/cli/examples/{name}.txt"


@pytest.mark.parametrize("name", VARIABLES)
def test_a_column_has_a_unit_and_words(name):
    told = VARIABLES[name]
    assert told.name == name and told.long_name and told.symbol, f"{name}: say its symbol and what it is in variables.py"


def test_a_column_is_found_by_somebody():
    """What `variables.py` declares is computed: a robot that is all known leaves no column of its sweep empty."""
    grid = ss.sweep(ss.presets.piezo_rig, amplitude=[6e-4], tilt_deg=1.7, law="coulomb")
    empty = [name for name, column in grid.data_vars.items() if column.dtype.kind == "f" and np.isnan(column.values).all()]
    assert empty in ([], ["settling_error"]), f"{empty}: a robot has none of them; see the recipe of a column in CONTRIBUTING.md"


def test_a_column_that_is_computed_is_declared(monkeypatch):
    computed = set()

    def spied(found, *more):
        computed.update(found)
        return filled(found, *more)

    monkeypatch.setattr(solving, "filled", spied)
    ss.sweep(ss.presets.piezo_rig, amplitude=[6e-4], tilt_deg=1.7, law="coulomb")
    left = sorted(name for name in computed if name not in COLUMNS and not name.startswith(END))
    assert computed and not left, f"{', '.join(left)}: add a line to src/stickslip/variables.py"


@dataclass(frozen=True, eq=False)
class Forgetful(ss.Viscous):
    """A law of which nearly everything was forgotten."""

    depth: float = field(kw_only=True)


def test_what_a_law_forgets_is_told_in_sentences_and_hides_no_other(monkeypatch):
    finished = set(examples(ss.LAWS))
    monkeypatch.setitem(ss.LAWS, "forgetful", Forgetful)
    told = "\n".join(lacking("forgetful", Forgetful, needs_of(Forgetful), *OF_LAWS))
    said = "Forgetful.depth has no label, unit, example; type depth: float", "example() gives no Forgetful"
    assert all(words in told for words in (*said, "docs/laws", "docs/api.md", "__init__.pyi")), told
    assert set(examples(ss.LAWS)) == finished <= set(LAWS)


def test_a_class_that_is_no_dataclass_is_told_what_to_write():
    assert lacking("odd", type("Odd", (), {}), ()) == ["Odd: write @dataclass(frozen=True, eq=False) above the class"]
