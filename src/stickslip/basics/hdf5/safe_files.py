"""HDF5 files from anywhere: everything that is read lies within the file, and is no more than the file may unpack to.

HDF5 lets a dataset lie in any other file (external storage, virtual datasets, external links) and lets a few bytes stand for any number
of them (fill values, packed chunks). So a file is looked through once before anything in it is read.
"""

from __future__ import annotations

import contextlib
import io
import math
import mmap
import os
from collections.abc import Iterator
from typing import Any

from stickslip.basics.errors import InputError
from stickslip.basics.hdf5.chunks import KNOWN, check_chunks
from stickslip.basics.hdf5.heaps import check_heaps
from stickslip.basics.unpacking import Allowance

_UNPACK, _REPACK = "export the record with its numbers in the file itself", "type h5repack -f GZIP=4 old.h5 new.h5"


@contextlib.contextmanager
def checked_file(source: Any, doing: str, allowance: Allowance, *, for_others: bool = False) -> Iterator[Any]:
    """An HDF5 file, open for reading, of which everything was looked through.

    Parameters
    ----------
    source : path or file object
    doing : str
        What is being done, for the errors.
    allowance : Allowance
        What the file may unpack to.
    for_others : bool
        Whether chunks will be unpacked by the HDF5 library, which trusts them, and not by `values`: each is unpacked once before.
    """
    import h5py

    _check_bytes(source)
    with h5py.File(source, "r") as file:
        _check(file, doing, allowance, for_others)
        yield file


def _check_bytes(source: Any) -> None:
    """Checks that the library does not make itself."""
    if isinstance(source, io.BytesIO):
        check_heaps(source.getvalue())
    elif os.path.getsize(source):
        with open(source, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            check_heaps(data)


def _check(file: Any, doing: str, allowance: Allowance, for_others: bool) -> None:
    """Refuse a file with data elsewhere, or with more than it may unpack to."""
    import h5py

    visited, waiting, size, chunked = set(), [("", file)], 0, []
    while waiting:
        prefix, group = waiting.pop()
        for name, item in members(group, doing):
            if isinstance(item, h5py.Dataset):
                size += _checked_size(item.id, f"{prefix}{name}", doing, allowance)
                chunked += [item.id] if for_others and item.chunks else []
            elif isinstance(item, h5py.Group) and (address := address_of(item)) not in visited:
                visited.add(address)
                waiting.append((f"{prefix}{name}/", item))
    allowance.take(size, "what it declares")
    for dataset in chunked:
        check_chunks(dataset)


def address_of(item: Any) -> int:
    """Where in its file an object lies: it is the same one under all its names."""
    import h5py

    return int(h5py.h5o.get_info(item.id).addr)


def members(group: Any, doing: str) -> Iterator[tuple[str, Any]]:
    """Names and objects of a group; None for a soft link, a second name that is not followed. A link to another file is refused."""
    import h5py

    for name in group:
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise InputError(doing, [f"{name!r} of the file is a link to another file, which is not followed; {_UNPACK}"])
        yield name, group.get(name) if isinstance(link, h5py.HardLink) else None


def plain_attributes(item: Any, allowance: Allowance, size: int) -> dict[str, Any]:
    """The attributes of an object that are numbers or texts, and no more than a file of this size may unpack to.

    The library trusts the lengths in those of other types.
    """
    import h5py

    values = {}
    for name in item.attrs:
        one = item.attrs.get_id(name)
        kind, count = one.get_type(), math.prod(one.shape or ())
        if kind.get_class() in (h5py.h5t.INTEGER, h5py.h5t.FLOAT):
            each = kind.get_size()
        elif kind.get_class() == h5py.h5t.STRING:
            each = size if kind.is_variable_str() else kind.get_size()  # of varying length: each may be as long as the file
        else:
            continue
        if count * each <= allowance.limit:
            values[name] = item.attrs[name]
    return values


def _checked_size(dataset: Any, name: str, doing: str, allowance: Allowance) -> int:
    """The bytes that a dataset declares, as numbers of eight; refuse one whose numbers lie elsewhere, or that hides more."""
    import h5py

    made = dataset.get_create_plist()
    layout = made.get_layout()
    if layout == h5py.h5d.VIRTUAL:
        raise InputError(doing, [f"{name!r} is a virtual dataset: its numbers lie in other datasets, which are not followed; {_UNPACK}"])
    if layout == h5py.h5d.CONTIGUOUS and made.get_external_count():
        raise InputError(doing, [f"the numbers of {name!r} lie in another file, which is not followed; {_UNPACK}"])
    if layout == h5py.h5d.CHUNKED:
        allowance.check(dataset.get_type().get_size() * math.prod(made.get_chunk()), f"a chunk of {name!r}")
        _check_filters(made, name, doing)
    return max(dataset.get_type().get_size(), 8) * math.prod(dataset.shape or ())


def _check_filters(made: Any, name: str, doing: str) -> None:
    """Refuse chunks packed in other ways than those that are unpacked here, or packed twice."""
    codes = [made.get_filter(i)[0] for i in range(made.get_nfilters())]
    for i, code in enumerate(codes):
        if code not in KNOWN or code in codes[:i]:
            what = made.get_filter(i)[3].decode("ascii", "replace")[:40] or f"filter {code}"
            raise InputError(doing, [f"{name!r} is packed by {what!r}; allowed are gzip, lzf and shuffle, each once; {_REPACK}"])
