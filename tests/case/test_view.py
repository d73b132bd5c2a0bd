#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna run --view` over HTTP: what it serves to whom, while a run is held still and as it ends.

usage: test_view.py PROGRAM SOURCE_FOLDER HOLD_AT_CHECKPOINT [unittest options]
"""

import ctypes
import json
import os
import pty
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4

import report_scenes as scenes
import view_run

PROGRAM, SOURCE, HOLD = "", "", ""

# Hundreds of steps of 64 cells, to failure: records, snapshots, levels, events, checkpoints.
CASE = """\
lacuna: 1
title: A slope that is "watched" & <told>
interface: {size: "1 m", levels: 3, domain: {full: {}}}
load:
  normal: {pressure: "3 MPa"}
  pore_pressure: [{step: {value: "0.005 MPa", at: "4 hour"}}]
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "0.1 mm", v0: "1 um/s"}}
initial:
  slip_rate: "1 cm/week"
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 2}}}
material: {shear_modulus: "20 GPa", poisson: 0.25, shear_speed: "3 km/s"}
transfer: {hierarchy: {k0: 10 GPa/m, ratio: 0.5}}
time: {end: "30 day", failure: {mean_slip_rate: "10 um/s"}}
analysis: {rg: {critical_fraction: 0.5}, events: {slip_rate: "1 um/s"}}
output: {every: {steps: 5}, fields: [slip_rate, slip, traction], fields_every: {steps: 20}, checkpoint: {steps: 40}}
"""

# A block on a surface that is large enough for two threads to make it.
SURFACE = """\
lacuna: 1
interface: {size: "1 m", levels: 8, surface: {self-affine: {hurst: 0.8, rms_slope: 0.1, seed: 1}}}
material: {shear_modulus: "15 GPa", poisson: 0.25}
load: {normal: {pressure: "20 MPa"}}
friction: {aging: {a: 0.010, b: 0.015, dc: "4 um"}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.5}}
time: {end: "1 s"}
"""

# Of the data, what is of their making and not of the run.
OWN = {"made", "made_by", "date_created", "date_modified", "wall_time_s", "file", "history", "source"}


def contents(path):
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        return {name: variable[...].tobytes() for name, variable in file.variables.items()}


def running(run):
    return run["state"] == "running" and run["version"] > 0


def ended(run):
    return run["last"]


def others(process):
    """Threads of a process but its first."""
    return [int(thread) for thread in os.listdir(f"/proc/{process}/task") if int(thread) != process]


def blocks(process, thread, number):
    """Whether a thread takes no such signals."""
    with open(f"/proc/{process}/task/{thread}/status", encoding="ascii") as file:
        masks = dict(line.split(":", 1) for line in file)
    return bool(int(masks["SigBlk"], 16) >> (number - 1) & 1)


def of_the_run(data):
    """The data without what is of their own making, and without where the run stands."""
    own = {key: value for key, value in data["about"].items() if key not in OWN}
    return {key: value for key, value in data.items() if key != "run"} | {"about": own}


class View(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-view-")
        self.addCleanup(shutil.rmtree, self.folder)

    def start(self, *words, counts=(2,), case=CASE, **more):
        run = view_run.Run(PROGRAM, HOLD, self.folder, case, *words, counts=counts, **more)
        self.addCleanup(run.process.stdout.close)
        self.addCleanup(run.process.stderr.close)
        self.addCleanup(run.process.wait)
        self.addCleanup(run.process.kill)
        return run

    def page(self, run, since=0):
        page = view_run.Page(run.port, since)
        self.addCleanup(page.close)
        return page

    def finish(self, run, held=None, status=0):
        if held is not None:
            run.release(held)
        code, out, err = run.end()
        self.assertEqual(code, status, err)
        return out, err

    def report(self, path):
        done, _, wrong = scenes.report(PROGRAM, path, "-o", path + ".html", "--force")
        self.assertEqual(done, 0, wrong)
        return scenes.data_of(path + ".html")

    def test_page(self):
        run = self.start()
        held = run.wait_until_held(2)
        status, headers, text = run.ask("/")
        self.assertEqual(status, 200)
        self.assertEqual(headers["Content-Type"], "text/html; charset=utf-8")
        self.assertEqual(headers["Cache-Control"], "no-store")
        self.assertNotIn("Access-Control-Allow-Origin", headers)
        policy = dict(part.split(" ", 1) for part in headers["Content-Security-Policy"].split("; "))
        self.assertEqual(policy["default-src"], "'none'")
        nonce = policy["script-src"].strip("'").removeprefix("nonce-")
        self.assertEqual(len(nonce), 32)
        self.assertEqual(text.count(f'<script nonce="{nonce}">'), text.count("<script") - 1)  # all but the data
        self.assertEqual(text.count(f'<style nonce="{nonce}">'), text.count("<style"))
        self.assertNotIn("@TITLE@", text)
        self.assertNotIn("@DATA@", text)
        self.assertNotEqual(run.ask("/")[1]["Content-Security-Policy"], headers["Content-Security-Policy"])
        for path in ("/", "/data", "/data?since=0"):
            self.assertEqual(run.ask(path, "HEAD")[::2], (200, ""))
        self.finish(run, held)

    def test_what_is_refused(self):
        run = self.start()
        held = run.wait_until_held(2)
        for path in ("/out.nc", "/c.yaml", "/../c.yaml", "/..%2fc.yaml", "//etc/passwd", "/data/", "/events", "/page.css", "/%00",
                     "/d%61ta", "/" + "x" * 5000):
            self.assertEqual(run.ask(path)[0], 404, path)
        for path in ("/" + "x" * 100000, "/data?since=" + "1" * 100000):
            self.assertEqual(run.ask(path)[0], 414, path[:20])
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"):
            status, headers, _ = run.ask("/data", method, body=None if method in ("OPTIONS", "TRACE") else "x")
            self.assertEqual((status, headers["Allow"]), (405, "GET, HEAD"), method)
        names = {"127.0.0.1": 200, "localhost": 200, "LOCALHOST": 200, "evil.example": 403, "127.0.0.1.evil.example": 403, "[::1]": 403}
        for name, status in names.items():
            self.assertEqual(run.ask("/", headers={"Host": f"{name}:{run.port}"})[0], status, name)
        self.assertEqual(run.ask("/data", headers={"Host": "127.0.0.1"})[0], 403)
        self.assertEqual(run.ask("/data", headers={"Host": f"127.0.0.1:{run.port + 1}"})[0], 403)
        self.finish(run, held)

    def test_binds_to_loopback_alone(self):
        run = self.start()
        held = run.wait_until_held(2)
        for family in ("tcp", "tcp6"):
            with open(f"/proc/{run.process.pid}/net/{family}", encoding="ascii") as file:
                local = [line.split()[1] for line in file if line.split()[3] == "0A"]
            mine = [address for address in local if int(address.split(":")[1], 16) == run.port]
            self.assertEqual(mine, ["0100007F:%04X" % run.port] if family == "tcp" else [])
        self.finish(run, held)

    def kept(self, run):
        """The page's data from the file of a held run, which its checkpoint has flushed."""
        copy = os.path.join(self.folder, "copy.nc")
        shutil.copy(run.path, copy)
        return self.report(copy)

    def test_data_are_those_of_the_report(self):
        """Of a held run, made from memory, against its file up to there; in the end, and after it."""
        run = self.start(counts=(2, 6))
        page = self.page(run)
        page.ask()
        for count, least in ((2, 2), (6, 6)):
            held = run.wait_until_held(count)
            file = self.kept(run)
            told = run.data_of(file["about"]["records"])
            self.assertEqual(told["about"]["status"], "running")
            self.assertEqual(told["about"]["title"], 'A slope that is "watched" & <told>')
            self.assertGreater(len(told["cells"]["snapshot_time"]), least)
            self.assertEqual(told.pop("run")["state"], "running")
            sections = set(file) - {"about", "forecasts"}  # a live page makes fewer forecasts, as time allows
            self.assertLessEqual({"motion", "solver", "cells", "levels"}, sections)
            self.assertEqual(set(told) - {"about", "forecasts"}, sections)
            for section in sections:
                self.assertEqual(told[section], file[section], section)
            for key in set(file["about"]) - OWN:
                self.assertEqual(told["about"].get(key), file["about"][key], key)
            run.release(held)
            page.ask()
        end = page.until(ended)
        self.assertEqual((end["state"], end["message"]), ("failure", ""))
        final = page.data
        self.finish(run)
        self.assertEqual(of_the_run(final), of_the_run(self.report(run.path)))

    def test_what_is_new(self):
        """A page is given the data that it does not have, and where the run stands every time."""
        run = self.start()
        held = run.wait_until_held(2)
        page = self.page(run)
        first = page.until(running)
        self.assertGreater(page.data["motion"]["records"], 2)
        for key in ("time", "end", "rate", "steps"):
            self.assertGreater(first[key], 0, key)
        self.assertEqual((first["last"], first["missing"], first["message"]), (False, False, ""))
        self.assertEqual(page.until(lambda run: page.told == {}), first)  # nothing new: a run that is held
        for since in ("", "x", "-1", "1e3", "0x10", "999999999999999", "9" * 40, f"{page.since - 1}", f"{page.since + 1}", "%30", "0&since=1"):
            told = json.loads(run.ask("/data?since=" + since)[2])
            self.assertEqual(told["run"]["version"], page.since, since)
            self.assertEqual(told["motion"], page.data["motion"], since)
        for query in ("", "?", "?since", "?page=1"):
            self.assertEqual(json.loads(run.ask("/data" + query)[2])["motion"], page.data["motion"], query)
        run.release(held)
        page.until(lambda run: run["version"] > first["version"])
        self.assertEqual(page.until(ended)["state"], "failure")
        self.assertEqual(page.data["about"]["failed"], 1)
        self.finish(run)

    def test_before_the_first_step(self):
        """While the scene is made there is only the state."""
        run = self.start(counts=(), case=SURFACE)
        page = self.page(run)
        state = page.ask()
        if page.data is None:  # the machine may be quicker
            self.assertEqual((state["state"], state["version"], page.told), ("preparing", 0, {}))
        page.until(ended)
        self.assertEqual(page.data["about"]["status"], "complete")
        self.finish(run)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_forecasts_reach_every_page(self):
        """They come with few of the data: a page that asks rarely is given those first."""
        run = self.start(counts=(6, 7))
        held = run.wait_until_held(6)
        page = self.page(run)
        page.until(running)
        self.assertIn("forecasts", page.data)
        had = page.since
        run.release(held)
        held = run.wait_until_held(7)
        page.until(lambda run: run["version"] > had)
        late = self.page(run, had - 1)
        if "forecasts" not in page.data:  # they may have been due again
            late.ask()
            self.assertEqual(late.since, had)
            self.assertIn("forecasts", late.data)
        late.until(lambda run: run["version"] == page.since)
        self.finish(run, held)

    def test_two_pages(self):
        """Both see the same, and both see the end, the one that had gone for a while too."""
        run = self.start()
        held = run.wait_until_held(2)
        pages = [self.page(run), self.page(run)]
        for page in pages:
            page.until(running)
        self.assertEqual(pages[0].data, pages[1].data)
        pages[1].close()
        run.release(held)
        pages[1].ask()  # is back, and waited for
        for page in pages:
            self.assertEqual(page.until(ended)["state"], "failure")
        self.assertEqual(pages[0].data, pages[1].data)
        self.finish(run)

    def test_who_goes_midway(self):
        """A client that is gone before its answer is there, or while it is sent, takes nothing along."""
        run = self.start()
        held = run.wait_until_held(2)
        whole = run.data_of(3)
        for size in (0, 1, 1000):
            for path in ("/", "/data", "/data?since=0"):
                for _ in range(10):
                    with socket.create_connection(("127.0.0.1", run.port)) as gone:
                        gone.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # reset
                        gone.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{run.port}\r\n\r\n".encode())
                        if size:
                            gone.recv(size)
        self.assertEqual(run.data()["motion"], whole["motion"])
        self.assertEqual(len(others(run.process.pid)), 1)
        self.finish(run, held)

    def test_many_and_hanging_pages(self):
        run = self.start()
        held = run.wait_until_held(2)
        silent = [socket.create_connection(("127.0.0.1", run.port)) for _ in range(4)]
        silent[0].sendall(b"GET / HTTP/1.1\r\nHost: ")  # and never goes on
        deaf = socket.create_connection(("127.0.0.1", run.port))  # asks, never reads
        deaf.sendall(b"GET /data HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % run.port)
        pages = [self.page(run) for _ in range(16)]
        for page in pages:
            page.until(running)
        self.assertEqual(len(others(run.process.pid)), 1)  # one thread for all of them
        self.assertEqual(run.ask("/")[0], 200)
        self.finish(run, held)
        for connection in (*silent, deaf):
            connection.close()

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_slow_connections_keep_nobody_out(self):
        """Ever more that send a byte now and then, or read none: page and data come as before."""
        run = self.start()
        held = run.wait_until_held(2)
        head = f"GET /data HTTP/1.1\r\nHost: 127.0.0.1:{run.port}\r\n".encode()
        watched = [self.page(run) for _ in range(3)]
        slow, html = [], run.ask("/")[2]
        for i in range(100):
            slow.append(socket.create_connection(("127.0.0.1", run.port)))
            slow[-1].sendall(head + (b"\r\n" if i % 3 == 0 else b"X: "))  # every third never reads
            for connection in slow[-40:]:
                try:
                    connection.sendall(b"x")  # a sign of life: no idle time ends these
                except OSError:
                    pass  # shown out
            if i % 9 == 8:
                began = time.monotonic()
                self.assertEqual(len(run.ask("/")[2]), len(html))
                self.assertEqual(run.data()["about"]["title"], run.data()["about"]["title"])
                for page in watched:  # they ask often enough to be let alone
                    self.assertEqual(page.ask()["state"], "running")
                self.assertLess(time.monotonic() - began, 5)
        for page in watched:
            self.assertIsNotNone(page.data)
        self.finish(run, held)
        for connection in slow:
            connection.close()

    def test_outputs_are_the_same(self):
        run = self.start(counts=(), name="viewed.nc")
        self.page(run).until(ended)
        out, err = self.finish(run)
        self.assertEqual(err.count("http://"), 1)
        plain = subprocess.run([PROGRAM, "run", "c.yaml", "-o", "plain.nc"], cwd=self.folder, capture_output=True, text=True, check=True)
        self.assertEqual(contents(run.path), contents(os.path.join(self.folder, "plain.nc")))
        own = ("time taken", "peak memory", "file ", "http")
        kept = [[line for line in text.splitlines() if not any(word in line for word in own)] for text in (out, plain.stdout)]
        self.assertEqual(kept[0], kept[1])

    def libraries(self, *words):
        """What the dynamic linker says of a whole run."""
        folder = tempfile.mkdtemp(dir=self.folder)
        subprocess.run([PROGRAM, "run", os.path.abspath(os.path.join(SOURCE, "cases/block.yaml")), "-o", "x.nc", *words], cwd=folder,
                       capture_output=True, check=True, env=os.environ | {"LD_DEBUG": "libs", "LD_DEBUG_OUTPUT": os.path.join(folder, "ld")})
        with open(next(os.path.join(folder, n) for n in os.listdir(folder) if n.startswith("ld")), encoding="utf-8", errors="replace") as file:
            return file.read()

    def test_without_it_nothing_is_loaded(self):
        plain = self.libraries()
        self.assertIn("libnetcdf", plain)
        self.assertNotIn("microhttpd", plain)
        self.assertIn("microhttpd", self.libraries("--view", "0"))

    def test_json_and_quiet(self):
        run = self.start("--json", "-q", counts=())
        out, err = self.finish(run)
        self.assertEqual(json.loads(out)["status"], "complete")
        self.assertEqual(err.strip(), f"lacuna: the run is to be seen at http://127.0.0.1:{run.port}/")

    def test_ports(self):
        run = self.start()
        held = run.wait_until_held(2)
        for words in ([f"--view={run.port}"], ["--view", str(run.port)]):
            taken = subprocess.run([PROGRAM, "run", "c.yaml", "-o", "other.nc", *words], cwd=self.folder, capture_output=True, text=True, check=False)
            self.assertEqual(taken.returncode, 2)
            self.assertEqual(taken.stderr.count("\n"), 1, taken.stderr)
            self.assertIn(f"port {run.port} of 127.0.0.1", taken.stderr)
            self.assertFalse(os.path.exists(os.path.join(self.folder, "other.nc")))
        for word, said in (("--view=no", "\"no\" must be a port"), ("--view=65536", "\"65536\" must be a port"), ("--view=", "needs a value")):
            wrong = subprocess.run([PROGRAM, "run", "c.yaml", "-o", "other.nc", word], cwd=self.folder, capture_output=True, text=True, check=False)
            self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
            self.assertIn(said, wrong.stderr)
        self.finish(run, held)

    def test_port_after_and_case_after(self):
        """--view takes the next word only where that is a number."""
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        run = self.start(str(port), counts=())  # after --view
        self.assertEqual(run.port, port)
        self.finish(run)
        done = subprocess.run([PROGRAM, "run", "--view", "c.yaml", "--force", "-o", "out.nc"], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_interrupted(self):
        run = self.start()
        held = run.wait_until_held(2)
        page = self.page(run)
        page.until(running)
        run.process.send_signal(signal.SIGINT)
        run.release(held)
        end = page.until(ended)
        self.assertEqual(end["state"], "interrupted")
        self.assertIn("--resume goes on", end["message"])
        self.assertEqual(page.data["about"]["status"], "interrupted")
        self.finish(run, status=4)

    def test_resumed(self):
        """The page of a run that goes on begins with what the run before it has put out."""
        run = self.start(counts=(3,))
        held = run.wait_until_held(3)
        run.process.send_signal(signal.SIGTERM)
        self.finish(run, held, status=4)
        before = self.report(run.path)
        again = self.start("--resume", counts=(1,))
        held = again.wait_until_held(1)
        file = self.kept(again)
        told = again.data_of(file["about"]["records"])
        for section in ("motion", "cells", "levels"):
            self.assertEqual(told[section], file[section], section)
        kept = before["motion"]["records"] - 1  # the last is where it was stopped
        self.assertGreater(kept, 10)
        self.assertEqual(told["motion"]["slip"][:kept], before["motion"]["slip"][:kept])
        page = self.page(again)
        page.ask()
        again.release(held)
        page.until(ended)
        self.finish(again)
        self.assertEqual(of_the_run(page.data), of_the_run(self.report(again.path)))

    def test_a_run_that_breaks_off(self):
        run = self.start("--set", "solver.max_steps=60", counts=(1,))
        held = run.wait_until_held(1)
        page = self.page(run)
        page.until(running)
        run.release(held)
        end = page.until(ended)
        self.assertEqual(end["state"], "failed")
        self.assertIn("60", end["message"])
        self.assertEqual(page.data["about"]["status"], "failed")
        self.finish(run, status=1)

    def run_to_its_end(self, case, *words, **more):
        """A run at a terminal, whose page stays: the process, and what it said."""
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        with open(os.path.join(self.folder, "c.yaml"), "w", encoding="utf-8") as file:
            file.write(case)
        process = subprocess.Popen([PROGRAM, "run", "c.yaml", "-o", "out.nc", "--view", "--no-progress", *words],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=slave, env=os.environ | more)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        os.close(slave)
        text = b""
        while b"until Ctrl-C" not in text:
            text += os.read(master, 4096)
        return process, text.decode()

    def test_on_a_terminal_it_stays(self):
        process, text = self.run_to_its_end(CASE)
        run = view_run.Run.__new__(view_run.Run)
        run.port = int(view_run.ADDRESS.search(text).group(1))
        page = self.page(run)
        self.assertEqual(page.until(ended)["state"], "failure")
        self.assertEqual(of_the_run(page.data), of_the_run(self.report(os.path.join(self.folder, "out.nc"))))
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 0)

    def test_a_signal_to_another_thread_ends_it(self):
        """The kernel may give Ctrl-C to any thread that takes it: here one that makes surfaces."""
        process, _ = self.run_to_its_end(SURFACE, "--threads", "2", OMP_THREAD_LIMIT="2")
        takes = [thread for thread in others(process.pid) if not blocks(process.pid, thread, signal.SIGINT)]
        self.assertEqual(len(takes), 1)
        self.assertEqual(ctypes.CDLL(None).tgkill(process.pid, takes[0], int(signal.SIGINT)), 0)
        self.assertEqual(process.wait(timeout=60), 0)


if __name__ == "__main__":
    PROGRAM, SOURCE, HOLD = sys.argv[1:4]
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
