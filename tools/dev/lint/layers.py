# SPDX-License-Identifier: GPL-3.0-or-later
"""Dependencies go one way, and each library lives in one place.

    layers.py [ROOT]

A module includes public headers, and those that modules share (src/<module>/<module>.h and what SHARED says), only of
modules below it, private headers only of itself; a public header only public ones. Third-party headers stand only where
HOMES says, never in include/.
"""

import re
import sys

import source

# What each module may use, besides base and what those use in turn.
USES = {
    "base": [],
    "data": [],
    "surface": [],
    "contact": ["surface"],
    "fractal": ["contact"],
    "hierarchy": ["contact"],
    "rg": ["hierarchy", "fractal"],
    "friction": [],
    "transfer": ["hierarchy"],
    "series": [],
    "forecast": ["series"],
    "precursor": ["forecast"],
    "load": ["series"],
    "model": ["contact", "hierarchy", "friction", "transfer", "load"],
    "async": ["hierarchy", "friction"],
    "run": ["model", "async"],
    "analysis": ["run", "rg"],
    "store": ["run", "fractal", "rg", "precursor", "data"],
    "case": ["surface", "fractal", "series", "store", "rg", "analysis"],
    "scene": ["case"],
    "fit": ["scene"],
    "simulation": ["scene"],
    "trade": ["scene"],
    "sweep": ["simulation", "trade"],
    "report": ["store", "sweep"],
    "watch": ["case"],
    "cli": ["simulation", "fit", "trade", "report", "sweep", "watch"],
}

# What a module shares besides <module>.h; all other headers of src are its own.
SHARED = {
    "base": None,  # all of it, as of data
    "data": None,
    "analysis": {"slip_events.h"},
    "case": {"fleet.h", "levels.h"},
    "contact": {"tangential.h"},
    "fit": {"model_forecast.h", "sampler.h"},
    "forecast": {"hindcast.h", "verdict.h"},
    "hierarchy": {"classes.h"},
    "load": {"geometry.h"},
    "friction": {"weakening.h"},
    "model": {"problem.h"},
    "rg": {"rg_study.h"},
    "run": {"describe.h", "points.h", "sensitivity.h"},
    "scene": {"estimate.h", "lump.h", "scene_rg.h"},
    "series": {"field.h", "line.h", "motion.h"},
    "simulation": {"branch.h"},
    "store": {"past.h", "recording.h", "store_cells.h", "store_file.h"},
    "sweep": {"answers.h", "ensemble.h"},
    "trade": {"probe.h"},
}

# The module of a public header, where the names differ; lacuna.h is everyone's.
PUBLIC = {
    "case": "base",
    "contact": "scene",
    "dataset": "data",
    "error": "base",
    "forecast": "fit",
    "linkage": "base",
    "param": "base",
    "rg": "scene",
    "simulation": "base",
    "version": "base",
    "lacuna": "cli",
}

# Where a library may be used, by its headers.
HOMES = [
    (r"(cvode|cvodes|arkode|nvector|sundials|sun\w+)/.*", "src/run/"),
    (r"netcdf\w*\.h", ("src/store/", "src/base/netcdf.c", "src/base/netcdf_open.c", "src/surface/read_netcdf.c",
                        "src/series/read_netcdf.c", "src/series/read_field.c")),
    (r"yaml\.h", "src/case/"),
    (r"udunits2\.h", "src/base/units.c"),
    (r"fftw3\.h", ("src/base/fft.c", "src/base/fft_share.c", "src/base/filter.c")),
    (r"Random123/.*", "src/base/rng.c"),
    (r"gsl/.*", "src/"),
    (r"microhttpd\.h", "src/cli/view/view_http.c"),
    (r"mpi\.h", "src/cli/team/team_mpi.c"),
]

# The one file besides that may include them: it asks each for its version.
VERSIONS = "src/cli/common/libraries.c"

STANDARD = set(
    """assert.h complex.h ctype.h errno.h fenv.h float.h inttypes.h limits.h locale.h math.h
    omp.h setjmp.h signal.h stdalign.h stdarg.h stdatomic.h stdbool.h stddef.h stdint.h stdio.h
    stdlib.h stdnoreturn.h string.h tgmath.h time.h
    arpa/inet.h dirent.h dlfcn.h fcntl.h getopt.h pthread.h strings.h poll.h netinet/in.h sys/file.h sys/ioctl.h sys/mman.h sys/prctl.h sys/random.h sys/resource.h sys/select.h sys/socket.h
    sys/stat.h sys/time.h sys/types.h sys/wait.h termios.h unistd.h""".split()
)

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)


def reach(module):
    """All that a module may use, itself included."""
    seen = {"base", "data", module}
    for other in USES[module]:
        seen |= reach(other)
    return seen


def owner(path):
    """The module that a file belongs to; None where it is in none."""
    public = re.fullmatch(r"(?:include/)?lacuna/(\w+)\.h", path)
    if public:
        name = public.group(1)
        return PUBLIC.get(name, name if name in USES else None)
    private = re.fullmatch(r"(?:src/)?(\w+)/.*", path)
    return private.group(1) if private and private.group(1) in USES else None


def shared(module, included):
    """Whether a header in src is for other modules too."""
    others = SHARED.get(module, set())
    return others is None or included.split("/", 1)[1] in others | {module + ".h"}


def check_project(path, module, included):
    included = included if "/" in included else path.rsplit("/", 1)[0].replace("src/", "", 1) + "/" + included
    other = owner(included)
    if other is None:
        return f'"{included}" belongs to no module that tools/dev/lint/layers.py knows'
    public = included.startswith("lacuna/")
    if path.startswith("include/"):
        return None if public else f'a public header must not include "{included}", which is not installed'
    if other not in reach(module):
        return f'{module} must not use {other} ("{included}")'
    if not public and other != module and not shared(other, included):
        return f'"{included}" is private to {other}'
    return None


def check_library(path, included):
    if included in STANDARD:
        return None
    for pattern, home in HOMES:
        if re.fullmatch(pattern, included):
            homes = (home,) if isinstance(home, str) else home
            at_home = path.startswith(homes) or path == VERSIONS
            return None if at_home else f"<{included}> belongs in {' and '.join(homes)} only"
    return f"<{included}> is new: say in tools/dev/lint/layers.py where it lives"


def check(path, text):
    """Complaints about one file."""
    module = owner(path)
    if module is None:
        return [f"{path}:1: belongs to no module that tools/dev/lint/layers.py knows"]
    complaints = []
    visible = source.without_comments(text)
    for match in INCLUDE.finditer(visible):
        quote, included = match.groups()
        if quote == '"':
            wrong = check_project(path, module, included)
        else:
            wrong = check_library(path, included)
        if wrong:
            complaints.append(f"{path}:{source.line_of(visible, match.start(1))}: {wrong}")
    return complaints


def main(root):
    complaints = []
    for path in source.files(root, ["include", "src"], (".c", ".h")):
        complaints += check(path, source.read(root, path))
    return source.report(complaints, "layers")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "."))
