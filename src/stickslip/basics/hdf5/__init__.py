"""Safe reading of HDF5 files of any origin: nothing outside the file is read, and no more than the file may unpack to."""

from stickslip.basics.hdf5.chunks import dataset_values
from stickslip.basics.hdf5.safe_files import address_of, checked_file, members, plain_attributes

__all__ = ["address_of", "checked_file", "dataset_values", "members", "plain_attributes"]
