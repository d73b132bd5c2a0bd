# SPDX-License-Identifier: GPL-3.0-or-later
"""A sweep in shards on the workers of Dask, gathered: /usr/bin/python3 sweep_dask.py"""

import subprocess

from dask.distributed import Client

SHARDS = 4


def shard(i):
    """Makes one shard, on the worker that is given it; its file, which all must see."""
    file = f"shard-{i}.nc"
    subprocess.run(["lacuna", "sweep", "cases/block.yaml", "--over", "friction.aging.dc=uniform(0.5 mm, 2 mm)",
                    "--members", "64", "--shard", f"{i}/{SHARDS}", "--jobs", "1", "-o", file, "--resume",
                    "--no-progress"], check=True)
    return file


if __name__ == "__main__":
    # with a cluster of one's own: Client("tcp://HOST:8786"), or dask_jobqueue.SLURMCluster(...).get_client()
    with Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        files = client.gather(client.map(shard, range(SHARDS)))
    subprocess.run(["lacuna", "gather", *files, "-o", "all.nc"], check=True)
