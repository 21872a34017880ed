"""Files that a page sends: received within a time limit, and read in a separate process."""

from __future__ import annotations

import asyncio

from starlette.requests import ClientDisconnect, Request
from starlette.responses import PlainTextResponse, Response

from stickslip.show.explorer.dropped_records import MOST_BYTES
from stickslip.show.explorer.upload_reading import Reader

#: Time limits for receiving a record, and for reading it [s].
RECEIVING, READING = 120.0, 20.0


class Uploads:
    """The records that pages send, and the process that reads them."""

    def __init__(self) -> None:
        self._reader = Reader(READING)

    async def answer(self, request: Request, what: str) -> Response:
        """The response to a file: its "velocity" or its "drive", or the error."""
        try:
            async with asyncio.timeout(RECEIVING):
                data = await _whole(request)
        except ClientDisconnect:
            return PlainTextResponse("", 400)
        except TimeoutError:
            return PlainTextResponse("the file did not arrive in time; try again\n", 408, {"Connection": "close"})
        if data is None:
            return PlainTextResponse(f"the file is larger than {MOST_BYTES // 1_000_000} MB\n", 413, {"Connection": "close"})
        loop = asyncio.get_running_loop()
        answer = await loop.run_in_executor(None, self._reader.read, what, request.path_params["name"], data)
        return Response(answer, media_type="application/octet-stream")

    def close(self) -> None:
        """End the reading process."""
        self._reader.end()


async def _whole(request: Request) -> bytes | None:
    """The complete file, or None if it is too large."""
    data = bytearray()
    async for part in request.stream():
        data += part
        if len(data) > MOST_BYTES:
            return None
    return bytes(data)
