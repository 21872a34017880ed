"""Errors, numbers with units, records of numbers, threads and files: what every other package stands on.

- `errors`, `arguments`, `constructors`: all problems of one input in one message, with what to type; `optional` names the extra
  that is missing.
- `units`, `quantities`, `typed_numbers`, `fields`: numbers with units, what a field of a record may hold, and frozen records of
  them.
- `contracts`: what a law, a drive, a track and a machine are asked for; `maths`: the functions that laws are written with.
- `variables`: names, symbols and units of all columns; `status`: how a case ended, as sentences.
- `pool`, `progress`, `one_thread`: threads, progress bars, interruption.
- `hdf5`, `unpacking`, `child_process`, `workbooks`, `jsontext`: foreign files, with limits; what may crash is done by a process of its own.
- `notebook_display`, `presenting`: results in a notebook, and who draws them.
"""
