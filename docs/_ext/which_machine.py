"""The table of the page on which machine goes through which door: made from what tests/properties/test_every_machine.py tries.

``python docs/_ext/which_machine.py`` tries every machine at every door and writes notes/which-machine.md anew; with names of machines
behind it, as they stand in tests/every.py, it tries these alone and keeps what the page says of the others.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

YES = "yes"
PAGE = Path(__file__).parents[2] / "notes" / "which-machine.md"
BEGIN, END = "<!-- the table begins -->", "<!-- the table ends -->"


def cell(door, case):
    """What becomes of a machine at a door: yes, or the first sentence of the reason, without the numbers given."""
    from stickslip.basics.errors import InputError

    try:
        door(case)
    except InputError as error:
        return short(error.problems[0])
    return YES


def short(problem):
    """The reason, up to what is allowed, without the name of the machine."""
    of_one = re.search(r"allowed is one body on one contact, as (.*?);", problem)
    if of_one:
        return f"it takes one body on one contact: {of_one[1]}"
    if "that of a flow" in problem:
        return "a run of a flow has states of its own, and no bodies and contacts"
    said = re.split(r"; (?:allowed|type|give|write|in Python|take)", problem, maxsplit=1)[0].replace("|", "/")
    said = re.sub(r"^'[^']*\.nc' ", "the file ", said)
    return re.sub(r"^([A-Z]\w+|<SwitchingFlow[^>]*>) (has|is|lists)", r"it \2", said)


def table(cells):
    """The cells as a Markdown table: doors down, machines across; reasons as numbered remarks below."""
    machines, doors = (list(dict.fromkeys(key[i] for key in cells)) for i in (0, 1))
    reasons = list(dict.fromkeys(said for door in doors for name in machines if (said := cells[name, door]) != YES))
    lines = ["| |" + "".join(f" {name} |" for name in machines), "|---|" + "---|" * len(machines)]
    for door in doors:
        row = [cells[name, door] for name in machines]
        lines.append(f"| `{door}` |" + "".join(f" {YES if said == YES else f'no ({reasons.index(said) + 1})'} |" for said in row))
    return "\n".join([*lines, "", *(f"{i}. {reason}." for i, reason in enumerate(reasons, start=1))])


def kept_table(text):
    """The cells back from the page."""
    body = text.partition(BEGIN)[2].partition(END)[0].strip()
    reasons = dict(re.findall(r"^(\d+)\. (.*)\.$", body, re.MULTILINE))
    head, _, *rows = [[part.strip() for part in line.split("|")[1:-1]] for line in body.splitlines() if line.startswith("|")]
    cells = {}
    for first, *row in rows:
        for name, said in zip(head[1:], row, strict=True):
            cells[name, first.strip("`")] = YES if said == YES else reasons[re.fullmatch(r"no \((\d+)\)", said)[1]]
    return cells


def unknown(names, machines):
    """A sentence for each name that is no machine of tests/every.py."""
    return [f"{name!r} is given{_allowed(name, machines)}" for name in names if name not in machines]


def _allowed(name, machines):
    from stickslip.basics.errors import did_you_mean

    near = did_you_mean(name, machines)
    if near.startswith("did"):
        return f"; {near}"
    return f", and every_machine in tests/every.py has no such machine; allowed are {', '.join(map(repr, machines))}"


def not_yes_or_no(name, door):
    """What to do where a machine neither works at a door nor is refused with a reason."""
    return (
        f"{name!r} at {door}: allowed is an answer, or an InputError that says why not. Is its line in every_machine in tests/every.py a "
        "machine that moves and slides in every period, by both values of its number? Then the error is in stickslip."
    )


def lacking(names, machines, doors, kept):
    """A sentence for each machine that is not to be tried, and of which the page does not say everything."""
    return [
        f"notes/which-machine.md lacks {name!r} at {_doors(left, doors)}; type its name too, or no name, which tries all"
        for name in machines
        if names and name not in names and (left := [door for door in doors if (name, door) not in kept])
    ]


def _doors(left, doors):
    return "every door" if len(left) == len(doors) else ", ".join(left)


def main(*names):
    """Write the table into the page: of some machines, or of all."""
    sys.path.insert(0, str(PAGE.parent.parent / "tests"))
    import matplotlib.pyplot as plt

    from every import Case, all_machines, door_of, every_door

    text = PAGE.read_text(encoding="utf-8")
    kept = kept_table(text)
    if wrong := unknown(names, all_machines) or lacking(names, all_machines, every_door, kept):
        raise SystemExit("\n".join(wrong))
    cells = {}
    for name, made in all_machines.items():
        if names and name not in names:
            cells |= {(name, door): kept[name, door] for door in every_door}
            continue
        with tempfile.TemporaryDirectory() as folder:
            case = Case(name, *made, Path(folder))
            for door in every_door:
                try:
                    cells[name, door] = cell(door_of(door, case), case)
                except Exception as error:
                    error.add_note(not_yes_or_no(name, door))
                    raise
                plt.close("all")
                print(f"{name}, {door}: {cells[name, door]}", flush=True)
    before, after = text.partition(BEGIN)[0], text.partition(END)[2]
    PAGE.write_text(f"{before}{BEGIN}\n\n{table(cells)}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
