"""Runs the same batch in one process and in executors, kills a worker of each, and prints a hash of all outcomes.

The hashes are equal. Run it as ``python executors.py [SEEDS]``; what is not installed is left out::

    pip install wildfire-contest distributed ray
"""

import hashlib
import os
import pathlib
import signal
import sys
import tempfile
import threading
from concurrent.futures import ProcessPoolExecutor

import wildfire_contest as wf

SHARDS = 6
WORKERS = 2


class RayExecutor:
    """What `wf.batch` needs of an executor, on a cluster of Ray."""

    class Future:
        """The result of a call in a worker."""

        def __init__(self, reference):
            self.reference = reference

        def result(self):
            import ray

            return ray.get(self.reference)

    def submit(self, fn, /, *args):
        """Call a function in a worker; `wf.batch` itself repeats it if the worker dies."""
        import ray

        return self.Future(ray.remote(max_retries=0)(fn).remote(*args))


def digest(batch):
    """Hash the rows of runs and agents, without the columns that are measured."""
    tables = (batch.runs, batch.agents)
    kept = [[(name, table[name].tolist()) for name in table if not name.startswith(("cpu_", "wall_"))] for table in tables]
    return hashlib.sha256(repr(kept).encode()).hexdigest()[:16]


def kill_a_worker(folder, killed, is_over):
    """Kill the process that writes the journal of a shard as soon as that has a few rows."""
    while not is_over.wait(0.01):
        for process in pathlib.Path("/proc").iterdir():
            try:
                files = [file.resolve() for file in process.joinpath("fd").iterdir()] if process.name.isdigit() else []
                journals = [file for file in files if file.parent == folder and file.suffix == ".journal"]
                if int(process.name) != os.getpid() and any(file.stat().st_size > 20_000 for file in journals):
                    os.kill(int(process.name), signal.SIGKILL)
                    killed.append(f"{journals[0].name}, {journals[0].stat().st_size} bytes")
                    return
            except (OSError, ValueError):
                continue


def show(name, executor, seeds):
    """Run the batch in an executor, kill a worker meanwhile, and print the hash."""
    with tempfile.TemporaryDirectory() as scratch:
        folder, killed, is_over = pathlib.Path(scratch).resolve() / "batch", [], threading.Event()
        killer = threading.Thread(target=kill_a_worker, args=(folder, killed, is_over))
        killer.start()
        try:
            batch = wf.batch("contest", seeds, executor=executor, shards=SHARDS, out=folder)
        finally:
            is_over.set()
            killer.join()
        print(f"{name:20} {digest(batch)}  {len(batch)} runs, killed while it wrote {killed[0] if killed else 'nothing'}")


def main(seeds):
    """Run it without an executor and in each that is installed."""
    print(f"{'no executor':20} {digest(wf.batch('contest', seeds, jobs=WORKERS))}")
    show("ProcessPoolExecutor", lambda: ProcessPoolExecutor(WORKERS), seeds)
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        print("Dask is not installed")
    else:
        with LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            show("Dask", client.get_executor(), seeds)
    try:
        import ray
    except ImportError:
        print("Ray is not installed")
    else:
        ray.init(num_cpus=WORKERS, include_dashboard=False, log_to_driver=False)
        show("Ray", RayExecutor(), seeds)
        ray.shutdown()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "1..400")
