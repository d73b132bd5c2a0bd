# SPDX-License-Identifier: GPL-3.0-or-later
"""What the library exports, keeps and calls.

    symbols.py LIBRARY

Every global symbol begins with lac_; nothing writable outlives a call; nothing prints to the
terminal, ends the process, reads the environment or the clock, or switches GSL's error handler, which is
one for all threads.
"""

import re
import subprocess
import sys

import source

FORBIDDEN = set(
    """printf vprintf puts putchar perror __printf_chk __vprintf_chk stdout stderr stdin
    exit _exit _Exit quick_exit abort atexit raise signal sigaction
    getenv secure_getenv setenv putenv environ system popen
    time clock clock_gettime gettimeofday timespec_get localtime localtime_r gmtime ctime asctime
    rand srand random srandom drand48 strtok setlocale
    gsl_set_error_handler gsl_set_error_handler_off""".split()
)

CONSTANT = re.compile(r"\.(rodata|data\.rel\.ro|text|eh_frame)")
GENERATED = re.compile(r"^(_GLOBAL__|__|\.|DW\.ref)")


def rows(listing):
    """(member, name, letter, section) of each line of `nm --format=sysv`."""
    member = "?"
    for line in listing.splitlines():
        header = re.match(r"(?:Symbols|Undefined symbols) from .*\[(.*)\]:", line)
        if header:
            member = header.group(1)
        fields = [field.strip() for field in line.split("|")]
        if len(fields) == 7 and fields[0] != "Name":
            yield member, fields[0], fields[2], fields[6]


def check(listing):
    """Complaints about a library, from its symbol listing."""
    complaints = []
    for member, name, letter, section in rows(listing):
        if letter == "U":
            if name in FORBIDDEN:
                complaints.append(f"{member}: calls or reads {name}, which is the program's to do")
            continue
        if GENERATED.match(name):
            continue
        if letter in "TDBRCVWi" and not name.startswith("lac_"):
            complaints.append(f"{member}: {name} is global and does not begin with lac_")
        if letter in "dDbBCsSgGuV" and not CONSTANT.match(section):
            complaints.append(f"{member}: {name} is writable and outlives the call ({section})")
    return complaints


def main(library):
    listing = subprocess.run(
        ["nm", "--format=sysv", library], check=True, capture_output=True, text=True
    ).stdout
    if "lac_" not in listing:
        return source.report([f"{library}: no symbols at all"], "symbols")
    return source.report(check(listing), "symbols")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
