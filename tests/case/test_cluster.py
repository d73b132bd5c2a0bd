#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The examples of docs/howto-cluster.md, each run by its engine where it is installed, and shards that are
killed: whatever made the shards, what is gathered has every value of the sweep in one go, to the bit.

usage: test_cluster.py PROGRAM SOURCE_FOLDER AT_CALL [unittest options]

Slurm is a cluster of this one machine: its controller, its node and the service that signs its messages are
started in a folder of the test's own, and ended with it.
"""

import glob
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE, STOP = map(os.path.abspath, sys.argv[1:4])
PAGE = os.path.join(SOURCE, "docs", "howto-cluster.md")
# The page shows four shards; others too where the long tests' programs are.
SHARDS = (1, 4, 7) if shutil.which("sbatch") else (4,)
SWEEP = ["sweep", "cases/block.yaml", "--over", "friction.aging.dc=uniform(0.5 mm, 2 mm)", "--members", "64"]
SLURM = """ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def values(path):
    """All that a file holds but its history: attributes, and the bytes of every variable."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        attributes = {name: str(file.getncattr(name)) for name in file.ncattrs()
                      if name not in ("history", "date_created")}
        return attributes, {name: (v.dimensions, v[...].tobytes() if v.dtype != str else list(numpy.ravel(v[...])))
                            for name, v in file.variables.items()}


def shown(begin, n):
    """The command of the page that begins so, of n shards."""
    with open(PAGE, encoding="utf-8") as page:
        line = next(line.strip() for line in page if line.startswith(begin))
    return line.replace("}/4", f"}}/{n}").replace("0 1 2 3", " ".join(map(str, range(n)))).replace("0-3", f"0-{n - 1}")


class Cluster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-cluster-")
        os.chmod(cls.folder, 0o755)  # munge wants its socket within everybody's reach
        os.symlink(os.path.join(SOURCE, "cases"), os.path.join(cls.folder, "cases"))
        os.mkdir(os.path.join(cls.folder, "bin"))
        os.symlink(PROGRAM, os.path.join(cls.folder, "bin", "lacuna"))
        cls.environment = {**os.environ, "PATH": os.path.join(cls.folder, "bin") + os.pathsep + os.environ["PATH"]}
        cls.whole = os.path.join(cls.folder, "whole.nc")
        subprocess.run([PROGRAM, *SWEEP, "-o", cls.whole, "--jobs", "1", "-q"], cwd=cls.folder, check=True,
                       stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def tearDown(self):
        for left in glob.glob(os.path.join(self.folder, "shard-*")) + glob.glob(os.path.join(self.folder, "all.nc")):
            (shutil.rmtree if os.path.isdir(left) else os.remove)(left)

    def call(self, *words, status=0, **named):
        done = subprocess.run(words, cwd=self.folder, env={**self.environment, **named}, capture_output=True,
                              text=True, check=False, stdin=subprocess.DEVNULL, timeout=300)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def needs(self, *programs):
        for program in programs:
            if shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin") is None:
                self.skipTest(f"{program} is not installed: tools/install-packages --long")

    def each(self):
        """Numbers of shards, of which the scripts of the page's folder are then."""
        cluster = os.path.join(self.folder, "docs", "cluster")
        for n in SHARDS:
            shutil.copytree(os.path.join(SOURCE, "docs", "cluster"), cluster)
            for name in os.listdir(cluster):
                with open(os.path.join(cluster, name), "r+", encoding="utf-8") as file:
                    text = file.read().replace("SHARDS = 4", f"SHARDS = {n}")
                    file.seek(0)
                    file.write(text)
            try:
                yield n
            finally:
                shutil.rmtree(cluster)
                self.tearDown()

    def same(self):
        self.assertEqual(values(os.path.join(self.folder, "all.nc")), values(self.whole))

    def gather(self):
        shards = sorted(glob.glob(os.path.join(self.folder, "shard-*.nc")))
        self.call(PROGRAM, "gather", *shards, "-o", "all.nc")
        self.same()

    def shard(self, i, n, *more, **named):
        return self.call(PROGRAM, *SWEEP, "--shard", f"{i}/{n}", "-o", f"shard-{i}.nc", "-q", *more, **named)

    def test_shards(self):
        """1 and 7 shards, in one process and in more; the page's engines make 4."""
        for n in 1, 7:
            for i in range(n):
                self.shard(i, n, "--jobs", str(1 + i % 3))
            self.gather()
            self.tearDown()
        for asked in ("--by", "1 s"), ("--of", "mean_slip"):  # of all, not of a part
            self.assertIn("lacuna gather", self.shard(0, 2, *asked, status=2))

    def test_killed(self):
        """A shard that is killed or stopped at any time goes on with --resume, and makes only the rest."""
        for at, what, status in ((2, "tear", -9), (31, "tear", -9), (42, "kill", -9),
                                 (20, f"signal={int(signal.SIGINT)}", 4), (20, f"signal={int(signal.SIGTERM)}", 4)):
            with self.subTest(at=at, what=what):
                self.shard(0, 2, "--jobs", "2", status=status, LD_PRELOAD=STOP, AT_CALL=f"{at}:{what}:write:.runs/done",
                           ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0")
                with open(os.path.join(self.folder, "shard-0.nc.runs", "done"), "rb") as kept:
                    before = kept.read()
                log = os.path.join(self.folder, "shard-log")
                self.shard(0, 2, "--resume", LD_PRELOAD=STOP, AT_CALL="0:kill:write:.runs/done", AT_CALL_LOG=log,
                           ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0")
                with open(log, encoding="utf-8") as calls:  # a record and its sum for each member that was not there
                    made = sum(line.endswith(".runs/done\n") and " write " in line for line in calls) // 2
                self.assertLess(made, 32 if at > 3 else 33)
                self.assertGreaterEqual(made, 32 - at // 2)
                self.assertGreater(len(before), 0)
                self.shard(1, 2, "--resume")  # where nothing is there it begins
                self.shard(1, 2, "--resume")  # where all is there it does nothing
                self.gather()
                self.assertFalse(glob.glob(os.path.join(self.folder, "*.runs")))
                self.tearDown()

    def test_parallel(self):
        self.needs("parallel")
        for n in self.each():
            self.call("sh", "-euc", shown("parallel -q", n), PARALLEL_HOME=self.folder)
            self.gather()

    def test_snakemake(self):
        self.needs("snakemake")
        for n in self.each():
            self.call("sh", "-euc", shown("snakemake", n), HOME=self.folder, XDG_CACHE_HOME=self.folder)
            self.same()

    def test_dask(self):
        try:
            import dask.distributed  # noqa: F401 (is it there?)
        except ImportError:
            self.skipTest("dask.distributed is not installed: tools/install-packages --long")
        for n in self.each():
            self.call("sh", "-euc", shown("/usr/bin/python3", n).replace("/usr/bin/python3", sys.executable))
            self.same()

    def test_slurm(self):
        """The example of an array, and the job that gathers when it is over."""
        self.needs("slurmctld", "slurmd", "munged", "sbatch")
        with Slurm(self.folder) as slurm:
            for n in self.each():
                for line in shown("sbatch --array", n), shown("sbatch --dependency", n):
                    self.call("sh", "-euc", line.replace("sbatch", "sbatch --wait"), SLURM_CONF=slurm.conf)
                self.same()


class Slurm:
    """A cluster of this machine."""

    def __init__(self, folder):
        self.folder, self.started = os.path.join(folder, "slurm"), []
        self.conf = os.path.join(self.folder, "slurm.conf")

    def start(self, *words):
        path = os.environ["PATH"] + ":/usr/sbin:/sbin"
        log = open(os.path.join(self.folder, words[0] + ".log"), "wb")
        self.started.append(subprocess.Popen([shutil.which(words[0], path=path), *words[1:]], stdout=log, stderr=log,
                                             env={**os.environ, "SLURM_CONF": self.conf}, cwd=self.folder))
        log.close()

    def wait(self, good):
        ended = time.monotonic() + 60
        while not good():
            if time.monotonic() > ended or any(p.poll() is not None for p in self.started):
                raise AssertionError("Slurm does not start: " + "".join(
                    open(log, encoding="utf-8").read()[-2000:] for log in glob.glob(self.folder + "/*.log")))
            time.sleep(0.1)

    def __enter__(self):
        munge = os.path.join(self.folder, "munge")
        for name in ("", "munge", "state", "spool"):
            os.mkdir(os.path.join(self.folder, name))
        with open(os.path.join(munge, "key"), "wb") as file:
            os.chmod(file.fileno(), 0o600)
            file.write(os.urandom(128))
        sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
        ports = [s.getsockname()[1] for s in sockets]
        for s in sockets:
            s.close()
        host = socket.gethostname().split(".")[0]
        with open(self.conf, "w", encoding="ascii") as file:
            file.write(SLURM.format(host=host, user=subprocess.getoutput("id -un"), folder=self.folder, ports=ports,
                                    processors=os.cpu_count()))
        try:
            self.start("munged", "-F", *(f"--{what}={munge}/{file}" for what, file in
                                         (("socket", "socket"), ("key-file", "key"), ("log-file", "log"),
                                          ("pid-file", "pid"), ("seed-file", "seed"))))
            self.wait(lambda: os.path.exists(os.path.join(munge, "socket")))
            self.start("slurmctld", "-D")
            self.start("slurmd", "-D")
            self.wait(lambda: "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True, check=False,
                                                       env={**os.environ, "SLURM_CONF": self.conf}).stdout)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in reversed(self.started):
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
