"""Sessions of pages: of each channel the newest request counts."""

from __future__ import annotations

import asyncio
import contextlib
import os
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from stickslip.basics.errors import InputError
from stickslip.show.explorer.first_picture import first_answer
from stickslip.show.explorer.frames import encoded, unpacked
from stickslip.show.explorer.kernels import Kernels
from stickslip.show.explorer.machines import Shown
from stickslip.show.explorer.requests import CHANNELS, Message, Stopped, message

#: Largest size of a message in bytes.
MESSAGE_BYTES = 32_768


class Workshop:
    """The computing threads: those of the curves wait for no map and no strip."""

    def __init__(self, kernels: Kernels, workers: int | None = None, shown: Shown | None = None):
        n = workers or max(2, min(os.cpu_count() or 2, 8))
        self.kernels, self.shown = kernels, shown
        self.pages: set[Session] = set()
        self._pools = {"curves": ThreadPoolExecutor(n, "curves"), "behind": ThreadPoolExecutor(max(n - 1, 1), "behind")}
        self.prepared = 0  # number of kernels that have become ready
        self._loop = asyncio.get_running_loop()
        kernels.listen(self._kernel_ready)

    async def compute(self, asked: Message, stop: threading.Event) -> bytes:
        """Compute the response to a request in a thread."""
        return await self._loop.run_in_executor(self._pool(asked), self._answer, asked, stop)

    async def compute_sooner(self, asked: Message, stop: threading.Event) -> bytes | None:
        """Compute in a thread what of the response takes the shortest time, if that is worth it."""
        return await self._loop.run_in_executor(self._pool(asked), self._sooner, asked, stop)

    def _pool(self, asked: Message) -> ThreadPoolExecutor:
        return self._pools["curves" if asked.channel == "curves" else "behind"]

    def _answer(self, asked: Message, stop: threading.Event) -> bytes:
        if stop.is_set():  # superseded while it waited for a thread
            raise Stopped
        if (data := first_answer(asked, self.kernels)) is not None:
            return data
        from stickslip.show.explorer.responses import answer  # with all solvers, for which no page waits

        return answer(asked, self.kernels, stop.is_set, self.shown)

    def _sooner(self, asked: Message, stop: threading.Event) -> bytes | None:
        if first_answer(asked, self.kernels) is not None:  # that is soon enough
            return None
        from stickslip.show.explorer.responses import sooner

        return sooner(asked, self.kernels, stop.is_set)

    def close(self) -> None:
        """Stop all work."""
        for page in self.pages:
            page.stop()
        for pool in self._pools.values():
            pool.shutdown(wait=False, cancel_futures=True)
        self.kernels.end()

    def _kernel_ready(self) -> None:
        with contextlib.suppress(RuntimeError):  # the event loop has ended
            self._loop.call_soon_threadsafe(self._ask_again)

    def _ask_again(self) -> None:
        self.prepared += 1
        for page in self.pages:
            page.ask_again()


@dataclass(eq=False)
class _Slot:
    """The state of one channel of a page: the newest request, and the event that stops the running computation."""

    newest: Message | None = None
    waiting: Message | None = None  # answered provisionally: its kernel was not ready
    wake: asyncio.Event = field(default_factory=asyncio.Event)
    stop: threading.Event = field(default_factory=threading.Event)

    def put(self, asked: Message) -> None:
        self.newest, self.waiting = asked, None
        self.stop.set()
        self.wake.set()


class Session:
    """One page: receives its requests and sends the responses."""

    def __init__(self, socket: WebSocket, workshop: Workshop):
        self._socket, self._workshop = socket, workshop
        self._slots = {channel: _Slot() for channel in CHANNELS}
        self._sending = asyncio.Lock()

    async def serve(self) -> None:
        """Serve the page until it closes."""
        await self._socket.accept()
        self._workshop.pages.add(self)
        tasks = [asyncio.create_task(self._answers(channel)) for channel in CHANNELS]
        try:
            await self._receive()
        except WebSocketDisconnect:
            pass
        finally:
            self._workshop.pages.discard(self)
            self.stop()
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    def stop(self) -> None:
        """Stop all computations, whose results are no longer needed."""
        for slot in self._slots.values():
            slot.stop.set()

    def ask_again(self) -> None:
        """Repeat the requests that waited for a kernel."""
        for slot in self._slots.values():
            if slot.waiting is not None:
                slot.put(slot.waiting)

    async def _receive(self) -> None:
        while (got := await self._socket.receive())["type"] != "websocket.disconnect":
            text = got.get("text") or got.get("bytes") or ""
            try:
                asked = message(text)
            except InputError as error:
                await self._send(encoded({"channel": None, "kind": "problems", "problems": error.problems, **_who(text)}))
                continue
            self._slots[asked.channel].put(asked)

    async def _answers(self, channel: str) -> None:
        slot = self._slots[channel]
        while True:
            await slot.wake.wait()
            asked, slot.stop = slot.newest, threading.Event()
            slot.wake.clear()
            assert asked is not None
            prepared = self._workshop.prepared
            await self._send_sooner(asked, slot.stop)
            data = await self._computed(asked, slot.stop)
            if data is None:
                continue
            if _waits(data) and slot.newest is asked:
                slot.waiting = asked
                if self._workshop.prepared != prepared:  # a kernel has become ready meanwhile: perhaps this one
                    slot.put(asked)
            await self._send(data)

    async def _send_sooner(self, asked: Message, stop: threading.Event) -> None:
        """A first part of a response that will take longer; its errors are those of the whole response."""
        with contextlib.suppress(Exception):
            if (data := await self._workshop.compute_sooner(asked, stop)) is not None:
                await self._send(data)

    async def _computed(self, asked: Message, stop: threading.Event) -> bytes | None:
        try:
            return await self._workshop.compute(asked, stop)
        except Stopped:
            return None
        except Exception as error:  # an internal error is reported, and the page stays usable
            sentence = f"{type(error).__name__}: {error}. This is an error of stickslip itself"
            return encoded({"channel": asked.channel, "id": asked.id, "kind": "problems", "problems": [sentence]})

    async def _send(self, data: bytes) -> None:
        async with self._sending:
            with contextlib.suppress(WebSocketDisconnect, RuntimeError):  # it was closed meanwhile
                await self._socket.send_bytes(data)


def _waits(data: bytes) -> bool:
    """Whether a response is still waiting for a kernel."""
    header, _ = unpacked(data)
    return "waits" in header or any("waits" in law for law in header.get("laws", ()))


def _who(text: str | bytes) -> dict[str, Any]:
    """Channel and number of an invalid request, as far as they can be read."""
    import json

    try:
        given = json.loads(text)
        return {name: given[name] for name in ("channel", "id") if isinstance(given.get(name), (str, int))}
    except (ValueError, AttributeError, RecursionError):
        return {}
