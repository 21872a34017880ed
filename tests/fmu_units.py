"""A unit of FMI 3 in this process, called as an importer calls it: the functions of its library, by name."""

from __future__ import annotations

import ctypes
import zipfile
from ctypes import byref, c_bool, c_char_p, c_double, c_int32, c_size_t, c_uint8, c_uint32, c_void_p
from xml.etree import ElementTree

_LOG = ctypes.CFUNCTYPE(None, c_void_p, ctypes.c_int, c_char_p, c_char_p)


class Unit:
    """One instance; `exchange` makes one of Model Exchange, `stops` one that returns early at events."""

    def __init__(self, path, folder, exchange=False, stops=False):
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
            (library,) = [name for name in archive.namelist() if name.startswith("binaries/")]
            if not (folder / library).exists():  # one that is loaded must stay as it is
                archive.extract(library, folder)
        self.variables = {each.get("name"): each for each in root.find("ModelVariables")}
        self.lib, self.told, token = ctypes.CDLL(str(folder / library)), [], root.get("instantiationToken").encode()
        self._log = _LOG(lambda _, status, category, message: self.told.append(message.decode()))
        kind = "ModelExchange" if exchange else "CoSimulation"
        make = getattr(self.lib, f"fmi3Instantiate{kind}")
        make.restype = c_void_p
        more = () if exchange else (stops, stops, None, 0)
        kinds = [c_char_p, c_char_p, c_char_p, c_bool, c_bool, *(() if exchange else (c_bool, c_bool, c_void_p, c_size_t)), c_void_p, _LOG]
        make.argtypes = kinds if exchange else [*kinds, c_void_p]
        self.instance = make(b"unit", token, None, False, False, *more, None, self._log, *(() if exchange else (None,)))
        assert self.instance, self.told
        self.t = 0.0
        self.exchange = exchange

    def call(self, name, *args, good=True):
        function = getattr(self.lib, f"fmi3{name}")
        status = function(c_void_p(self.instance), *args)
        assert (status == 0) is good, (name, status, self.told)

    def start(self, **states):
        self.call("EnterInitializationMode", c_bool(False), c_double(0.0), c_double(0.0), c_bool(False), c_double(0.0))
        for name, value in states.items():
            self.set(f"state.{name}", value)
        self.call("ExitInitializationMode")
        return self

    def _numbers(self, names):
        return (c_uint32 * len(names))(*(int(self.variables[name].get("valueReference")) for name in names)), len(names)

    def get(self, *names):
        whole = self.variables[names[0]].tag == "Int32"
        which, n = self._numbers(names)
        values = ((c_int32 if whole else c_double) * n)()
        self.call("GetInt32" if whole else "GetFloat64", which, c_size_t(n), values, c_size_t(n))
        return list(values)

    def set(self, name, value, good=True):
        which, n = self._numbers([name])
        self.call("SetFloat64", which, c_size_t(n), (c_double * 1)(value), c_size_t(1), good=good)

    def step(self, size):
        """A step; returns whether it has stopped at an event."""
        event, ends, early, last = c_bool(), c_bool(), c_bool(), c_double()
        given = (c_double(self.t), c_double(size), c_bool(True), byref(event), byref(ends), byref(early), byref(last))
        self.call("DoStep", *given)
        self.t = last.value
        assert not ends.value, self.told
        return early.value

    def save(self):
        state, size = c_void_p(), c_size_t()
        self.call("GetFMUState", byref(state))
        self.call("SerializedFMUStateSize", state, byref(size))
        room = (c_uint8 * size.value)()
        self.call("SerializeFMUState", state, room, size)
        self.call("FreeFMUState", byref(state))
        return bytes(room), self.t

    def restore(self, saved):
        data, self.t = saved
        state = c_void_p()
        self.call("DeserializeFMUState", (c_uint8 * len(data)).from_buffer_copy(data), c_size_t(len(data)), byref(state))
        self.call("SetFMUState", state)
        self.call("FreeFMUState", byref(state))

    def derivative(self, unknowns, known):
        """Derivatives of some numbers by one."""
        of, n = self._numbers(unknowns)
        by, _ = self._numbers([known])
        values = (c_double * n)()
        self.call("GetDirectionalDerivative", of, c_size_t(n), by, c_size_t(1), (c_double * 1)(1.0), c_size_t(1), values, c_size_t(n))
        return list(values)

    # ---- model exchange ----
    def many(self, name, count):
        values = (c_double * count)()
        self.call(name, values, c_size_t(count))
        return list(values)

    @property
    def states(self):
        return sum(name.startswith("state.") for name in self.variables)

    @property
    def indicators(self):
        return self.many("GetEventIndicators", sum(name.startswith("indicator[") for name in self.variables))

    def put(self, t, x):
        self.call("SetTime", c_double(t))
        self.call("SetContinuousStates", (c_double * len(x))(*x), c_size_t(len(x)))

    def rates(self, t, x):
        self.put(t, x)
        return self.many("GetContinuousStateDerivatives", len(x))

    def update(self):
        """Events at the present instant; the next known one, infinite if there is none."""
        flags, next_one = [c_bool() for _ in range(5)], c_double()
        self.call("UpdateDiscreteStates", *map(byref, flags), byref(next_one))
        return next_one.value if flags[4].value else float("inf")

    def close(self):
        self.lib.fmi3FreeInstance.argtypes = [c_void_p]
        self.lib.fmi3FreeInstance(self.instance)
