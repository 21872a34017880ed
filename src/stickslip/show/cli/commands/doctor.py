"""``stickslip doctor``: versions, the cache folder, and any problems."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.show.cli import show
from stickslip.show.cli.declaring import command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


_PACKAGES = ("numpy", "scipy", "llvmlite", "xarray", "h5netcdf", "h5py", "matplotlib")


@command(
    about="Show versions, the cache folder, and any problems.",
    example="""\
$ stickslip doctor
  stickslip     …
  python        …
  numpy         …
…
  cache folder  …
    writable    yes
…
all is in order
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    record = _findings()
    cache = record["cache"]
    rows = [(name, version or "not installed") for name, version in record["versions"].items()]
    rows += [("processors", str(record["processors"])), ("cache folder", cache["folder"])]
    rows += [("  writable", "yes" if cache["writable"] else "no"), ("  kernels", f"{cache['kernels']}, {cache['bytes'] / 1e6:.1f} MB")]
    problems = "\n".join(f"problem: {p}" for p in record["problems"]) or "all is in order"
    return Outcome(record, f"{show.facts(rows)}\n{problems}", code=1 if record["missing"] else 0)


def _findings() -> dict[str, Any]:
    from stickslip import __version__
    from stickslip.engine.cache import ENDING, folder

    versions = {"stickslip": __version__, "python": platform.python_version(), **{name: _version(name) for name in _PACKAGES}}
    directory = folder()
    compiled = [*directory.glob(f"*{ENDING}")] if directory.is_dir() else []
    writable = _can_write(directory)
    missing = [name for name, version in versions.items() if version is None]
    problems = [f"{name} is not installed; type pip install {name}" for name in missing]
    if not writable:
        problems.append(
            f"the cache folder {directory} cannot be written: every process compiles again; set STICKSLIP_CACHE_DIR to a folder of yours"
        )
    cache = {
        "folder": str(directory),
        "writable": writable,
        "kernels": len(compiled),
        "bytes": sum(path.stat().st_size for path in compiled),
    }
    return {
        "versions": versions,
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "cache": cache,
        "missing": missing,
        "problems": problems,
    }


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def _can_write(directory: Path) -> bool:
    """Whether a file can be created there or, if the folder does not exist, in its nearest existing parent."""
    try:
        with tempfile.TemporaryFile(dir=show.existing(directory)):
            return True
    except OSError:
        return False
