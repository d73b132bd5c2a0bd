# SPDX-License-Identifier: GPL-3.0-or-later
"""What the program tells shells: `lacuna __complete WORDS...`."""

import subprocess


def offered(program, *words, **options):
    """Candidates for the last word and what they mean; of files what stands before and the endings."""
    done = subprocess.run([program, "__complete", *words], stdin=subprocess.DEVNULL, timeout=60,
                          capture_output=True, text=True, check=True, **options)
    assert done.stderr == "", done.stderr
    return dict(line.split("\t") for line in done.stdout.splitlines())


def commands(program):
    return list(offered(program, ""))


def keys(program, typed=""):
    """All keys of a case, part by part as a shell gets them; places in lists as 0."""
    found = []
    for part in offered(program, "check", "x", "--set", typed):
        found += [part[:-1]] if part.endswith("=") else keys(program, part)
    return found


def choices(program, key):
    """What the value of a key can be."""
    return [word.split("=")[1] for word in offered(program, "check", "x", "--set", key + "=") if word[0] != ":"]
