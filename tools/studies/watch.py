#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna watch` killed many times against the same in one go: the table of docs/howto-watch.md.

    tools/studies/watch.py [--lacuna PROGRAM] [--stations N] [--readings N] [--kills N] [--window N] [--seed N] [--json]

Readings of N stations come turn by turn, a tenth of them accelerating, some late, doubled or damaged. They are sent once
to a watch that is left alone, and then, from the beginning each time, to one that is killed (SIGKILL) again and again: as
soon as its output has grown to a random length, while the stream is being sent in pieces cut anywhere. What it wrote must
be the same bytes. Exit status 1 where it is not.
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import threading
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FLEET = """displacement: "displacement:mm"
window: {{count: {window}}}
stream: replayed
checkpoint: {{lines: {lines}, time: 5 s}}
"""


def stream(stations, readings, seed):
    """The lines of all stations: one in ten fails a tenth beyond the last reading, the others creep."""
    draw = random.Random(seed)
    life = 1.1 * readings
    rows = []
    for turn in range(readings):
        for station in range(stations):
            day = turn + station / stations
            fails = station % 10 == 0
            moved = -300 * math.log(1 - day / life) + draw.gauss(0, 0.3) if fails else 0.02 * day + draw.gauss(0, 1)
            rows.append(f"P{station:04d},{86400 * day:.0f},{moved:.1f}")
    for _ in range(len(rows) // 100):  # one in a hundred comes late, one is sent twice, one is damaged
        at = draw.randrange(len(rows) - 1)
        rows.insert(min(len(rows), at + draw.randrange(2 * stations)), rows.pop(at))
        rows.insert(draw.randrange(len(rows)), rows[draw.randrange(len(rows))])
        rows.insert(draw.randrange(len(rows)), draw.choice(["P0001,soon,1.0", "P0002,5,x", "what", "P0003,7,1.0,4,5"]))
    return "\n".join(["station,time,displacement"] + rows) + "\n"


def send(pipe, data, draw):
    """Writes the stream in pieces cut anywhere, until nobody reads."""
    at = 0
    try:
        while at < len(data):
            piece = draw.choice([1, 7, 100, 1000, 5000])
            pipe.write(data[at:at + piece])
            pipe.flush()
            at += piece
    except (BrokenPipeError, ValueError):
        return
    try:
        pipe.close()
    except BrokenPipeError:
        pass


def begin(words, data, draw):
    process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    sender = threading.Thread(target=send, args=(process.stdin, data, draw), daemon=True)
    sender.start()
    return process, sender


def end(process, sender):
    out = process.stdout.read()
    status = process.wait()
    sender.join()
    process.stdout.close()
    return status, out


def size(path):
    return os.path.getsize(path) if os.path.exists(path) else 0


def grows_to(process, path, length):
    """Waits until the output has that length, or the process ends."""
    while process.poll() is None and size(path) < length:
        time.sleep(0.0005)
    return process.poll() is None


def finish(words, data, draw):
    status, out = end(*begin(words, data, draw))
    if status != 0:
        sys.exit(f"watch: {' '.join(words)}: exit status {status}")
    return json.loads(out)


def killed(words, data, draw, path, lengths):
    """Runs until all lengths were reached. @return how often it was killed"""
    done = 0
    for length in lengths:
        process, sender = begin(words, data, draw)
        if grows_to(process, path, length):
            process.kill()
            done += 1
        end(process, sender)
    return done


def study(arguments, folder):
    draw = random.Random(arguments.seed)
    data = stream(arguments.stations, arguments.readings, arguments.seed).encode()
    fleet = os.path.join(folder, "fleet.yaml")
    with open(fleet, "w", encoding="utf-8") as file:
        total = arguments.stations * arguments.readings
        file.write(FLEET.format(window=arguments.window, lines=max(10, total // 200)))

    def words(name):
        path = os.path.join(folder, name)
        return [arguments.lacuna, "watch", fleet, "--state", path + ".state", "-o", path + ".jsonl", "--json"]

    alone = finish(words("alone"), data, draw)
    path = os.path.join(folder, "alone.jsonl")
    length = size(path)
    lengths = [(k + draw.random()) * length / (arguments.kills + 1) for k in range(arguments.kills)]
    kills = killed(words("killed"), data, draw, os.path.join(folder, "killed.jsonl"), lengths)
    last = finish(words("killed"), data, draw)
    with open(path, "rb") as one, open(os.path.join(folder, "killed.jsonl"), "rb") as other:
        text = one.read()
        same = text == other.read()
    return {"stations": arguments.stations, "lines": alone["lines"], "readings": alone["readings"], "late": alone["late"],
            "doubled": alone["doubled"], "bad": alone["bad"], "issuing": sum(b'"issued": true' in line for line in text.splitlines()),
            "bytes": length, "kills": kills, "same": same, "cpu_time_s": alone["cpu_time_s"],
            "peak_memory_bytes": max(alone["peak_memory_bytes"], last["peak_memory_bytes"]),
            "memory_of_stations_at_most_bytes": alone["memory_of_stations_at_most_bytes"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build/lacuna"), metavar="PROGRAM")
    parser.add_argument("--stations", type=int, default=1000)
    parser.add_argument("--readings", type=int, default=50, help="of each station")
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--window", type=int, default=2000, help="readings")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="lacuna-watch-") as folder:
        found = study(arguments, folder)
    if arguments.json:
        print(json.dumps(found))
    else:
        for key, value in found.items():
            print(f"{key:34} {value}")
    sys.exit(0 if found["same"] and found["kills"] == arguments.kills else 1)


if __name__ == "__main__":
    main()
