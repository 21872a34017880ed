"""Connections: one without a request that was let in is a stranger's. Strangers are few, have little time, and the oldest goes first.

So half-sent requests, however many, keep nobody out: who sends a whole request with the token is let in, and counts elsewhere, by address.
On the loopback all addresses are one; there the token tells its user's pages from other users' connections.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from stickslip.explorer.client_limits import Limits

Client = tuple[str, int]


class Connections:
    """Who is connected: strangers, and how much each address holds of the server.

    Parameters
    ----------
    limits : Limits
    """

    def __init__(self, limits: Limits):
        self._limits = limits
        self._strangers: dict[Client, asyncio.Transport] = {}  # the oldest first
        self._timers: dict[Client, asyncio.TimerHandle] = {}
        self._held: Counter[str] = Counter()

    def wait(self, client: Client | None, transport: asyncio.Transport) -> None:
        """A connection from which a request may come: it has little time for it."""
        if client is None:
            return
        self.forget(client)
        self._strangers[client] = transport
        self._set(client, transport, self._limits.headers)
        if len(self._strangers) > self._limits.strangers:
            self._drop_one()

    def admit(self, client: Client | None, http: bool) -> bool:
        """Let a request in, if its address does not hold too much already; `release` follows."""
        if client is None:
            return True
        if self._held[client[0]] >= self._limits.each:
            return False
        self._held[client[0]] += 1
        transport = self._strangers.get(client)
        self.forget(client)
        if http and transport is not None:  # a page of its own has other limits
            self._set(client, transport, self._limits.request)
        return True

    def release(self, client: Client | None) -> None:
        """A request was answered, or a page has gone."""
        if client is None:
            return
        self._held[client[0]] -= 1
        if not self._held[client[0]]:
            del self._held[client[0]]

    def forget(self, client: Client | None) -> None:
        """A connection is lost, or no stranger's any more."""
        if client is not None:
            self._strangers.pop(client, None)
            if (timer := self._timers.pop(client, None)) is not None:
                timer.cancel()

    def _set(self, client: Client, transport: asyncio.Transport, seconds: float) -> None:
        self._timers[client] = asyncio.get_running_loop().call_later(seconds, self._drop, client, transport)

    def _drop(self, client: Client, transport: asyncio.Transport) -> None:
        self.forget(client)
        transport.abort()

    def _drop_one(self) -> None:
        """Of the address with most strangers the oldest goes."""
        crowd = Counter(host for host, _ in self._strangers).most_common(1)[0][0]
        oldest = next(client for client in self._strangers if client[0] == crowd)
        self._drop(oldest, self._strangers[oldest])


class Watched(H11Protocol):
    """One connection, which tells where it stands."""

    def __init__(self, connections: Connections, *arguments: Any, **more: Any):
        super().__init__(*arguments, **more)
        self._watch = connections

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """It begins."""
        super().connection_made(transport)
        self._watch.wait(self.client, transport)

    def connection_lost(self, exc: Exception | None) -> None:
        """It ends."""
        self._watch.forget(self.client)
        super().connection_lost(exc)

    def on_response_complete(self) -> None:
        """A request was answered: the next may come."""
        if not self.transport.is_closing():
            self._watch.wait(self.client, self.transport)
        super().on_response_complete()
