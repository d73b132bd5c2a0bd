# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that are looked at while they go on: held at checkpoints, their address read off stderr."""

import http.client
import json
import os
import re
import subprocess
import time

ADDRESS = re.compile(r"http://127\.0\.0\.1:(\d+)/")


class Run:
    """`lacuna run --view` in a folder, held where its checkpoints of these counts are made."""

    def __init__(self, program, hold, folder, case, *words, counts=(), name="out.nc"):
        self.fifo = os.path.join(folder, "hold")
        self.path = os.path.join(folder, name)
        environment = dict(os.environ)
        if counts:
            for count in counts:
                os.mkfifo(f"{self.fifo}.{count}")
            options = os.environ.get("ASAN_OPTIONS", "")
            environment |= {"LD_PRELOAD": hold, "ASAN_OPTIONS": options + ":verify_asan_link_order=0",
                            "HOLD_AT_CHECKPOINT": ",".join(map(str, counts)) + ":" + self.fifo}
        with open(os.path.join(folder, "c.yaml"), "w", encoding="utf-8") as file:
            file.write(case)
        self.process = subprocess.Popen([program, "run", "c.yaml", "-o", name, "--view", *words], cwd=folder, text=True,
                                        env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.line = self.process.stderr.readline()
        found = ADDRESS.search(self.line)
        self.port = int(found.group(1)) if found else None

    def wait_until_held(self, count):
        """Returns once the run stands still at that checkpoint, with what `release` takes."""
        return os.open(f"{self.fifo}.{count}", os.O_WRONLY)  # waits for who reads

    @staticmethod
    def release(held):
        os.close(held)

    def end(self, timeout=60):
        """Its exit status, what it printed and what it complained of."""
        out, err = self.process.communicate(timeout=timeout)
        return self.process.returncode, out, self.line + err

    def ask(self, path="/", method="GET", headers=None, body=None):
        """One request: status, headers, text."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.request(method, path, body, headers or {})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read().decode()
        finally:
            connection.close()

    def data(self):
        """The newest data, as of a script that asks once."""
        status, _, text = self.ask("/data")
        assert status == 200, text
        return json.loads(text)

    def data_of(self, records):
        """The data once they tell of so many records, which a held run has put out."""
        data = self.data()
        while "motion" not in data or data["motion"]["records"] < records:
            time.sleep(0.1)
            data = self.data()
        return data


class Page:
    """One that asks again and again what is new, as a browser does: on a connection that stays."""

    def __init__(self, port, since=0):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        self.since, self.data, self.told = since, None, None

    def ask(self):
        """Where the run stands; new data, where they came, are in `data`."""
        self.connection.request("GET", f"/data?since={self.since}")
        answer = self.connection.getresponse()
        assert answer.status == 200, answer.status
        told = json.loads(answer.read())
        run = told.pop("run")
        self.data, self.since, self.told = told or self.data, run["version"], told
        return run

    def until(self, wanted):
        """The first answer for which `wanted` holds."""
        run = self.ask()
        while not wanted(run):
            assert not run["last"], run
            time.sleep(0.05)
            run = self.ask()
        return run

    def close(self):
        self.connection.close()
