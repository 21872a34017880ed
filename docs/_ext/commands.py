"""The directive ``commands``: every command of ``stickslip`` with usage, options and an example, read from the parsers themselves."""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

_COMMON = ("--json", "--allow-code", "ROBOT", "NAME=VALUE")  # the page says once what they are


def arguments_of(parser) -> list[tuple[str, str]]:
    """Each argument as it is typed, and what it means."""
    rows = []
    for action in parser._actions:
        if action.help == "==SUPPRESS==" or {str(action.metavar), *action.option_strings} & {*_COMMON, "-h"}:
            continue
        names = ", ".join(action.option_strings)
        value = "" if action.nargs == 0 else str(action.metavar or action.dest)
        rows.append((" ".join(part for part in (names, value) if part), str(action.help or "")))
    return rows


class Commands(SphinxDirective):
    """A section for each command."""

    def run(self) -> list[nodes.Node]:
        """The sections."""
        from stickslip.show.cli import COMMANDS
        from stickslip.show.cli.arguments import parser
        from stickslip.show.cli.declaring import declaration

        return [section(name, parser(name), declaration(name).example) for name in COMMANDS]


def section(name: str, parser, example: str) -> nodes.section:
    """One command."""
    made = nodes.section(ids=[f"command-{name}"], names=[f"command-{name}"])
    made += nodes.title("", "", nodes.literal("", f"stickslip {name}"))
    made += nodes.paragraph("", parser.description)
    made += block(" ".join(parser.format_usage().removeprefix("usage: ").split()), "text")
    if rows := arguments_of(parser):
        made += table(rows)
    end = (parser.epilog or "").removesuffix(example.rstrip("\n")).strip("\n")
    if end:
        made += block(end, "text")
    if example:
        made += nodes.paragraph("", "For example:")
        made += block(example.rstrip("\n"), "console")
    return made


def block(text: str, language: str) -> nodes.literal_block:
    return nodes.literal_block(text, text, language=language)


def table(rows: list[tuple[str, str]]) -> nodes.definition_list:
    """Arguments with their meanings."""
    made = nodes.definition_list()
    for name, meaning in rows:
        term = nodes.term("", "", nodes.literal("", name))
        made += nodes.definition_list_item("", term, nodes.definition("", nodes.paragraph("", meaning)))
    return made


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
