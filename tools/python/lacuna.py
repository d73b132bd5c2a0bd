# SPDX-License-Identifier: GPL-3.0-or-later
"""Lacuna from Python: each command as a function that gives an xarray.Dataset.

    import lacuna
    run = lacuna.run("cases/vajont.yaml", {"friction.aging.dc": "4 cm"})
    run.slip_rate.plot(yscale="log")
    run.attrs["failure_time_s"]

    case = {"lacuna": 1, "load": {"normal": {"pressure": "3 MPa"}}, ...}
    lacuna.run(case)                     # a case that is in no file

Variables and attributes are those of the command's file (docs/format.md), decoded as xarray does where it opens one: the
library tells them, this module knows none by name. No such file is written. Arrays are the library's memory where it holds
them, which is freed with the last of them. `run`, `contact`, `rg` of a case, `precursors` and `fit` are computed in this
process; `check`, `describe`, `trade` and `sweep`, whose pool of processes and tables they need, and options that the
library does not have, ask the program `lacuna`, which hands its dataset over through a pipe. `command` gives what any
command of the program says as a dict.

Errors are lacuna.Error, and KeyboardInterrupt after Ctrl-C. Threads that call at once wait for each other; for many runs
take processes, begun by either of

    with concurrent.futures.ProcessPoolExecutor(mp_context=multiprocessing.get_context("spawn")) as pool:
        runs = list(pool.map(lacuna.run, cases))

or "fork", which must not come after a large run in threads of this process. The library is liblacuna.so beside this module's
installation, else where the loader finds it, else what LACUNA_LIBRARY names; the program likewise, or LACUNA_PROGRAM.
`pip install lacuna-*.whl` brings both. Threads are OpenMP's: set OMP_NUM_THREADS=1 unless a run is large.
"""

from __future__ import annotations

import collections.abc
import ctypes
import glob
import io
import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
from typing import Any, Iterable, Iterator, Mapping, Optional, Sequence, Union

import numpy
import xarray

__all__ = ["Error", "check", "command", "contact", "describe", "fit", "precursors", "rg", "run", "sweep", "trade",
           "version"]

Case = Union[str, "os.PathLike[str]", Mapping[str, Any]]
Sets = Optional[Mapping[str, Any]]

STATUS = ("ok", "out of memory", "input", "file", "numeric", "interrupted")
INTERRUPTED = 5
FOR_RUN, FOR_CONTACT, FOR_RG, FOR_FIT = range(4)  # lac_case_purpose
ATTRIBUTE = "attribute"  # the type of what is one of the whole
NETCDF = (b"CDF", b"\x89HDF")  # what a file begins with
LIBRARY = "liblacuna.so.0.2"  # the interface that this module knows


class Error(Exception):
    """What the library refused or could not do, in its words.

    `kind` says which: "input" (the case: key, value and what is allowed), "file", "numeric" or
    "out of memory". `dataset` holds what there is all the same: of a fit that has not converged; else None.
    """

    def __init__(self, status: int, message: str, dataset: Optional[xarray.Dataset] = None):
        super().__init__(message or STATUS[status])
        self.status, self.dataset = status, dataset
        self.kind = STATUS[status]

    def __reduce__(self):  # across processes
        return Error, (self.status, str(self), self.dataset)


class _Error(ctypes.Structure):
    _fields_ = [("message", ctypes.c_char * 1024)]


class _Override(ctypes.Structure):
    _fields_ = [("key", ctypes.c_char_p), ("value", ctypes.c_char_p)]


class _CaseOptions(ctypes.Structure):
    """The first of lac_case_options; its size tells the library that there are no more."""
    _fields_ = [("size", ctypes.c_size_t), ("purpose", ctypes.c_int), ("overrides", ctypes.POINTER(_Override)),
                ("count", ctypes.c_size_t)]


_STOP = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p)
_GO_ON = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
_TOLD = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_size_t,
                         ctypes.POINTER(ctypes.c_double), ctypes.c_bool)


class _Sized(ctypes.Structure):
    """Options begin with their size, which tells the library how many of them there are."""

    def __init__(self, *members: Any):
        super().__init__(ctypes.sizeof(type(self)), *members)


class _Options(_Sized):
    """The first of lac_simulation_options."""
    _fields_ = [("size", ctypes.c_size_t), ("interrupted", _STOP), ("context", ctypes.c_void_p)]


class _ContactOptions(_Sized):
    _fields_ = [("size", ctypes.c_size_t), ("quick", ctypes.c_bool), ("interrupted", _STOP), ("context", ctypes.c_void_p),
                ("boxes", ctypes.c_char_p), ("coarsest", ctypes.c_char_p), ("coarsening", ctypes.c_char_p),
                ("sizes", ctypes.c_char_p)]


class _FitOptions(_Sized):
    _fields_ = [("size", ctypes.c_size_t), ("interrupted", _STOP), ("context", ctypes.c_void_p),
                ("progress", ctypes.c_void_p), ("threads", ctypes.c_int)]


class _RgOptions(_Sized):
    _fields_ = [("size", ctypes.c_size_t), ("go_on", _GO_ON), ("context", ctypes.c_void_p)]


class _ForecastOptions(_Sized):
    _fields_ = [("size", ctypes.c_size_t), ("smoothing", ctypes.c_int), ("points", ctypes.c_size_t),
                ("order", ctypes.c_size_t), ("window", ctypes.c_double), ("raw", ctypes.c_bool),
                ("since", ctypes.c_double), ("until", ctypes.c_double), ("short_run", ctypes.c_size_t),
                ("long_run", ctypes.c_size_t), ("issues", ctypes.c_size_t), ("failed_at", ctypes.c_double),
                ("source", ctypes.c_void_p), ("threads", ctypes.c_int), ("go_on", _GO_ON),
                ("context", ctypes.c_void_p), ("levels", ctypes.c_char_p)]


class _SeriesDef(_Sized):
    """The first of lac_series_def."""
    _fields_ = [("size", ctypes.c_size_t)] + [(name, ctypes.c_char_p) for name in (
        "path", "time", "time_format", "displacement", "displacement_unit", "velocity", "velocity_unit")]


def _beside(*places: str) -> Optional[str]:
    """The first of these that was installed with this module."""
    lib = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")
    return next((found for place in places for found in glob.glob(os.path.join(lib, place))), None)


def _library_path() -> str:
    """LACUNA_LIBRARY, or the library beside this module (a wheel's), or installed with it, or the loader's."""
    here = os.path.join(os.path.dirname(os.path.realpath(__file__)), LIBRARY)
    return (os.environ.get("LACUNA_LIBRARY") or (here if os.path.exists(here) else None)
            or _beside(LIBRARY, os.path.join("*-linux-*", LIBRARY)) or LIBRARY)


def _open() -> ctypes.CDLL:
    path = _library_path()
    try:
        library = ctypes.CDLL(path)
    except OSError as wrong:
        raise ImportError(f"no library of Lacuna: {wrong}; LACUNA_LIBRARY names it", path=path) from wrong
    if not hasattr(library, "lac_dataset_tell"):
        raise ImportError(f"{path}: not the library that this module is of", path=path)
    library.gsl_set_error_handler_off()  # GSL's own would end the process
    library.lac_version.restype = ctypes.c_char_p
    void, text, size, handle = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t, ctypes.POINTER(ctypes.c_void_p)
    how, error, status = ctypes.POINTER(_CaseOptions), ctypes.POINTER(_Error), ctypes.c_int
    for name, gives, takes in (
            ("case_load", status, (text, how, handle, error)),
            ("case_parse", status, (text, text, size, how, handle, error)),
            ("simulation_create", status, (void, ctypes.POINTER(_Options), handle, error)),
            ("simulation_record", status, (void, handle, error)),
            ("contact_compute", status, (void, ctypes.POINTER(_ContactOptions), handle, error)),
            ("rg_compute", status, (void, ctypes.POINTER(_RgOptions), handle, error)),
            ("series_create", status, (ctypes.POINTER(_SeriesDef), handle, error)),
            ("forecast_compute", status, (void, ctypes.POINTER(_ForecastOptions), handle, error)),
            ("fit_series", status, (void, text, handle, error)),
            ("fit_compute", status, (void, void, ctypes.POINTER(_FitOptions), handle, error)),
            ("dataset_name", text, (void, size)),
            ("dataset_unit", text, (void, text)),
            ("dataset_dim", text, (void, text, size, ctypes.POINTER(size))),
            ("dataset_is_text", ctypes.c_bool, (void, text)),
            ("dataset_count", size, (void, text)),
            ("dataset_array", void, (void, text)),
            ("dataset_values", status, (void, text, size, void, error)),
            ("dataset_text", status, (void, text, size, text, size, error)),
            ("dataset_tell", status, (void, text, _TOLD, void, error)),
            ("case_free", None, (void,)), ("simulation_free", None, (void,)), ("dataset_free", None, (void,)),
            ("series_free", None, (void,))):
        function = getattr(library, "lac_" + name)
        function.restype, function.argtypes = gives, takes
    return library


_library = _open()
_one_at_a_time = threading.Lock()  # UDUNITS and netCDF, which read a case, bear one thread
if hasattr(os, "register_at_fork"):  # a child of a thread that holds it would wait for ever
    os.register_at_fork(before=_one_at_a_time.acquire, after_in_parent=_one_at_a_time.release,
                        after_in_child=_one_at_a_time.release)


def version() -> str:
    """Version of the library in use.

    >>> version().count(".")
    2
    """
    return _library.lac_version().decode()


__version__ = version()


class _Stop:
    """Lets Ctrl-C end what is computed after its step: Python sees signals only while the callback runs."""

    def __init__(self):
        self.asked = False
        self.callback = _STOP(lambda _context: self.asked)
        self.go_on = _GO_ON(lambda _context, _done, _all: not self.asked)

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
        self.needs = ()  # what it was computed of, which must outlive it

    def __del__(self):
        _library.lac_dataset_free(self.handle)

    def names(self) -> Iterator[bytes]:
        index = 0
        while (name := _library.lac_dataset_name(self.handle, index)) is not None:
            yield name
            index += 1

    def told(self, name: Optional[bytes]) -> "tuple[Optional[str], dict[str, Any]]":
        said, error = [], _Error()

        def take(_context, key, text, n, numbers, whole):
            said.append((key and key.decode(), text and text.decode(errors="replace"), whole, numbers[:n]))

        _check(_library.lac_dataset_tell(self.handle, name, _TOLD(take), None, error), error)
        return _said(said)

    def dims(self, name: bytes) -> "dict[str, int]":
        dims, length = {}, ctypes.c_size_t()
        while dim := _library.lac_dataset_dim(self.handle, name, len(dims), ctypes.byref(length)):
            dims[dim.decode()] = length.value
        return dims

    def values(self, name: bytes) -> numpy.ndarray:
        """Its numbers, where they lie or as a copy; the places of texts that are flags; or its texts."""
        count = _library.lac_dataset_count(self.handle, name)
        if _library.lac_dataset_array(self.handle, name):
            return numpy.asarray(_Memory(self, name))
        error, out = _Error(), numpy.empty(count)
        _check(_library.lac_dataset_values(self.handle, name, count, out.ctypes.data, error), error)
        out[~numpy.isfinite(out)] = numpy.nan
        return out

    def texts(self, name: bytes) -> numpy.ndarray:
        count, error, room = _library.lac_dataset_count(self.handle, name), _Error(), ctypes.create_string_buffer(4096)
        out = numpy.empty(count, object)
        for i in range(count):
            _check(_library.lac_dataset_text(self.handle, name, i, room, len(room), error), error)
            out[i] = room.value.decode(errors="replace")
        return out

    def dataset(self, decode_times: bool) -> xarray.Dataset:
        variables, (_, attributes) = [], self.told(None)
        for name in self.names():
            dims, (kind, about) = self.dims(name), self.told(name)
            text = _library.lac_dataset_is_text(self.handle, name)
            if kind is None and not dims and not text:
                # What is in no file has its unit in its name.
                unit = _library.lac_dataset_unit(self.handle, name).decode()
                key = name.decode() + ("" if unit == "1" else "_" + unit.replace(" ", "_"))
                attributes.setdefault(key, float(self.values(name)[0]))
            elif kind not in (None, ATTRIBUTE):  # that one is told already
                values = self.texts(name) if kind == "str" else None if text else self.values(name)
                variables.append((name.decode(), dims, kind, about, values))
        return _dataset(variables, attributes, decode_times)


def _said(told: Iterable[Any]) -> "tuple[Optional[str], dict[str, Any]]":
    """The type that a file has a variable in (None: it is no variable there), and its attributes."""
    kind, attributes = None, {}
    for key, text, whole, numbers in told:
        if key is None:
            kind = text
        elif numbers:
            small = max(map(abs, numbers)) < 2**31
            values = numpy.array(numbers, "f8" if not whole else "i4" if small else "i8")
            attributes[key] = values[0] if len(values) == 1 else values
        else:
            attributes[key] = text
    return kind, attributes


def _piped(stream: io.BytesIO, decode_times: bool) -> xarray.Dataset:
    """What the program hands over with --pipe: a line of JSON a variable, and its numbers."""
    variables, attributes = [], {}
    for line in stream:
        name, dims, texts, *told = json.loads(line)
        kind, about = _said((key, text, text, [numpy.nan if n is None else n for n in numbers])
                            for key, text, *numbers in told)
        count = int(numpy.prod(list(dims.values()), dtype=int))
        if name is None:
            attributes = about
        elif kind != ATTRIBUTE:
            values = numpy.array(texts, object) if kind == "str" else None
            if texts is None:
                values = numpy.frombuffer(stream.read(8 * count)).copy()
                values[~numpy.isfinite(values)] = numpy.nan
            variables.append((name, dims, kind, about, values))
    return _dataset(variables, attributes, decode_times)


def _dataset(told: Iterable[Any], attributes: Mapping[str, Any], decode_times: bool) -> xarray.Dataset:
    """What xarray gives of the file that this would be. Values None: the places of texts that are flags."""
    variables = {}
    for name, dims, kind, about, values in told:
        shape = list(dims.values())
        values = numpy.arange(shape[0], dtype=kind) if values is None else values if kind == "str" else _as(values, kind, about)
        variables[name] = (list(dims), values.reshape(shape), about)
    raw = xarray.Dataset(variables, attrs=attributes)
    with numpy.errstate(invalid="ignore"):  # dates that are missing
        decoded = xarray.decode_cf(raw, decode_times=decode_times).load()
    for name in set(decoded.variables) - set(decoded.dims):
        if decoded[name].dtype == raw[name].dtype == float:  # NaN was missing before: no copy is needed
            decoded[name].variable.data = raw[name].variable.data
    return decoded


def _as(values: numpy.ndarray, kind: str, about: Mapping[str, Any]) -> numpy.ndarray:
    """Numbers in the type of a file; missing integers as the attribute that says so has it."""
    if kind == "float64":
        return values
    fill = [about[key] for key in about if key.startswith("_")]  # the only one of these
    if fill and kind.startswith("int"):
        values = numpy.where(numpy.isnan(values), fill[0], values)
    return values.astype(kind)


class _Memory:
    """Numbers of a recording, which it keeps, as numpy takes them without a copy."""

    def __init__(self, recording: _Recording, name: bytes):
        self.recording = recording
        self.__array_interface__ = {
            "version": 3, "shape": (_library.lac_dataset_count(recording.handle, name),),
            "typestr": numpy.dtype(float).str, "data": (_library.lac_dataset_array(recording.handle, name), False)}


class _Owned:
    """A case or a series of the library."""

    def __init__(self, free):
        self.handle, self.free = ctypes.c_void_p(), free

    def __del__(self):
        self.free(self.handle)


def _check(status: int, error: _Error, dataset: Optional[xarray.Dataset] = None) -> None:
    if status == INTERRUPTED:
        raise KeyboardInterrupt
    if status != 0:
        raise Error(status, error.message.decode(errors="replace"), dataset)


def _text(value: Any) -> str:
    """A value as YAML: texts as they are, so that "4 cm" is a quantity; the rest as JSON, which YAML contains."""
    return value if isinstance(value, str) else json.dumps(value, default=_plain)


def _plain(value: Any) -> Any:
    """What JSON does not know: numpy's numbers and arrays, paths."""
    if isinstance(value, (numpy.generic, numpy.ndarray)):
        return value.tolist()
    if isinstance(value, collections.abc.Mapping):
        return dict(value)
    return os.fspath(value)


def _bytes(*words: Any) -> "list[bytes]":
    encoded = [os.fsencode(word) for word in words]
    if any(b"\0" in word for word in encoded):
        raise ValueError("embedded null byte")
    return encoded


def _read(case: Case, overrides: Sets, purpose: int) -> _Owned:
    """A case from a path or from a mapping."""
    sets = [tuple(_bytes(key, _text(value))) for key, value in (overrides or {}).items()]
    how = _CaseOptions(ctypes.sizeof(_CaseOptions), purpose, (_Override * len(sets))(*sets), len(sets))
    read, error = _Owned(_library.lac_case_free), _Error()
    if isinstance(case, collections.abc.Mapping):
        text = json.dumps(dict(case), indent=1, default=_plain).encode()
        status = _library.lac_case_parse(b"case", text, len(text), how, read.handle, error)
    else:
        status = _library.lac_case_load(*_bytes(case), how, read.handle, error)
    _check(status, error)
    return read


def _compute(function, *given: Any, needs: Sequence[Any] = (), decode_times: bool = True) -> xarray.Dataset:
    """The Dataset that a function of the library hands out last."""
    recording, error = _Recording(), _Error()
    recording.needs = tuple(needs)
    status = function(*given, recording.handle, error)
    found = recording.dataset(decode_times) if recording.handle and status != INTERRUPTED else None
    _check(status, error, found)
    return found


def run(case: Case, overrides: Sets = None, *, decode_times: bool = True) -> xarray.Dataset:
    """Runs a case to its end or to failure, as `lacuna run` does.

    case          path of a case file; or the case itself as a mapping, whose relative paths are looked
                  for in the current folder
    overrides     {"key.path": value}, as --set key.path=value: text with a unit, numbers in SI, lists,
                  mappings, True and False
    decode_times  as xarray.open_dataset has it: of a case with a date times are dates; False: seconds since
    Raises Error for what the library refuses, TypeError for what is no case, ValueError for a null byte in a
    text, and KeyboardInterrupt after Ctrl-C. Threads that call it at once wait for each other.

    >>> bool(run("cases/block.yaml", {"friction.aging.a": 0.0099}).attrs["failed"])
    True
    """
    with _one_at_a_time, _Stop() as stop:
        read = _read(case, overrides, FOR_RUN)
        simulation, error = _Owned(_library.lac_simulation_free), _Error()
        how = _Options(stop.callback, None)
        _check(_library.lac_simulation_create(read.handle, how, simulation.handle, error), error)
        return _compute(_library.lac_simulation_record, simulation.handle, decode_times=decode_times)


def contact(case: Case, overrides: Sets = None, *, boxes: Optional[str] = None, coarsest: Optional[int] = None,
            coarsening: Optional[str] = None, sizes: Optional[str] = None) -> xarray.Dataset:
    """Presses the surface of a case, measures its contact and follows its history of loads, as `lacuna contact` does.

    boxes       sides of boxes that the dimension is fitted to: "2:32"
    coarsest    cells a side of the coarsest resolution
    coarsening  how grids are made coarser: "sample" or "block-mean"
    sizes       specimens of the size effect: "50 mm, 1 m"
    Other arguments and errors are those of run.

    >>> contact("cases/contact/self-affine.yaml", {"interface.levels": 5}).attrs["n_cells"] > 0
    True
    """
    with _one_at_a_time, _Stop() as stop:
        read = _read(case, overrides, FOR_CONTACT)
        words = [None if word is None else _bytes(str(word))[0] for word in (boxes, coarsest, coarsening, sizes)]
        how = _ContactOptions(False, stop.callback, None, *words)
        return _compute(_library.lac_contact_compute, read.handle, how, needs=[read])


def rg(case: Case, overrides: Sets = None, *, snapshot: Union[str, int, None] = None) -> xarray.Dataset:
    """The cascade of slip over the blocks of a case, or over the cells in the file of a run or of a contact, as
    `lacuna rg` has it.

    case      that of run; or path of such a file, whose keys of rg overrides can change
    snapshot  which one of the file: "last", a number from 0, a time such as "10 day"
    Errors are those of run.

    >>> rg("cases/rg/cons.yaml").sizes["level"] > 1
    True
    """
    if snapshot is not None or _is_netcdf(case):
        return _asked(["rg"], [case], overrides, {"snapshot": snapshot})
    with _one_at_a_time, _Stop() as stop:
        read = _read(case, overrides, FOR_RG)
        return _compute(_library.lac_rg_compute, read.handle, _RgOptions(stop.go_on, None), needs=[read])


def _is_netcdf(case: Case) -> bool:
    try:
        with open(case, "rb") as file:
            return file.read(4).startswith(NETCDF)
    except (OSError, TypeError, ValueError):  # who reads the case says why
        return False


def _seconds(when: Any, nothing: float) -> float:
    """A number of seconds on the series' clock, or a date as numpy takes it."""
    if when is None:
        return nothing
    if isinstance(when, (int, float, numpy.floating, numpy.integer)):
        return float(when)
    return (numpy.datetime64(when) - numpy.datetime64(0, "s")) / numpy.timedelta64(1, "s")


def _column(text: Optional[str]) -> "tuple[Optional[bytes], Optional[bytes]]":
    """A column and its unit, as "name" or "name:unit"."""
    name, _, unit = (text or "").partition(":")
    return tuple(word.encode() or None for word in (name, unit))


def precursors(series: "str | os.PathLike[str]", *, time: Optional[str] = None, displacement: Optional[str] = None,
               velocity: Optional[str] = None, time_format: Optional[str] = None, since: Any = None, until: Any = None,
               failed_at: Any = None, issues: int = 0, case: Optional[Case] = None, overrides: Sets = None,
               levels: Optional[str] = None, threads: int = 1, decode_times: bool = True,
               **options: Any) -> xarray.Dataset:
    """Forecasts of the time of failure from readings, and indicators, as `lacuna precursors` has them.

    series        path of a CSV or netCDF file
    displacement, velocity   its column, "name" or "name:unit"
    since, until, failed_at  dates (texts or datetime64) or seconds on the series' clock
    issues        forecasts as of so many readings (--rolling: 400); 0: of the last one
    case          one more method, the slope's own model
    levels        path of a file of thresholds
    options       any other of the command: driver="rain:mm:sum", components="e:mm,n:mm", raw=True
    Errors are those of run.

    >>> precursors("cases/data/creep.csv", displacement="disp_mm:mm").failure_time.dtype.kind
    'M'
    """
    if options:
        given = {"time": time, "displacement": displacement, "velocity": velocity, "time-format": time_format, "since": since,
                 "until": until, "failed-at": failed_at, "rolling": issues > 0, "issues": issues or None, "levels": levels}
        return _asked(["precursors"], [series], overrides, {**given, **options}, decode_times, {"case": case})
    with _one_at_a_time, _Stop() as stop:
        read = _read(case, overrides, FOR_FIT) if case is not None else None
        words = [*_bytes(series), (time or "").encode() or None, (time_format or "").encode() or None]
        named, error = _Owned(_library.lac_series_free), _Error()
        _check(_library.lac_series_create(_SeriesDef(*words, *_column(displacement), *_column(velocity)), named.handle,
                                          error), error)
        how = _ForecastOptions(0, 0, 0, 0.0, False, _seconds(since, numpy.nan), _seconds(until, numpy.inf), 0, 0, issues,
                               _seconds(failed_at, numpy.nan), read.handle if read else None, threads, stop.go_on, None,
                               os.fsencode(levels) if levels else None)
        return _compute(_library.lac_forecast_compute, named.handle, how, needs=[read, named, how], decode_times=decode_times)


def fit(case: Case, series: "str | os.PathLike[str]", overrides: Sets = None, *, threads: int = 1,
        decode_times: bool = True, **options: Any) -> xarray.Dataset:
    """Fits the parameters that the section `fit` of a case names to a series, as `lacuna fit` does.

    Arguments and errors are those of run; of a fit that has not converged Error.dataset has what there is. Options are
    any other of the command: displacement="disp_mm:mm" where the case names no columns.

    >>> fit("cases/fit/block.yaml", "cases/data/creep.csv", {"fit.steps": 0, "fit.starts": 4}).attrs["status"]
    'complete'
    """
    if options:
        return _asked(["fit"], [case, series], overrides, {"threads": threads if threads > 1 else None, **options}, decode_times)
    with _one_at_a_time, _Stop() as stop:
        read, named, error = _read(case, overrides, FOR_FIT), _Owned(_library.lac_series_free), _Error()
        _check(_library.lac_fit_series(read.handle, *_bytes(series), named.handle, error), error)
        how = _FitOptions(stop.callback, None, None, threads)
        return _compute(_library.lac_fit_compute, read.handle, named.handle, how, needs=[read, named, how],
                        decode_times=decode_times)


def _words(options: Mapping[str, Any]) -> "list[str]":
    """Options as the program has them: True is one without a value, a list is one that is repeated."""
    words = []
    for key, value in options.items():
        name = ("-" if len(key) == 1 else "--") + key.replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is not None and one is not False:
                words += [name] if one is True else [name, str(one)]
    return words


def _program(words: Sequence[str], arguments: Sequence[Any], overrides: Sets, folder: str,
             cases: Mapping[str, Any] = {}) -> bytes:
    """What the program prints. @param cases  options whose values are cases, too"""
    # A wheel's module is a package, one folder deeper.
    program = (os.environ.get("LACUNA_PROGRAM") or _beside("../bin/lacuna" if __file__.endswith("lacuna.py") else "../../bin/lacuna")
               or shutil.which("lacuna"))
    if program is None:
        raise Error(STATUS.index("file"), "no program lacuna: LACUNA_PROGRAM names it")
    given = [os.fsdecode(_case_file(one, folder, i)) for i, one in enumerate(arguments)]
    given += _words({key: _case_file(one, folder, key) for key, one in cases.items() if one is not None})
    sets = [word for key, value in (overrides or {}).items() for word in ("--set", f"{key}={_text(value)}")]
    words = [program, *words, *given, *sets]
    _bytes(*words)
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            out, said = process.communicate()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            process.communicate()
            raise
    if process.returncode == 4:
        raise KeyboardInterrupt
    if process.returncode != 0 and not (words[1] == "check" and out):
        kind = {1: "numeric", 3: "file"}.get(process.returncode, "input")
        raise Error(STATUS.index(kind), said.decode(errors="replace").strip().replace("lacuna: ", "", 1))
    return out


def _case_file(case: Any, folder: str, name: Any) -> "str | os.PathLike[str]":
    """A case that is in no file gets one."""
    if not isinstance(case, collections.abc.Mapping):
        return case
    place = os.path.join(folder, f"case-{name}.yaml")
    with open(place, "w", encoding="utf-8") as file:
        json.dump(dict(case), file, indent=1, default=_plain)
    return place


def _asked(words: Sequence[str], arguments: Sequence[Any], overrides: Sets, options: Mapping[str, Any],
           decode_times: bool = True, cases: Mapping[str, Any] = {}, journal: bool = True) -> xarray.Dataset:
    """The dataset of a command of the program. @param journal  it keeps its work in a folder while it goes on, which is
    removed in the end, after Ctrl-C too, unless the option `output` names one, which `resume=True` goes on from"""
    with tempfile.TemporaryDirectory(prefix="lacuna-") as folder:
        place = ["-o", folder] if journal and not {"o", "output"} & options.keys() else []
        out = _program([*words, *_words(options), *place, "--pipe", "--no-progress"], arguments, overrides, folder, cases)
    return _piped(io.BytesIO(out), decode_times)


def command(name: str, *arguments: Any, overrides: Sets = None, **options: Any) -> "dict[str, Any]":
    """What a command of the program says with --json: report, export, mend ... and those that have a function here.

    arguments, options  as on its command line; what has no value is True, what is repeated a list

    >>> command("describe", "friction", "aging")["kinds"][0]["models"][0]["name"]
    'aging'
    """
    with tempfile.TemporaryDirectory(prefix="lacuna-") as folder:
        return json.loads(_program([name, *_words(options), "--json", "--no-progress"], arguments, overrides, folder))


def check(case: Case, overrides: Sets = None) -> xarray.Dataset:
    """What is wrong with a case, its resolved text and what it will cost, as `lacuna check` has it. Of a case that cannot
    be read at all it raises Error; of a wrong one the Dataset says what is wrong.

    >>> int(check("cases/block.yaml").attrs["ok"])
    1
    """
    return _asked(["check"], [case], overrides, {}, journal=False)


def describe(kind: Optional[str] = None, name: Optional[str] = None) -> xarray.Dataset:
    """Models and sections with their parameters, units and ranges, as `lacuna describe` has them.

    >>> "dc" in describe("friction", "aging").key
    True
    """
    return _asked(["describe"], [word for word in (kind, name) if word], None, {}, journal=False)


def trade(case: Case, overrides: Sets = None, *, dials: Optional[str] = None, quantity: Optional[str] = None,
          reach: Optional[str] = None, spend: Optional[str] = None, processes: Optional[int] = None,
          **options: Any) -> xarray.Dataset:
    """Error against cost over the settings of a case, as `lacuna trade` has them: each run in a process of its own.
    Options are any other of the command: crossed=True.

    >>> "run" in trade("cases/block.yaml", dials="rtol=1e-3:1e-4", reach="1%").sizes
    True
    """
    given = {"dials": dials, "quantity": quantity, "reach": reach, "spend": spend, "jobs": processes}
    return _asked(["trade"], [case], overrides, {**given, **options})


def sweep(case: Case, over: Mapping[str, Any], overrides: Sets = None, *, design: Optional[str] = None,
          members: Optional[int] = None, seed: Optional[int] = None, processes: Optional[int] = None,
          decode_times: bool = True, **options: Any) -> xarray.Dataset:
    """Runs a case many times over lists and distributions, as `lacuna sweep` does, in its pool of processes.

    over     {"key.path": "uniform(1 cm, 5 cm)"}, lists, ranges; a list of Python is one too
    options  any other of the command: by="2 year", table="values.csv", series="time:50", shard="0/4"; of a folder for
             its work, output="work", a sweep that was stopped goes on with resume=True

    >>> sweep("cases/block.yaml", {"friction.aging.dc": ["4 mm", "5 mm"]}).sizes["realization"]
    2
    """
    said = [f"{key}={', '.join(map(str, value)) if isinstance(value, (list, tuple)) else value}"
            for key, value in over.items()]
    given = {"over": said, "design": design, "members": members, "seed": seed, "jobs": processes}
    return _asked(["sweep"], [case], overrides, {**given, **options}, decode_times)
