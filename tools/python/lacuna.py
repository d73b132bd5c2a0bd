# SPDX-License-Identifier: GPL-3.0-or-later
"""Lacuna from Python: runs a case through the shared library, gives the run as an xarray.Dataset.

    import lacuna
    run = lacuna.run("cases/vajont.yaml", {"friction.aging.dc": "4 cm"})
    run.slip_rate.plot(yscale="log")
    run.attrs["failure_time_s"]

    case = {"lacuna": 1, "load": {"normal": {"pressure": "3 MPa"}}, ...}
    lacuna.run(case)                     # a case that is in no file

The variables are those of a run's file (docs/format.md); what has one value is an attribute, its unit in
its name. Arrays are the library's memory, which is freed with the last of them. Errors are lacuna.Error. The
library is liblacuna.so beside this module's installation, else where the loader finds it, else what
LACUNA_LIBRARY names. Threads are OpenMP's: set OMP_NUM_THREADS=1 unless a run is large.
"""

import collections.abc
import ctypes
import glob
import json
import os
import signal
import threading

import numpy
import xarray

__all__ = ["Error", "run", "version"]

STATUS = ("ok", "out of memory", "input", "file", "numeric", "interrupted")
INTERRUPTED = 5
LIBRARY = "liblacuna.so.0.1"  # the interface that this module knows


class Error(Exception):
    """What the library refused or could not do, in its words.

    `kind` says which: "input" (the case: key, value and what is allowed), "file", "numeric" or
    "out of memory".
    """

    def __init__(self, status, message):
        super().__init__(message or STATUS[status])
        self.kind = STATUS[status]


class _Error(ctypes.Structure):
    _fields_ = [("message", ctypes.c_char * 1024)]


class _Override(ctypes.Structure):
    _fields_ = [("key", ctypes.c_char_p), ("value", ctypes.c_char_p)]


class _CaseOptions(ctypes.Structure):
    """The first of lac_case_options; its size tells the library that there are no more."""
    _fields_ = [("size", ctypes.c_size_t), ("purpose", ctypes.c_int), ("overrides", ctypes.POINTER(_Override)),
                ("count", ctypes.c_size_t)]


_INTERRUPTED = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p)


class _Options(ctypes.Structure):
    """The first of lac_simulation_options, likewise."""
    _fields_ = [("size", ctypes.c_size_t), ("interrupted", _INTERRUPTED), ("context", ctypes.c_void_p)]


def _library_path():
    """LACUNA_LIBRARY, or the library that was installed with this module, or the loader's."""
    if "LACUNA_LIBRARY" in os.environ:
        return os.environ["LACUNA_LIBRARY"]
    lib = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")
    beside = glob.glob(os.path.join(lib, LIBRARY)) + glob.glob(
        os.path.join(lib, "*-linux-*", LIBRARY))
    return beside[0] if beside else LIBRARY


def _open():
    path = _library_path()
    try:
        library = ctypes.CDLL(path)
    except OSError as wrong:
        raise ImportError(f"no library of Lacuna: {wrong}; LACUNA_LIBRARY names it", path=path) from wrong
    if not hasattr(library, "lac_simulation_record"):
        raise ImportError(f"{path}: not the library that this module is of", path=path)
    library.gsl_set_error_handler_off()  # GSL's own would end the process
    library.lac_version.restype = ctypes.c_char_p
    void, text, size, handle = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t, ctypes.POINTER(ctypes.c_void_p)
    how, error = ctypes.POINTER(_CaseOptions), ctypes.POINTER(_Error)
    for name, gives, takes in (
            ("case_load", ctypes.c_int, (text, how, handle, error)),
            ("case_parse", ctypes.c_int, (text, text, size, how, handle, error)),
            ("simulation_create", ctypes.c_int, (void, ctypes.POINTER(_Options), handle, error)),
            ("simulation_record", ctypes.c_int, (void, handle, error)),
            ("dataset_name", text, (void, size)),
            ("dataset_unit", text, (void, text)),
            ("dataset_long_name", text, (void, text)),
            ("dataset_dim", text, (void, text, size, ctypes.POINTER(size))),
            ("dataset_count", size, (void, text)),
            ("dataset_array", void, (void, text)),
            ("case_free", None, (void,)), ("simulation_free", None, (void,)), ("dataset_free", None, (void,))):
        function = getattr(library, "lac_" + name)
        function.restype, function.argtypes = gives, takes
    return library


_library = _open()
_one_at_a_time = threading.Lock()  # UDUNITS and netCDF, which read a case, bear one thread


def version():
    """Version of the library in use."""
    return _library.lac_version().decode()


class _Stop:
    """Lets Ctrl-C end a run after its step: Python sees signals only while the callback runs."""

    def __init__(self):
        self.asked = False
        self.callback = _INTERRUPTED(lambda _context: self.asked)
        self.request = _Options(ctypes.sizeof(_Options), self.callback, None)

    def on_signal(self, _number, _frame):
        self.asked = True

    def __enter__(self):
        # Other threads have no signals, nor may they say what becomes of them.
        self.main = threading.current_thread() is threading.main_thread()
        if self.main:
            self.before = signal.signal(signal.SIGINT, self.on_signal)
        return self

    def __exit__(self, *_):
        if self.main:
            signal.signal(signal.SIGINT, self.before)


class _Recording:
    """A dataset of the library; freed when nothing, no array either, refers to it any more."""

    def __init__(self):
        self.handle = ctypes.c_void_p()

    def __del__(self):
        _library.lac_dataset_free(self.handle)

    def variables(self):
        """Name, dimensions with their lengths, values and attributes of each variable."""
        index = 0
        while (name := _library.lac_dataset_name(self.handle, index)) is not None:
            dims, length = {}, ctypes.c_size_t()
            while dim := _library.lac_dataset_dim(self.handle, name, len(dims), ctypes.byref(length)):
                dims[dim.decode()] = length.value
            about = {"units": _library.lac_dataset_unit(self.handle, name).decode(),
                     "long_name": _library.lac_dataset_long_name(self.handle, name).decode()}
            yield name.decode(), dims, numpy.asarray(_Memory(self, name)), about
            index += 1


class _Memory:
    """Numbers of a recording, which it keeps, as numpy takes them without a copy."""

    def __init__(self, recording, name):
        self.recording = recording
        self.__array_interface__ = {
            "version": 3, "shape": (_library.lac_dataset_count(recording.handle, name),),
            "typestr": numpy.dtype(float).str, "data": (_library.lac_dataset_array(recording.handle, name), False)}


def _dataset(recording):
    """The Dataset of a recording, whose memory it keeps."""
    variables, attributes = {}, {}
    for name, dims, values, about in recording.variables():
        if dims:
            variables[name] = (list(dims), values.reshape(list(dims.values())), about)
        else:
            unit = about["units"]
            attributes[name + ("" if unit == "1" else "_" + unit.replace(" ", "_"))] = float(values[0])
    coordinates = [n for n in ("time", "snapshot_time", "x", "y", "block_size", "event_time")
                   if n in variables]
    return xarray.Dataset(variables, attrs=attributes).set_coords(coordinates)


def _text(value):
    """A value as YAML: texts as they are, so that "4 cm" is a quantity; the rest as JSON, which YAML contains."""
    return value if isinstance(value, str) else json.dumps(value, default=_plain)


def _plain(value):
    """What JSON does not know: numpy's numbers and arrays, paths."""
    if isinstance(value, (numpy.generic, numpy.ndarray)):
        return value.tolist()
    if isinstance(value, collections.abc.Mapping):
        return dict(value)
    return os.fspath(value)


def _read(case, sets, handle, error):
    """The library's status for a case as a path or as a mapping."""
    how = _CaseOptions(ctypes.sizeof(_CaseOptions), 0, (_Override * len(sets))(*sets), len(sets))
    if isinstance(case, collections.abc.Mapping):
        text = json.dumps(dict(case), indent=1, default=_plain).encode()
        return _library.lac_case_parse(b"case", text, len(text), how, handle, error)
    return _library.lac_case_load(os.fsencode(case), how, handle, error)


def _record(case, sets, stop, recording, error):
    """The library's status for a run."""
    read, simulation = ctypes.c_void_p(), ctypes.c_void_p()
    status = _read(case, sets, read, error)
    status = status or _library.lac_simulation_create(read, stop.request, simulation, error)
    status = status or _library.lac_simulation_record(simulation, recording.handle, error)
    _library.lac_simulation_free(simulation)
    _library.lac_case_free(read)
    return status


def run(case, overrides=None):
    """Runs a case to its end or to failure.

    case       path of a case file; or the case itself as a mapping, whose relative paths are looked
               for in the current folder
    overrides  {"key.path": value}, as --set key.path=value: text with a unit, numbers in SI, lists,
               mappings, True and False
    Returns an xarray.Dataset whose attributes are what the run came to: "failed", "failure_time_s", "steps" ...
    Raises Error for what the library refuses, TypeError for what is no case, ValueError for a null byte in a
    text, and KeyboardInterrupt after Ctrl-C. Threads that call it at once wait for each other.

    >>> run("cases/block.yaml", {"friction.aging.dc": "4 cm"}).slip_rate.max()
    """
    sets = [(os.fsencode(key), os.fsencode(_text(value))) for key, value in (overrides or {}).items()]
    path = [] if isinstance(case, collections.abc.Mapping) else [os.fsencode(case)]
    if any(b"\0" in word for word in (*path, *sum(sets, ()))):
        raise ValueError("embedded null byte")
    recording, error = _Recording(), _Error()
    with _one_at_a_time, _Stop() as stop:
        status = _record(case, sets, stop, recording, error)
    if status == INTERRUPTED:
        raise KeyboardInterrupt
    if status != 0:
        raise Error(status, error.message.decode(errors="replace"))
    return _dataset(recording)
