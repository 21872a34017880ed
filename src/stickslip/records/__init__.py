"""Measured records: read from files, with names, units and roles; what can be measured on them without any model."""

from stickslip.records.channel import Channel
from stickslip.records.reading import read
from stickslip.records.record import Record

__all__ = ["Channel", "Record", "read"]
