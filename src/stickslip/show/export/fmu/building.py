"""The files of an FMU in one archive, with a library for this platform where there is a compiler."""

from __future__ import annotations

import io
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from stickslip.basics.errors import InputError
from stickslip.basics.whole_files import unwritable, write_whole

#: Exact steps need products and sums as they stand: nothing is contracted or reordered.
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-shared")
_SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("windows", ".dll")}
_MACHINES = {"amd64": "x86_64", "x86_64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64", "i386": "x86", "i686": "x86"}
_AT = (1980, 1, 1, 0, 0, 0)  # of all files in the archive, so that the same machine makes the same bytes
TEMPLATES = ("fmu.c", "state.c", "exchange.c", "absent.c", "fmi3.h")


def this_platform() -> tuple[str, str]:
    """The name that FMI 3 has for this platform, and the ending of its libraries."""
    system, ending = _SYSTEMS.get(sys.platform, (sys.platform, ".so"))
    machine = platform.machine().lower()
    return f"{_MACHINES.get(machine, machine)}-{system}", ending


def compiler() -> str | None:
    """A C compiler of this machine; None if there is none."""
    return next((path for name in ("gcc", "clang", "cc") if (path := shutil.which(name))), None)


def sources(machine_header: str) -> dict[str, str]:
    """All source files by name."""
    folder = Path(__file__).parent.parent / "templates" / "fmu"
    return {"machine.h": machine_header} | {name: (folder / name).read_text("utf-8") for name in TEMPLATES}


def library(files: dict[str, str], own: str, who: str) -> bytes:
    """The compiled library of some sources."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            write_whole(Path(folder) / name, text, unwritable("export_fmu"))
        made = Path(folder) / "library"
        done = subprocess.run([own, *FLAGS, "fmu.c", "-o", str(made), "-lm"], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            first = (done.stderr or done.stdout).strip().splitlines()
            raise InputError(who, [f"{own} does not compile the sources: {first[0] if first else 'it says nothing'}; type binary=False"])
        return made.read_bytes()


def archive(files: dict[str, str | bytes]) -> bytes:
    """Files as one archive, which is the same for the same files."""
    room = io.BytesIO()
    with zipfile.ZipFile(room, "w", zipfile.ZIP_DEFLATED) as written:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, _AT)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            written.writestr(entry, content)
    return room.getvalue()
