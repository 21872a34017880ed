"""Texts and heads of binary files that were found, or made, to break readers: each gives a record, or one sentence that says what to do."""

import json
import struct

import numpy as np

import stickslip as ss
from rows import each_row
from stickslip.records.reading import read_bytes

SIZE = 40_000


def filled(line, head=b""):
    return head + line * (SIZE // len(line))


def numbered(line, count=2000, head=b""):
    return head + b"".join(line(i) for i in range(count))


#: By signature: what is special about the bytes.
CORPUS = {
    # controls and encodings
    "a NUL in each line": numbered(lambda i: b"%d,%d\0\n" % (i, i % 7), head=b"t,v\n"),
    "a block of NULs where power failed": filled(b"1.5,2.5\n", b"t,v\n") + b"\0" * 300 + filled(b"1.5,2.5\n"),
    "NULs at the end": filled(b"1.5,2.5\n", b"t,v\n") + b"\0" * 4096,
    "NULs alone": b"\0" * SIZE,
    "UTF-8 and Latin-1 in turn": filled(b"1.5,2.5,\xc2\xb5m\n1.5,2.5,\xb5m\n", b"t,v,u\n"),
    "a Latin-1 letter in some numbers": filled(b"1.5,2.5\n" * 11 + b"1.5\xb5,2.5\n", b"t,v\n"),
    "UTF-16 without its mark": "t,v\n1,2\n".encode("utf-16-le") * 500,
    "UTF-16 cut within a letter": ("t,v\n" + "1,2\n" * 500).encode("utf-16")[:-1],
    "UTF-16 of half surrogates": b"\xff\xfe" + b"\x00\xd8" * 500,
    "a UTF-8 mark before Latin-1": b"\xef\xbb\xbf\xb5,v\n" + b"1,2\n" * 50,
    "overlong UTF-8": filled(b"\xc0\xaf,1\n"),
    "digits of other scripts": filled("١,٢\n".encode()),
    "form feeds and ends of file": filled(b"1,2\x0c\n3,4\x1a\n", b"t,v\n"),
    "separators of records": filled(b"1,2\x1e3,4\x1d\n", b"t,v\n"),
    "carriage returns alone": filled(b"1,2\r", b"t,v\r"),
    "line ends of three kinds": filled(b"1,2\r\n1,2\n1,2\r", b"t,v\n"),
    # quotes
    "quotes opened in all lines": filled(b'"1,2\n', b"t,v\n"),
    "quotes opened in some lines": filled(b"1,2\n" * 12 + b'"1,2\n', b"t,v\n"),
    "doubled quotes": filled(b'""1"",""2""\n', b"t,v\n"),
    "quotes doubled in words": filled(b'1,2,"a ""b"" c"\n', b"t,v,s\n"),
    "separators within quotes": filled(b'1,"2,3",4\n', b"t,s,v\n"),
    "line ends within quotes": filled(b'1,"a\nb",2\n', b"t,s,v\n"),
    # shapes
    "lines of two bytes": filled(b"1\n"),
    "empty lines between rows": filled(b"1,2\n\n\n\n\n\n\n", b"t,v\n"),
    "empty lines alone": filled(b"\n", b"1,2\n2,3\n"),
    "short and long rows": numbered(lambda i: b"1," * (i % 9) + b"2\n"),
    "a triangle": numbered(lambda i: b"1;" * i + b"2\n", 250),
    "trailing separators": filled(b"1,2,\n", b"t,v\n"),
    "missing cells": filled(b"1,2\n3,\n", b"t,v\n"),
    "words for what is missing": filled(b"1,null\n2,N/A\n3,7\n", b"t,v\n"),
    "two tables": filled(b"1,2\n", b"t,v\n") + filled(b"1;2;3\n", b"a;b;c\n"),
    "a header again and again": filled(b"1,2\n" * 5 + b"t,v\n", b"t,v\n"),
    # numbers
    "exponents without numbers": filled(b"e5,1e\n", b"t,v\n"),
    "exponents beyond doubles": filled(b"1e999,1e-999\n", b"t,v\n"),
    "exponents of Fortran": filled(b"1.5D+00,2.5d-3\n", b"t,v\n"),
    "several points": filled(b"1.2.3,4.5.6\n", b"t,v\n"),
    "signs within numbers": filled(b"1-2,3+4\n", b"t,v\n"),
    "hexadecimal": filled(b"0x1F,0x2E\n", b"t,v\n"),
    "formulas": filled(b"=1+2,@SUM(A1)\n", b"t,v\n"),
    # times
    "dates that name neither day nor month": filled(b"1/1/2026 1:00:00,1\n2/2/2026 1:00:00,1\n", b"t,v\n"),
    "dates that contradict each other": filled(b"13/1/2026 1:00:00,1\n1/13/2026 1:00:00,1\n", b"t,v\n"),
    "days that are none": filled(b"2026-02-31 25:61:61,1\n", b"t,v\n"),
    "times that go back": numbered(lambda i: b"%02d:00:00,1\n" % (23 - i % 24), head=b"t,v\n"),
    "a column of colons": filled(b":,:\n"),
    # JSON
    "JSON of names": b"{" + b",".join(b'"a%d":[1]' % i for i in range(6000)) + b"}",
    "JSON of names without lists": b"{" + b",".join(b'"a%d":1' % i for i in range(6000)) + b"}",
    "JSON of words": b'{"a":[' + filled(b'"x",') + b"1]}",
    "JSON of other names in each line": numbered(lambda i: b'{"a%d":1}\n' % i, 6000),
    "JSON lines and lists in turn": filled(b'{"a":1}\n[1]\n'),
    "JSON lines cut short": filled(b'{"t":1,"v":2}\n') + b'{"t":1,"v"',
    "JSON of NaN and Infinity": b'{"t":[0,1,2],"v":[NaN,Infinity,-Infinity]}',
    "JSON of one huge number": b'{"v":[1' + b"0" * 4000 + b"]}",
    "JSON with a name twice": b'{"v":[1,2],"v":[3,4]}',
    "JSON of half surrogates": json.dumps({"\ud800": [1.0, 2.0]}).encode(),
    # heads of binary formats over nothing
    "HDF5 of nothing": b"\x89HDF\r\n\x1a\n" + b"\xff" * 600,
    "netCDF of many records": b"CDF\x01" + struct.pack(">i", 2**31 - 1) + b"\0\0\0\x0a" + b"\xff" * 40,
    "MATLAB 4 of a huge matrix": struct.pack("<5i", 0, 2**30, 2**30, 0, 2) + b"x\0" + b"\0" * 60,
    "MATLAB 5 of nothing": b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\x01IM" + struct.pack("<2I", 15, 2**31),
    "TDMS of nothing": b"TDSm" + b"\xff" * 60,
    "a zip of nothing": b"PK\x03\x04" + b"\0" * 60,
    "a universal file of nothing": b"    -1\n    58b     1     2          11   99999999\n",
}


@each_row("name", CORPUS)
def test_a_strange_file_is_read_or_refused_with_one_sentence(name):
    try:
        record = read_bytes(CORPUS[name], "strange")
    except ss.InputError as error:
        said = str(error)
        assert said.startswith("read: ") and 20 < len(said) < 700 and "Traceback" not in said and "\n" not in said.strip()
    else:
        assert all(channel.values.dtype == np.float64 and channel.values.ndim == 1 for channel in map(record.__getitem__, record))
        assert record.notes  # damage is never read without a word
