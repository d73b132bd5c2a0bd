#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a notebook of the documentation and compares what its cells give with what it holds.

    run_notebook.py PROGRAM LIBRARY NOTEBOOK.ipynb [--update]

Texts are compared line by line; numbers may differ by 1 %, or by 2 in their last digit. Where the notebook holds a picture
there must be one. --update writes what the cells give into the notebook instead.
"""

import json
import os
import shutil
import sys
import tempfile

import nbclient
import nbformat

from run_page import NUMBER


def run(program, library, path):
    """The code cells of a notebook with their outputs, of a run in a folder of its own."""
    notebook = nbformat.read(path, as_version=4)
    scratch = tempfile.mkdtemp(prefix="lacuna-notebook-")
    os.environ.update(LACUNA_PROGRAM=program, LACUNA_LIBRARY=library, TMPDIR=scratch, OMP_NUM_THREADS="1",
                      PYDEVD_DISABLE_FILE_VALIDATION="1")
    try:
        nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3",
                                resources={"metadata": {"path": os.path.dirname(path)}}).execute()
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return notebook


def shown(output):
    """An output as a notebook is to hold it."""
    plain = {key: output[key] for key in ("output_type", "name", "text", "data") if key in output}
    if "data" in plain:
        plain["data"] = dict(plain["data"])
    if plain["output_type"] != "stream":
        plain["metadata"] = {}
    if plain["output_type"] == "execute_result":
        plain["execution_count"] = output.execution_count
    return plain


def text_of(output):
    text = output.get("text", output.get("data", {}).get("text/plain", ""))
    return "".join(text) if isinstance(text, list) else text


def same(held, given):
    """Two texts, but for the last digits of their numbers."""
    if NUMBER.sub("#", held).split() != NUMBER.sub("#", given).split():
        return False
    for one, other in zip(NUMBER.findall(held), NUMBER.findall(given)):
        mantissa, _, power = one.lower().partition("e")
        digit = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
        if abs(float(one) - float(other)) > max(0.01 * abs(float(one)), 2.1 * digit):
            return False
    return True


def differences(held, given):
    """What is not as the notebook holds it, a line each."""
    found = []
    for number, (cell, now) in enumerate(zip(held["cells"], given["cells"])):
        if cell["cell_type"] != "code":
            continue
        before, after = cell["outputs"], [shown(output) for output in now.outputs]
        kinds = [[(o["output_type"], o.get("name"), sorted(o.get("data", {}))) for o in outputs] for outputs in (before, after)]
        if kinds[0] != kinds[1]:
            found.append(f"cell {number}: holds {kinds[0]}, gives {kinds[1]}")
            continue
        for one, other in zip(before, after):
            if not same(text_of(one), text_of(other)):
                found.append(f"cell {number}: holds {text_of(one)}, gives {text_of(other)}")
    return found


def update(path, given):
    with open(path, encoding="utf-8") as file:
        notebook = json.load(file)
    for cell, now in zip(notebook["cells"], given["cells"]):
        if cell["cell_type"] == "code":
            cell["outputs"] = [shown(output) for output in now.outputs]
            cell["execution_count"] = now.execution_count
    with open(path, "w", encoding="utf-8") as file:
        json.dump(notebook, file, indent=1, ensure_ascii=False)
        file.write("\n")


def main(program, library, path, *words):
    path = os.path.abspath(path)
    given = run(os.path.abspath(program), os.path.abspath(library), path)
    if words == ("--update",):
        update(path, given)
        return 0
    with open(path, encoding="utf-8") as file:
        found = differences(json.load(file), given)
    print("\n".join(found) or "as held")
    return 1 if found else 0


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
