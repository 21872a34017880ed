"""Binary responses: four bytes with the length of the header, the header as JSON, then all arrays as float32, one after the other."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

from stickslip.basics.jsontext import strict


def encoded(header: Mapping[str, Any], arrays: Mapping[str, Any] | None = None) -> bytes:
    """The bytes of a response.

    Examples
    --------
    >>> header, arrays = unpacked(encoded({"id": 1}, {"v": [0.5, 2.0]}))
    >>> header["id"], arrays["v"].tolist()
    (1, [0.5, 2.0])
    """
    import numpy as np

    flat = {name: np.asarray(a, np.float32).ravel() for name, a in (arrays or {}).items()}
    complete = {**header, "arrays": [[name, a.size] for name, a in flat.items()]}
    as_it_is = strict(complete, other=lambda value: value)  # a value that strict JSON does not allow is our own error, and is reported
    text = json.dumps(as_it_is, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    head = text.encode("utf-8", "replace")  # a page may send an unpaired surrogate
    head += b" " * (-len(head) % 4)
    return b"".join([struct.pack("<I", len(head)), head, *(a.astype("<f4").tobytes() for a in flat.values())])


def unpacked(data: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    """Header and arrays of a response, as the page reads them."""
    import numpy as np

    (size,) = struct.unpack_from("<I", data)
    header = json.loads(data[4 : 4 + size])
    arrays, offset = {}, 4 + size
    for name, count in header["arrays"]:
        arrays[name] = np.frombuffer(data, "<f4", count, offset)
        offset += 4 * count
    return header, arrays
