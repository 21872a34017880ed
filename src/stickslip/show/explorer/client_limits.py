"""Limits on the use of the server by one client, or by an unidentified one: durations and numbers."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Times [s] and counts.

    Parameters
    ----------
    headers : float
        From the start of a connection to the end of the headers of an admitted request.
    silence, upload : float
        Between two parts of an upload, and for the whole of it.
    request : float
        For an admitted request, until its response has been received.
    reading : float
        For reading a record.
    first, idle : float
        Until the first message of a page, and between two messages.
    strangers : int
        Connections without an admitted request, in total.
    each : int
        Simultaneous requests and pages of one address.
    uploads : int
        Simultaneous uploads of one address.
    """

    headers: float = 10.0
    silence: float = 10.0
    upload: float = 120.0
    request: float = 300.0
    reading: float = 20.0
    first: float = 30.0
    idle: float = 1800.0
    strangers: int = 64
    each: int = 192
    uploads: int = 2


LIMITS = Limits()
