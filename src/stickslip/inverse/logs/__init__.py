"""From a file to the numbers of a friction law: what the file holds, which machine it is of, the fits of laws, and their report.

`proposals` says of each channel, and of each number that is needed besides, what it is taken for, how that was decided, and how to
change it. `machines` has a class for each kind of machine that a file may be of: what it needs of a record, and how it is fitted by
`ss.identify`. `fitting` compares laws, and `log_fit` is the result, with the Python that does the same.
"""

from stickslip.inverse.logs.fitting import fit
from stickslip.inverse.logs.log_fit import LogFit

__all__ = ["LogFit", "fit"]
