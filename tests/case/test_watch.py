#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna watch`: each line is that of `precursors --rolling --jsonl`, whatever comes between.

usage: test_watch.py PROGRAM SOURCE_FOLDER AT_CALL [unittest options]
"""

import json
import math
import os
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, SOURCE, LIBRARY = "", "", ""
DAY = 86400
HEADER = "station,time,displacement\n"


def rows(station, n, seed=1, noise=1.0, fails=False):
    """Daily readings in mm, at seconds; one that fails does so a tenth beyond the last."""
    draw = random.Random(f"{station}{seed}")
    return [(station, DAY * k, (-300 * math.log(1 - k / (1.1 * n)) if fails else 0.02 * k) + draw.gauss(0, noise))
            for k in range(n)]


def text(readings, header=HEADER):
    return header + "".join(f"{station},{at:.0f},{moved:.1f}\n" for station, at, moved in readings)


def turns(*series):
    return [reading for turn in zip(*series) for reading in turn]


class Watch(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-watch-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content, mode="w"):
        with open(self.path(name), mode, encoding="utf-8") as out:
            out.write(content)

    def read(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def fleet(self, more="", name="fleet.yaml"):
        self.write(name, 'displacement: "displacement:mm"\n' + more)
        return name

    def call(self, *words, stdin="", status=0, env=None):
        done = subprocess.run([PROGRAM, *words], input=stdin, text=True, capture_output=True, cwd=self.folder,
                              env=env, check=False)
        self.assertEqual(done.returncode, status, done.stdout[-2000:] + done.stderr)
        return done

    def watch(self, stdin, *words, fleet="fleet.yaml", **how):
        return self.call("watch", fleet, *words, stdin=stdin, **how).stdout.splitlines()

    def rolling(self, readings, *words):
        """The lines of precursors over readings of one station, in the order of a file."""
        self.write("one.csv", text(readings))
        return self.call("precursors", "one.csv", "--time", "time", "--displacement", "displacement:mm", "--rolling",
                         "--issues", "1000", "--jsonl", *words).stdout.splitlines()

    def issue(self, line):
        """What is said of the issue, without what is said of the reading."""
        return '{"issue_time_s"' + line.split('"issue_time_s"', 1)[1]

    def start(self, *words, stdin=subprocess.PIPE):
        process = subprocess.Popen([PROGRAM, "watch", "fleet.yaml", *words], stdin=stdin, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, cwd=self.folder)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        for pipe in (process.stdout, process.stderr, process.stdin):
            self.addCleanup(lambda pipe=pipe: pipe and pipe.close())
        return process

    def wait_for(self, what):
        end = time.monotonic() + 120
        while not what():
            self.assertLess(time.monotonic(), end, "nothing came in two minutes")
            time.sleep(0.005)

    def lines(self, name):
        return self.read(name).count("\n") if os.path.exists(self.path(name)) else 0

    # Lines.

    def test_lines_are_those_of_rolling(self):
        series = {"A": rows("A", 45, fails=True, noise=0.2), "B": rows("B", 45)}
        for fleet, words in (("window: {count: 20}\n", ["--window", "20"]),
                             ("window: {time: 15.5 day}\n", ["--window", "15.5 day"]),
                             ("window: {count: 30, time: 25 day}\nonset: 2,5\nsmooth: average:3\nraw: true\n",
                              ["--window", "30,25 day", "--onset", "2,5", "--smooth", "average:3", "--raw"]),
                             ("", [])):
            self.fleet(fleet)
            got = self.watch(text(turns(*series.values())))
            issued = 0
            for station, readings in series.items():
                own = [self.issue(line) for line in got if f'"station": "{station}"' in line]
                self.assertEqual(own, self.rolling(readings, *words))
                issued += sum('"issued": true' in line for line in own)
            self.assertGreater(issued, 5)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_window_forgets(self):
        """What is before the window changes nothing, how fine its numbers were neither."""
        last = rows("A", 40, fails=True, noise=0.2)[10:]
        before = [("A", -DAY * k, 0.123456 * k) for k in range(20, 0, -1)]
        self.write("long.csv", HEADER + "".join(f"{s},{t:.0f},{d:.6f}\n" for s, t, d in before)
                   + text(last, header=""))
        words = ["precursors", "long.csv", "--time", "time", "--displacement", "displacement:mm", "--rolling",
                 "--issues", "1000", "--jsonl"]
        cut = self.call(*words, "--window", "25").stdout.splitlines()
        self.assertEqual(cut[-6:], self.rolling(last, "--window", "25")[-6:])
        self.assertNotEqual(cut[-6:], self.call(*words).stdout.splitlines()[-6:])

    def test_dates_and_other_columns(self):
        self.write("fleet.yaml", 'station: prism\ntime: date\ntime_format: "%d.%m.%Y %H:%M"\n'
                   'displacement: "way:cm"\nsigma: "error:mm"\n')
        said = "date;who;error;prism;way\n01.02.2024 10:00;x;2;Ä<1>;1,5\n02.02.2024 10:00;x;;Ä<1>;NA\n"
        one, two = [json.loads(line) for line in self.watch(said)]
        self.assertEqual(one["station"], "Ä<1>")
        self.assertEqual(one["issue_date"], "2024-02-01T10:00:00Z")
        self.assertEqual(two["time_s"], one["time_s"] + DAY)
        self.write("fleet.yaml", 'station: who\ntime: date\nclock: hour\ntime_format: "%d.%m.%Y %H:%M:%S"\n'
                   'displacement: "way:mm"\n')
        three, four = [json.loads(line) for line in self.watch("date;hour;who;way\n01.02.2024;10:00:00;A;1,5\n"
                                                               "02.02.2024;NA;A;1,5\n")]
        self.assertEqual(three["issue_date"], "2024-02-01T10:00:00Z")
        self.assertEqual(four["error"], 'hour: "NA" must be a time of day')
        self.write("fleet.yaml", 'columns: [time, "-", displacement, station]\ndisplacement: "displacement:mm"\n')
        self.assertEqual(json.loads(self.watch("5,x,1.5,B\n")[0])["station"], "B")

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_late_doubled_and_old(self):
        self.fleet("window: {count: 25}\n")
        whole = rows("A", 36, fails=True, noise=0.2)
        sent = whole[:20] + whole[24:28] + [whole[22]] + whole[28:33] + [whole[26]] + [whole[21], whole[0]] + whole[33:]
        arrived, expected = [], []
        got = self.watch(text(sent))
        self.assertEqual(len(got), len(sent))
        for reading, line in zip(sent, got):
            answer = json.loads(line)
            self.assertEqual(answer["time_s"], reading[1])
            if reading in arrived or reading is whole[0] and len(arrived) > 25:
                self.assertEqual(answer["dropped"], "old" if reading is whole[0] else "doubled")
                continue
            late = bool(arrived) and reading[1] < max(arrived, key=lambda r: r[1])[1]
            self.assertEqual(answer.get("late", False), late)
            arrived.append(reading)
            expected.append((self.issue(line), sorted(arrived, key=lambda r: r[1])))
        self.assertEqual(len(arrived), len(sent) - 2)
        for line, known in expected[-15:]:  # the late ones are among them
            self.assertEqual(line, self.rolling(known, "--window", "25")[-1])

    def test_names_in_latin_1_stay_different(self):
        self.fleet("prometheus: all.prom\n")
        lines = b"station,time,displacement\nP\xe9,0,1\nP\xe8,0,2\nP\xc3\xa9,5,3\nP\x81,0,2\n"
        done = subprocess.run([PROGRAM, "watch", "fleet.yaml"], input=lines, capture_output=True, cwd=self.folder, check=True)
        said = [json.loads(line) for line in done.stdout.decode().splitlines()]
        self.assertEqual([line.get("station") for line in said], ["P\u00e9", "P\u00e8", "P\u00e9", None])
        self.assertIn("must be a name in UTF-8 or Latin-1", said[3]["error"])
        self.assertIn('lacuna_readings_total{station="P\u00e8"} 1\n', self.read("all.prom"))
        self.assertIn('lacuna_readings_total{station="P\u00e9"} 2\n', self.read("all.prom"))

    def test_dates_ahead_of_the_clock(self):
        """One in the future is dropped and said, and the readings that follow are taken; a day more or `.inf` takes it."""
        now = time.time()
        at = [now - 5 * DAY + k * DAY / 2 for k in range(8)]

        rows_of = [f"P1,{time.strftime('%Y-%m-%dT%H:%M:%SZ', time.gmtime(t))},{k * k}\n" for k, t in enumerate(at)]
        future = f"P1,{time.strftime('%Y-%m-%dT%H:%M:%SZ', time.gmtime(now + 1.5 * DAY))},99\n"
        stream = HEADER + "".join([*rows_of[:4], future, *rows_of[4:]])
        self.fleet("prometheus: all.prom\n")
        lines = self.watch(stream)
        self.assertEqual({key: json.loads(lines[4])[key] for key in ("dropped", "ahead")}, {"dropped": "ahead", "ahead": 1})
        self.assertEqual(lines[:4] + lines[5:], self.watch(HEADER + "".join(rows_of)))
        self.watch(stream)
        self.assertIn('lacuna_ahead_total{station="P1"} 1\n', self.read("all.prom"))
        self.assertIn('lacuna_readings_total{station="P1"} 8\n', self.read("all.prom"))
        for ahead in ('ahead: "2 day"\n', "ahead: .inf\n"):
            self.fleet(ahead)
            self.assertEqual(sum("dropped" in line for line in self.watch(stream)), 0, ahead)
        self.assertIn("ahead", self.call("watch", self.fleet("ahead: 3 mm\n"), status=2).stderr)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_what_was_ahead_stays_so_after_a_kill(self):
        """The journal has the clock at which its lines came: done again when a date is no more ahead, they say the same."""
        self.fleet('ahead: "1 s"\n')
        process = self.start("--state", "state", "-o", "out.jsonl")
        late = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(time.time() + 5))
        process.stdin.write((HEADER + f"P1,2024-01-01,1\nP1,{late},2\nP1,2024-01-02,3\n").encode())
        process.stdin.flush()
        self.wait_for(lambda: self.lines("out.jsonl") == 3)
        before = self.read("out.jsonl")
        process.kill()
        process.communicate()
        time.sleep(6)
        again = self.call("watch", "fleet.yaml", "--state", "state", "-o", "out.jsonl", "--json")
        self.assertEqual(json.loads(again.stdout)["ahead"], 1)
        self.assertEqual(self.read("out.jsonl"), before)
        self.assertIn('"dropped": "ahead"', before)

    def test_values_that_come_later(self):
        """A reading of a time that has no value yet is taken, as in a file."""
        self.fleet()
        got = [json.loads(line) for line in self.watch(HEADER + "A,0,1.0\nA,5,NA\nA,9,2\nA,5,1.5\nA,5,1.6\n")]
        self.assertEqual([line.get("late") for line in got], [None, None, None, True, None])
        self.assertEqual(got[4], {"station": "A", "time_s": 5, "dropped": "doubled", "doubled": 1})

    def test_wrong_lines_do_not_stop_it(self):
        self.fleet("most_stations: 2\n")
        said = HEADER + "A,0,1.0\nA,now,1\nB,0,NA\nA,1,much\nC,1,1\n,2,2\nA,2024-01-01,5\n\n# words\nA,1,2,3\n\"A,1\n" \
            + HEADER + "A,1,\x01\nB,1,2.0\n"
        got = [json.loads(line) for line in self.watch(said)]
        wrong = [line for line in got if "error" in line]
        self.assertEqual([line["bad"] for line in wrong], list(range(1, 9)))
        self.assertEqual([line["line"] for line in wrong], [3, 5, 6, 7, 8, 11, 12, 14])
        for line, says in zip(wrong, ('time: "now" must be', 'displacement: "much" must be a number', "one station more",
                                      'station: "" must be', "must be a number, as before", "more fields", "quote",
                                      "not text")):
            self.assertIn(says, line["error"])
        self.assertEqual([line["station"] for line in got if "error" not in line], ["A", "B", "B"])

    def test_long_lines(self):
        self.fleet()
        got = [json.loads(line) for line in self.watch(HEADER + "A,0,1\nA," + "1" * 200000 + "\nA,1,1\n")]
        self.assertEqual(["error" in line for line in got], [False, True, False])
        self.assertEqual(got[1]["error"], "the line is longer than 65535 bytes")

    def test_wrong_header_leaves_no_state(self):
        self.fleet()
        words = ("--state", "state", "-o", "out.jsonl")
        self.call("watch", "fleet.yaml", *words, stdin="a,b\n1,2\n", status=2)
        self.watch(text(rows("A", 3)), *words)
        self.assertEqual(self.lines("out.jsonl"), 3)

    def test_most_stations(self):
        self.fleet("most_stations: 2\n")
        got = [json.loads(line) for line in self.watch(HEADER + "A,0,1\nB,0,1\nC,0,1\nA,1,1\n")]
        self.assertEqual(["error" in line for line in got], [False, False, True, False])

    def test_end_without_end(self):
        self.fleet()
        done = self.call("watch", "fleet.yaml", stdin=HEADER + "A,0,1.0\nA,1,1.23")
        self.assertEqual(len(done.stdout.splitlines()), 1)
        self.assertIn("its last line has no end, and was not taken", done.stderr)

    def test_wrong_fleets(self):
        good = 'displacement: "d:mm"\n'
        for content, says in (("", "1: must be a mapping"), ("raw: true\n", "displacement: is missing"),
                              (good + "smoth: x\n", '2: smoth: is no key here; did you mean "smooth"?'),
                              (good + "window: {count: 1}\n", '2: window.count: "1" must be >= 2'),
                              (good + "window: {time: 5 m}\n", '2: window.time: "5 m" '),
                              (good + "smooth: avg\n", '2: --smooth: "avg" must be none, average:N'),
                              (good + "smooth: average:1\n", "a moving average must be of 2 or more"),
                              (good + "onset: 5\n", '2: --onset: "5" must be two numbers'),
                              ("displacement: d:kg\n", '1: displacement: "d:kg" the unit of the column'),
                              (good + "stations: [A]\n", "2: stations: is no key here"),
                              (good + "columns: [station, d]\n", '2: columns: lacks "time"'),
                              (good + "files: {A: a.csv}\nstream: replayed\n", "3: stream:"),
                              ("displacement: way_mm\n", "way_mm: has no unit, and its name says mm")):
            self.write("wrong.yaml", content)
            done = self.call("watch", "wrong.yaml", stdin=HEADER, status=2)
            self.assertIn("wrong.yaml:" if "no unit" not in says else "standard input", done.stderr)
            self.assertIn(says, done.stderr)
        self.fleet()
        for stdin, says in (("a,b\n1,2\n", 'standard input:1: has no column "station"'),
                            ("station;time\nA;5\n", 'standard input:1: has no column "displacement"')):
            self.assertIn(says, self.call("watch", "fleet.yaml", stdin=stdin, status=2).stderr)
        self.assertIn("needs -o", self.call("watch", "fleet.yaml", "--json", status=2).stderr)
        self.assertIn("--jsonl", self.call("precursors", "x.csv", "--jsonl", status=2).stderr)

    # What is kept.

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_same_bytes_after_kills(self):
        tool = os.path.join(SOURCE, "tools/studies/watch.py")
        done = subprocess.run([sys.executable, tool, "--lacuna", PROGRAM, "--stations", "10", "--readings", "45",
                               "--kills", "12", "--window", "30", "--json"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        found = json.loads(done.stdout)
        self.assertTrue(found["same"])
        self.assertGreater(found["issuing"], 10)
        self.assertGreater(found["late"] + found["doubled"] + found["bad"], 5)

    def every_call(self, action):
        """Killed at each file call in turn, then sent again from the beginning."""
        self.fleet("stream: replayed\ncheckpoint: {lines: 4}\nwindow: {count: 5}\nprometheus: out.prom\n")
        said = text(turns(*(rows(name, 5) for name in "ABC"))) + "A,x,1\n"
        whole = "\n".join(self.watch(said)) + "\n"
        words = ("--state", "state", "-o", "out.jsonl", "-q")
        call, killed = 0, True
        while killed:
            call += 5 if "LACUNA_SANITIZED" in os.environ else 1
            shutil.rmtree(self.path("state"), ignore_errors=True)
            for name in os.listdir(self.folder):
                if name.startswith("out"):
                    os.remove(self.path(name))
            env = dict(os.environ, LD_PRELOAD=LIBRARY, AT_CALL=f"{call}:{action}", AT_CALL_UNDER=self.folder,
                       ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0")
            done = subprocess.run([PROGRAM, "watch", "fleet.yaml", *words], input=said, text=True, cwd=self.folder,
                                  capture_output=True, env=env, check=False)
            killed = done.returncode == -signal.SIGKILL
            if killed:
                self.watch(said, *words)
            self.assertEqual(self.read("out.jsonl"), whole, f"killed at call {call}")
            self.assertIn('lacuna_readings_total{station="A"} 5', self.read("out.prom"))
        self.assertGreater(call, 30)

    def test_killed_at_every_call(self):
        self.every_call("kill")

    def test_torn_at_every_call(self):
        self.every_call("tear")

    def test_live_stream_goes_on(self):
        """What was sent before a kill is not sent again, and stands in the journal."""
        series = turns(*(rows(name, 12) for name in "ABC"))
        self.fleet("window: {count: 8}\n")
        whole = self.watch(text(series))
        for at, piece in enumerate((series[:10], series[10:21], series[21:])):
            process = self.start("--state", "state", "-o", "out.jsonl")
            process.stdin.write(text(piece, HEADER if at != 1 else "").encode())
            process.stdin.flush()
            want = len(series[:10]) if at == 0 else 21 if at == 1 else 36
            self.wait_for(lambda want=want: self.lines("out.jsonl") == want)
            process.send_signal(signal.SIGKILL if at < 2 else signal.SIGTERM)
            self.assertEqual(process.wait(), -signal.SIGKILL if at < 2 else 4)
        self.assertEqual(self.read("out.jsonl").splitlines(), whole)

    def test_state_of_others(self):
        said = text(rows("A", 5))
        words = ("--state", "state", "-o", "out.jsonl")
        self.fleet("stream: replayed\n")
        self.watch(said, *words)
        self.assertEqual(self.lines("out.jsonl"), 5)
        self.watch(said + "A,900000,5\n", *words)  # has grown
        self.assertEqual(self.lines("out.jsonl"), 6)
        other = self.call("watch", "fleet.yaml", *words, stdin=said.replace("1", "2") + "A,900000,5\nA,9e5,5\n", status=2)
        self.assertIn("its first 7 lines are not those that state was made from", other.stderr)
        short = self.call("watch", "fleet.yaml", *words, stdin=said, status=2)
        self.assertIn("ended 1 lines before", short.stderr)
        self.assertEqual(self.lines("out.jsonl"), 6)
        self.fleet("stream: replayed\nwindow: {count: 7}\n")
        self.assertIn('state/state: was made with other settings: "window.count: 2000", which is "window.count: 7"',
                      self.call("watch", "fleet.yaml", *words, stdin=said, status=2).stderr)
        self.fleet("stream: replayed\n")
        self.write("out.jsonl", "")
        self.assertIn("is not the output that state goes on from",
                      self.call("watch", "fleet.yaml", *words, stdin=said, status=2).stderr)
        self.write("state/state", "what")
        self.assertIn("is damaged", self.call("watch", "fleet.yaml", *words, stdin=said, status=2).stderr)
        self.write("there.jsonl", "x\n")
        self.assertIn("exists already", self.call("watch", "fleet.yaml", "-o", "there.jsonl", status=2).stderr)

    def test_damaged_state(self):
        self.fleet()
        self.watch(text(rows("A", 5)), "--state", "state", "-o", "out.jsonl")
        with open(self.path("state/state"), "r+b") as file:
            whole = bytearray(file.read())
            for at in range(8, len(whole), 11):
                file.seek(0)
                file.write(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1:])
                file.flush()
                done = subprocess.run([PROGRAM, "watch", "fleet.yaml", "--state", "state", "-o", "out.jsonl"],
                                      stdin=subprocess.DEVNULL, capture_output=True, text=True, cwd=self.folder, check=False)
                self.assertIn(done.returncode, (2, 1), done.stderr)
                self.assertIn("lacuna: ", done.stderr)

    def test_one_at_a_time(self):
        self.fleet()
        process = self.start("--state", "state", "-o", "out.jsonl")
        self.wait_for(lambda: os.path.exists(self.path("state/state")))
        self.assertIn("another lacuna watch", self.call("watch", "fleet.yaml", "--state", "state", status=3).stderr)
        process.terminate()
        self.assertEqual(process.wait(), 4)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_memory_is_bound(self):
        with open(PROGRAM, "rb") as program:
            if b"__asan_init" in program.read():
                self.skipTest("a sanitizer keeps freed memory")
        self.fleet("most_stations: 200\nwindow: {count: 50}\n")
        said = text(turns(*(rows(f"P{k}", 60) for k in range(200))))
        many = json.loads(self.call("watch", "fleet.yaml", "-o", "many.jsonl", "--json", stdin=said).stdout)
        few = json.loads(self.call("watch", "fleet.yaml", "-o", "few.jsonl", "--json", stdin=text(rows("A", 60))).stdout)
        self.assertEqual(many["readings"], 12000)
        grown = many["peak_memory_bytes"] - few["peak_memory_bytes"]
        self.assertLess(grown, many["memory_of_stations_at_most_bytes"] + 1e6)  # and what malloc takes beside
        self.assertLess(many["memory_of_stations_at_most_bytes"], 200 * 60 * 40)

    # Files, and Prometheus.

    def followed(self, *words):
        return self.start("--state", "state", "-o", "out.jsonl", *words, stdin=subprocess.DEVNULL)

    def test_no_file_is_followed_and_written(self):
        self.fleet('files: "in/*.csv"\n')
        os.mkdir(self.path("in"))
        head = "time,displacement\n0,1.0\n"
        self.write("in/A.csv", head)
        process = self.start("-o", "in/A.csv", "--force", stdin=subprocess.DEVNULL)
        self.assertEqual(process.wait(), 2)
        self.assertEqual(self.read("in/A.csv"), head)

    def test_files_that_grow(self):
        series = {name: rows(name, 14) for name in "AB"}
        self.fleet('files: "in/*.csv"\nwindow: {count: 9}\nprometheus: out.prom\n')
        os.mkdir(self.path("in"))
        head = "time,displacement\n"

        def put(name, first, last, to=None, mode="a"):
            here = "".join(f"{at:.0f},{moved:.1f}\n" for _, at, moved in series[name][first:last])
            self.write(f"in/{to or name + '.csv'}", (head if mode == "w" else "") + here, mode)

        put("A", 0, 4, mode="w")
        process = self.followed()
        self.wait_for(lambda: self.lines("out.jsonl") == 4)
        put("B", 0, 3, mode="w")  # one more file
        self.write("in/A.csv", f"{series['A'][4][1]}", "a")  # a line that has no end yet
        self.wait_for(lambda: self.lines("out.jsonl") == 7)
        self.write("in/A.csv", f",{series['A'][4][2]:.1f}\n", "a")
        self.wait_for(lambda: self.lines("out.jsonl") == 8)
        os.rename(self.path("in/A.csv"), self.path("in/A.old"))  # rotated, and written to after that
        put("A", 5, 7, to="A.old")
        put("A", 7, 8, mode="w")
        self.wait_for(lambda: self.lines("out.jsonl") == 11)
        written = os.stat(self.path("out.jsonl")).st_mtime_ns  # the state knows of the new file then
        self.wait_for(lambda: os.stat(self.path("state/state")).st_mtime_ns >= written)
        process.kill()
        process.wait()
        put("A", 8, 9)  # and while nobody watches
        os.rename(self.path("in/A.csv"), self.path("in/A.older"))
        put("A", 9, 10, mode="w")
        process = self.followed()
        self.wait_for(lambda: self.lines("out.jsonl") == 13)
        put("A", 10, 12, mode="w")  # cut, and longer than it was
        put("B", 3, 6)
        self.write("in/B.csv", "1" * 150000 + "\n", "a")
        put("B", 6, 14)
        self.write("in/C.csv", "what,is\nthis,now\n")
        self.wait_for(lambda: self.lines("out.jsonl") == 29)
        put("A", 12, 14)
        self.wait_for(lambda: self.lines("out.jsonl") == 31)
        process.terminate()
        self.assertEqual(process.wait(), 4)
        got = self.read("out.jsonl").splitlines()
        wrong = [json.loads(line)["error"] for line in got if '"error"' in line]
        self.assertEqual(sorted(wrong), ['has no column "time"', 'has no column "time"', "the line is longer than 65535 bytes"])
        for name, readings in series.items():
            own = [self.issue(line) for line in got if f'"station": "{name}"' in line and "issue" in line]
            self.assertEqual(own, self.rolling(readings, "--window", "9"))
        self.assertIn('lacuna_readings_total{station="A"} 14\n', self.read("out.prom"))

    def test_prometheus(self):
        self.fleet("prometheus: out.prom\nhorizon: 20 day\n")
        series = turns(rows('a"\\b', 40, fails=True, noise=0.2), rows("B", 40))
        said = text(series).replace('a"\\b', '"a""\\b"') + "B,soon,1\nidle,0,NA\n" + text(series[1:2], "")
        got = [json.loads(line) for line in self.watch(said)]
        last = [line for line in got if line.get("station") == 'a"\\b'][-1]
        value = dict(line.rsplit(" ", 1) for line in self.read("out.prom").splitlines() if line[0] != "#")
        label = '{station="a\\"\\\\b"}'
        self.assertEqual(float(value["lacuna_last_reading_seconds" + label]), 39 * DAY)
        issued = [f for f in last["forecasts"] if f["issued"] and f["method"] != "persistence"]
        self.assertGreater(len(issued), 2)
        self.assertEqual(int(value["lacuna_forecasts" + label]), len(issued))
        near = [f for f in issued if f["tc_s"] <= (39 + 20) * DAY]
        self.assertEqual(int(value["lacuna_alarms" + label]), len(near))
        level = ("quiet", "watch", "warning", "alarm").index(last["verdict"]["level"])
        self.assertEqual(value["lacuna_level" + label], str(level))
        self.assertGreater(level, 0)
        self.assertTrue(0 <= float(value["lacuna_chance_within_horizon" + label]) <= 1)
        self.assertEqual(value['lacuna_level{station="idle"}'], "0")
        self.assertEqual(value['lacuna_chance_within_horizon{station="idle"}'], "NaN")
        self.assertEqual(value["lacuna_accelerating" + label], "1")
        at, moved = [r[1] for r in series[-4::2]], [round(r[2], 1) for r in series[-4::2]]
        self.assertAlmostEqual(float(value["lacuna_rate_meters_per_second" + label]),
                               1e-3 * (moved[1] - moved[0]) / (at[1] - at[0]), delta=1e-12)
        self.assertEqual(value['lacuna_readings_total{station="idle"}'], "1")
        self.assertEqual(value['lacuna_rate_meters_per_second{station="idle"}'], "NaN")
        self.assertEqual(value['lacuna_doubled_total{station="B"}'], "1")
        self.assertEqual(value["lacuna_bad_lines_total"], "1")

    # With MQTT, as docs/howto-watch.md has it.

    def free_port(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            return taken.getsockname()[1]

    def is_open(self, port):
        with socket.socket() as client:
            return client.connect_ex(("127.0.0.1", port)) == 0

    @unittest.skipUnless(shutil.which("mosquitto_sub"), "mosquitto is not installed")
    def test_mqtt(self):
        broker = shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin")
        if broker is None:
            self.skipTest("the broker mosquitto is not installed")
        with open(os.path.join(SOURCE, "docs/howto-watch.md"), encoding="utf-8") as page:
            commands = re.search(r"^```bash\n(.*?)^```", page.read(), re.M | re.S).group(1)
        port = self.free_port()
        self.write("broker.conf", f"listener {port} 127.0.0.1\nallow_anonymous true\n")
        path = os.path.dirname(PROGRAM) + os.pathsep + os.environ["PATH"]
        where = dict(os.environ, PATH=path, BROKER="127.0.0.1", PORT=str(port))
        to = ["-h", "127.0.0.1", "-p", str(port)]

        def begin(words, **how):
            process = subprocess.Popen(words, cwd=self.folder, env=where, start_new_session=True, **how)
            self.addCleanup(process.wait)
            self.addCleanup(lambda: process.poll() is None and os.killpg(process.pid, signal.SIGKILL))
            return process

        begin([broker, "-c", "broker.conf"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        self.wait_for(lambda: self.is_open(port))
        with open(self.path("got.jsonl"), "wb") as got:
            begin(["mosquitto_sub", *to, "-i", "reader", "-c", "-q", "1", "-t", "slopes/forecasts"], stdout=got)
        begin(["sh", "-c", commands])
        readings = rows("P1", 12)

        def publish(some):
            subprocess.run(["mosquitto_pub", *to, "-q", "1", "-l", "-t", "slopes/readings"], text=True, check=True,
                           env=where, input=text(some, header=""))

        def answered():  # what is published before somebody subscribes is nobody's
            publish(readings[:1])
            time.sleep(0.1)
            return self.lines("got.jsonl") > 0

        self.wait_for(answered)
        publish(readings[1:])
        self.wait_for(lambda: self.read("got.jsonl").count('"issue_time_s"') == 12)
        own = [self.issue(line) for line in self.read("got.jsonl").splitlines() if "issue_time_s" in line]
        self.assertEqual(own, self.rolling(readings, "--window", "2000"))


if __name__ == "__main__":
    PROGRAM, SOURCE, LIBRARY = [os.path.abspath(word) for word in sys.argv[1:4]]
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
