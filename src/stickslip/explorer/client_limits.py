"""Limits on what one client, or an unidentified one, may use of the server: durations and numbers."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Times [s] and counts.

    Parameters
    ----------
    headers : float
        From the beginning of a connection to the end of the headers of a request that is let in.
    silence, upload : float
        Between two parts of an upload, and for the whole of it.
    request : float
        For a request that was let in, until its answer is taken.
    reading : float
        For reading a record.
    first, idle : float
        Until the first message of a page, and between two messages.
    strangers : int
        Connections without a request that was let in, all together.
    each : int
        Requests and pages at once of one address.
    uploads : int
        Uploads at once of one address.
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
