"""Other processes, signals and full disks: a batch works, or ends with a sentence, and never hangs or aborts."""

from __future__ import annotations

import multiprocessing
import pathlib
import signal
import subprocess
import sys

import pytest

import wildfire_contest as wf

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no such processes and signals")

SLOW = """
import sys, time
import wildfire_contest as wf

class Slow:
    def __init__(self, site):
        pass
    def plan(self, query):
        # One write, so that threads do not write between the word and the end of its line.
        sys.stdout.write("asked\\n")
        sys.stdout.flush()
        end = time.monotonic() + float(sys.argv[2])
        while time.monotonic() < end:
            pass

def batch(**options):
    return wf.batch("smoke", "1..40", planner="mine", planners={"mine": Slow}, out=sys.argv[1], **options)
"""


def script(lines: str, out: pathlib.Path, slow_s: float) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", SLOW + lines, str(out), str(slow_s)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def rows(seed: int) -> int:
    return int(wf.batch("smoke", seed).runs.rows)


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_a_process_that_was_begun_after_a_batch_runs_batches(method: str) -> None:
    assert rows(1) == 1 and wf.audit(wf.batch("smoke", 1), jobs=2) == []
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map_async(rows, [1, 2, 3]).get(timeout=600) == [1, 1, 1]


@pytest.mark.parametrize("jobs", [1, 2])
def test_control_c_ends_planners_that_never_answer(jobs: int, tmp_path: pathlib.Path) -> None:
    process = script(f"batch(jobs={jobs})", tmp_path / "batch", 1e9)
    assert process.stdout is not None and process.stdout.readline() == "asked\n"
    process.send_signal(signal.SIGINT)
    _, words = process.communicate(timeout=600)
    assert words.rstrip().endswith("KeyboardInterrupt") and process.returncode in (1, -signal.SIGINT), words
    assert (tmp_path / "batch" / "plan.json").exists() and not (tmp_path / "batch" / "runs.csv").exists()


def test_a_full_disk_ends_a_batch_with_a_sentence(tmp_path: pathlib.Path) -> None:
    lines = """
import resource, signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
batch(jobs=2)
"""
    process = script(lines, tmp_path / "batch", 0.02)
    _, words = process.communicate(timeout=600)
    assert process.returncode == 1 and "WildfireError: cannot write" in words.splitlines()[-1], words
