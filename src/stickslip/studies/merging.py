"""Merging the shards of a study."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.errors import InputError, Problems, as_path
from stickslip.studies.folder import MANIFEST, make_study_folder, put_file, read_manifest
from stickslip.studies.manifest import differences_between
from stickslip.studies.opening import open_study
from stickslip.studies.space_file import AXES, read_labels
from stickslip.studies.tiles import TILES, file_of, tile_is_good

if TYPE_CHECKING:
    import xarray as xr


@explains_arguments
def merge(folders: Sequence[str | Path], out: str | Path, partial: bool = False) -> xr.Dataset:
    """Merge the folders of the shards of one study into one, as if it had been a single run.

    Parameters
    ----------
    folders : list of paths
        Study folders; all must be of the same study: the same axes and options, and in every tile models with the same equations and
        numbers. Of folders that an earlier stickslip kept, the models are unchecked, and a note says so.
    out : path
        A new folder, or one of the same study.
    partial : bool
        Whether tiles may be missing. Otherwise missing tiles raise an error that names them, and `out` is not changed.

    Returns
    -------
    xarray.Dataset
        As `open_study` of the new folder.

    Examples
    --------
    >>> import stickslip as ss
    >>> axes = dict(amplitude=[3e-4, 4e-4, 5e-4, 6e-4], tilt_deg=1.7, law="coulomb", tile=1)
    >>> for i in (1, 2):
    ...     _ = ss.sweep(ss.presets.piezo_rig, **axes, out=f"part{i}", shard=(i, 2))
    >>> ss.studies.merge(["part1", "part2"], "whole").motion_type.values.tolist()
    ['II', 'I', 'I', 'III']
    """
    sources = [as_path(f, "merge", "grid-1") for f in folders]
    if not sources:
        raise InputError("merge", ["no folders are given; type merge([shard1, shard2], out)"])
    target = as_path(out, "merge", "grid")
    sources = [*sources, target] if (target / MANIFEST).exists() else sources
    manifest = _checked(sources)
    files = {k: file for k in range(manifest["tiles"]) if (file := _file_in(sources, k, manifest)) is not None}
    missing = [k for k in range(manifest["tiles"]) if k not in files]
    if missing and not partial:
        named = ", ".join(map(str, missing[:8])) + (", …" if len(missing) > 8 else "")
        what = f"{len(missing)} of {manifest['tiles']} tiles are in none of the folders (number {named})"
        raise InputError("merge", [f"{what}; finish the shards with --resume, or type partial=True (--partial)"])
    make_study_folder(target, TILES)
    for name in (AXES, MANIFEST):
        if not (target / name).exists():
            put_file(target / name, (sources[0] / name).read_bytes())
    for k, file in files.items():
        if file != file_of(target, k):
            put_file(file_of(target, k), file.read_bytes())
    return open_study(target)


def _file_in(folders: list[Path], k: int, manifest: dict[str, Any]) -> Path | None:
    """The last folder's undamaged file of tile k; None if there is none."""
    return next((file_of(folder, k) for folder in reversed(folders) if tile_is_good(folder, k, manifest)), None)


def _checked(folders: list[Path]) -> dict[str, Any]:
    """The common manifest of all folders."""
    problems, first = Problems("merge"), read_manifest(folders[0])
    for folder in folders[1:]:
        other = read_manifest(folder)
        if other["study"] != first["study"]:
            for reason in differences_between(first, other):
                problems.add(f"{str(folder)!r} is of another study than {str(folders[0])!r}: {reason}")
    problems.check()
    read_labels(folders[0], first)
    return first
