# SPDX-License-Identifier: GPL-3.0-or-later
"""Every source file says its licence in its first line (its second after #!).

    spdx.py [ROOT]
"""

import os
import sys

import source

NAME = "SPDX-License-Identifier: GPL-3.0-or-later"
FOLDERS = ["include", "src", "tests", "tools", ".ci"]
ENDINGS = (".c", ".h", ".py", ".cmake", ".js", "CMakeLists.txt")


def expected(path):
    if path.endswith(".h"):
        return f"/* {NAME} */"
    if path.endswith((".c", ".js")):
        return f"// {NAME}"
    return f"# {NAME}"


def check(path, text):
    """Complaints about one file."""
    lines = text.split("\n")
    first = lines[1] if lines[0].startswith("#!") and len(lines) > 1 else lines[0]
    if first == expected(path):
        return []
    return [f"{path}:1: must begin with `{expected(path)}`"]


def scripts(root):
    """Files without an ending that begin with #!."""
    found = []
    for path in source.files(root, ["tools", ".ci", "tests"], ""):
        if "." not in os.path.basename(path):
            with open(os.path.join(root, path), "rb") as file:
                if file.read(2) == b"#!":
                    found.append(path)
    return found


def main(root):
    complaints = []
    for path in source.files(root, FOLDERS, ENDINGS) + scripts(root) + ["CMakeLists.txt"]:
        complaints += check(path, source.read(root, path))
    return source.report(complaints, "spdx")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "."))
