"""``stickslip resume``: continue a study that was interrupted."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, as_path, is_one_of
from stickslip.show.cli.declaring import CODE, argument, command

if TYPE_CHECKING:
    from argparse import Namespace


_BEGINS = ("sweep", "map", "atlas")
#: Options that may differ between runs of a study or, like permission to run code, must not come from its folder.
_OWN = ("--resume", "--json", "--allow-code"), ("--out", "--shard", "--dask", "--executor")


@command(
    about="Continue a study that was interrupted.",
    more="""\
FOLDER is the study folder that `stickslip sweep ... --out FOLDER` or `stickslip map ... --out FOLDER` began. What was typed then
is kept there and goes on. NAME=VALUE and --options behind it are added: workers=2, --figure types.png (of a map), --shard 2/7.
A study of Python code of yours (file.py:function, or a study file with `make`) needs --allow-code again: look at
FOLDER/command.json first, if somebody sent it.""",
    open_ended=True,
    arguments=(
        *CODE,
        argument("folder", metavar="FOLDER", help="the study folder"),
        argument("more", metavar="NAME=VALUE | --option", nargs="*", help="arguments and options to add"),
    ),
    example="""\
$ stickslip sweep coulomb_robot alpha_plus=0.4,0.5,0.6,0.7 alpha_minus=0.9 --tile 2 --out study --shard 1/2
…
coulomb_robot: 4 cases: 2 settled, 2 not computed; written to study
$ stickslip resume study
alpha_plus  mean velocity  type  pattern  period [drive periods]  margin
0.4         0.2915743      I     +0-0     1                       0.0236
0.5         0.1941414      I     +0-0     1                       0.0708
0.6         0.1181625      I     +0-0     1                       0.117
0.7         0.06152274     I     +0-0     1                       0.166
coulomb_robot: 4 cases: 4 settled; written to …
""",
)
def act(asked: Namespace) -> int:
    """Do the command."""
    folder = as_path(asked.folder, "resume", "study").resolve()
    begun, added = _begun(folder), [*asked.words]
    added.remove(asked.folder)
    _check_code(begun, added, folder)
    from stickslip.show.cli import done

    typed = [*(word for word in begun["words"] if word not in _OWN[0]), *added, "--out", str(folder), "--resume"]
    with contextlib.chdir(begun["folder"]) if Path(begun["folder"]).is_dir() else contextlib.nullcontext():
        return done(begun["command"], typed)


def _begun(folder: Path) -> dict[str, Any]:
    """The stored command that began the study in a folder."""
    from stickslip.studies.folder import COMMAND, read_manifest

    try:
        stored = json.loads((folder / COMMAND).read_text(encoding="utf-8"))
        if is_one_of(stored["command"], _BEGINS) and all(isinstance(word, str) for word in [*stored["words"], stored["folder"]]):
            return dict(stored)
        why = "is damaged"
    except FileNotFoundError:
        read_manifest(folder)  # reports errors of a folder that is not a study
        why = "is not there, so the study was begun in Python or by an earlier stickslip"
    except (OSError, ValueError, KeyError, TypeError) as error:
        why = f"cannot be read ({error})"
    raise InputError("resume", [f"{str(folder / COMMAND)!r} {why}; type what began the study again, with resume=True (--resume)"])


def _check_code(begun: dict[str, Any], added: list[str], folder: Path) -> None:
    """Raise an `InputError` if the stored command would run code without permission."""
    from stickslip.studies.folder import COMMAND

    named = next((word for word in begun["words"] if ":" in word and "=" not in word and not word.endswith(".toml")), None)
    if named is not None and "--allow-code" not in added:
        danger = f"{named!r} in {str(folder / COMMAND)!r} names Python code, which could do anything you can"
        raise InputError("resume", [f"{danger}; look at it, and if you trust it type --allow-code"])


@contextlib.contextmanager
def remembered(asked: Namespace, file: Path | None) -> Iterator[None]:
    """Store the command line in the study folder; if no study results, a new folder is removed again."""
    if not asked.out or file is not None:
        yield
        return
    from stickslip.studies.folder import COMMAND, MANIFEST

    folder = as_path(asked.out, asked.command, "study")
    new = not folder.exists()
    with contextlib.suppress(OSError):  # the study itself reports errors of the folder
        if new or not any(folder.iterdir()) or (folder / MANIFEST).exists():
            folder.mkdir(parents=True, exist_ok=True)
            _write(folder / COMMAND, asked.command, asked.words)
    try:
        yield
    finally:
        if not (folder / MANIFEST).exists():
            with contextlib.suppress(OSError):
                (folder / COMMAND).unlink()
                if new:
                    folder.rmdir()


def _write(path: Path, command: str, words: list[str]) -> None:
    """Store the command line, without the options that belong to one run; an existing file is kept."""
    from stickslip.studies.folder import put_file

    if path.exists():
        return
    flags, valued = _OWN
    kept, skip = [], False
    for word in words:
        if skip or word in flags or word.partition("=")[0] in valued:
            skip = not skip and word in valued
            continue
        kept.append(word)
    text = json.dumps({"command": command, "words": kept, "folder": os.getcwd()}, indent=1, ensure_ascii=False)
    put_file(path, f"{text}\n".encode(), new=True)
