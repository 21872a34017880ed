"""Safe reading of HDF5 files of any origin: nothing outside the file is read, and no more than the file may unpack to."""

from stickslip.basics.hdf5.chunks import values
from stickslip.basics.hdf5.safe_files import attributes, members, opened, place_of

__all__ = ["attributes", "members", "opened", "place_of", "values"]
