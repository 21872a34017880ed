"""The process of `stickslip.records.apart`: ``python -m stickslip.records.apart_process``."""

from __future__ import annotations

import json
import os
from typing import Any

from stickslip.basics.child_process import serve
from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import VARIABLE, Allowance, bytes_in_words
from stickslip.records.apart import packed
from stickslip.records.formats import FORMATS


def _answer(wish: dict[str, Any], data: bytes) -> bytes:
    os.environ[VARIABLE] = wish["largest"]  # may have changed since this process began
    (known,) = (each for each in FORMATS if each.names[0] == wish["format"])
    allowance = Allowance("read", len(data))
    try:
        return packed(known.reader()(data, allowance))
    except InputError as error:
        problems = list(error.problems)
    except MemoryError:
        most = f"the {wish['format']} file unpacks to more than {bytes_in_words(allowance.limit)}"
        problems = [f"{most}; if it is to be trusted, set the environment variable {VARIABLE}, such as to 8e9 (bytes)"]
    return json.dumps({"problems": problems}).encode()


if __name__ == "__main__":
    serve(_answer)
