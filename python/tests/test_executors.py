"""Shards of a batch in executors: the same rows as without, also if a worker dies."""

from __future__ import annotations

import multiprocessing
import os
import pathlib
import signal
import sys
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from typing import Any

import pytest
from conftest import FirstCurve, outcomes

import wildfire_contest as wf


def processes(workers: int = 2) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


class Mortal(FirstCurve):
    """Kills its process once if it is told to: a file notes that."""

    def plan(self, query: wf.Query) -> Any:
        marker = pathlib.Path(self.site.settings["marker"])
        if self.site.settings["fatal"] and not marker.exists():
            marker.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().plan(query)


class Here:
    """An executor that calls a function at once; some shards fail a number of times before."""

    def __init__(self, failures: dict[int, int]) -> None:
        self.failures = failures

    def submit(self, fn: Callable[..., Any], /, folder: str, number: int, *rest: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if self.failures.get(number, 0) > 0:
            self.failures[number] -= 1
            future.set_exception(OSError("the worker is gone"))
        else:
            try:
                future.set_result(fn(folder, number, *rest))
            except Exception as error:
                future.set_exception(error)
        return future


def assert_same(one: wf.Batch, other: wf.Batch) -> None:
    for name in ("runs", "agents"):
        assert outcomes(getattr(one, name)) == outcomes(getattr(other, name)), name
    assert (len(one), one.not_done) == (len(other), other.not_done)


@pytest.mark.parametrize("executor", [ThreadPoolExecutor, processes])
def test_shards_give_the_rows_of_one_batch(
    executor: Callable[[int], Any], tmp_path: pathlib.Path, capfd: pytest.CaptureFixture[str]
) -> None:
    arguments: dict[str, Any] = {"planner": ["prm-rs", "mine"], "planners": {"mine": FirstCurve}, "record": "all"}
    whole = wf.batch("smoke", "1..7", out=tmp_path / "whole", **arguments)
    with executor(2) as pool:
        arguments |= {"executor": pool, "shards": 3, "out": tmp_path / "shards"}
        batch = wf.batch("smoke", "1..7", **arguments)
        assert_same(batch, whole)
        recordings = [{path.name: path.read_bytes() for path in folder.glob("recordings/*")} for folder in tmp_path.iterdir()]
        assert recordings[0] == recordings[1] and len(recordings[0]) == 14
        assert capfd.readouterr().err == "" and "read from" not in repr(batch)
        assert "read from" in repr(wf.batch("smoke", "1..7", **arguments))
    assert_same(wf.read_batch(tmp_path / "shards"), whole)
    plans = [(tmp_path / name / "plan.json").read_text() for name in ("whole", "shards")]
    assert plans[0] == plans[1]


def test_a_batch_without_a_folder_is_spread_too() -> None:
    with processes() as pool:
        assert_same(wf.batch("smoke", "1..5", executor=pool, shards=2, jobs=2), wf.batch("smoke", "1..5"))


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such signal")
def test_shards_of_a_killed_worker_are_run_again(tmp_path: pathlib.Path) -> None:
    marker = tmp_path / "marker"
    scenario = wf.scenario("smoke", {"unimog.planner": "mine", "planner.mine.settings.marker": str(marker)})
    arguments: dict[str, Any] = {"planners": {"mine": Mortal}, "sweep": {"planner.mine.settings.fatal": [False, True]}}
    marker.touch()
    whole = wf.batch(scenario, "1..6", **arguments)
    marker.unlink()
    assert_same(wf.batch(scenario, "1..6", executor=processes, shards=4, **arguments), whole)
    assert marker.exists()
    # Without a callable there is no other pool; what was run is kept.
    marker.unlink()
    arguments |= {"out": tmp_path / "batch", "shards": 4}
    with processes() as pool, pytest.raises(wf.WildfireError, match=r"shard \d of 4 failed: BrokenProcessPool: .*lambda"):
        wf.batch(scenario, "1..6", executor=pool, **arguments)
    with processes() as pool:
        assert_same(wf.batch(scenario, "1..6", executor=pool, **arguments), whole)


def test_shards_are_submitted_three_times_at_most() -> None:
    assert_same(wf.batch("smoke", "1..6", executor=Here({2: 2}), shards=3), wf.batch("smoke", "1..6"))
    with pytest.raises(wf.WildfireError, match="shard 2 of 3 failed 3 times: OSError: the worker is gone"):
        wf.batch("smoke", "1..6", executor=Here({2: 3}), shards=3)


def test_what_does_not_go_together_is_refused(tmp_path: pathlib.Path) -> None:
    here = Here({})
    for wrong in ({"executor": here}, {"shards": 2}, {"executor": here, "shards": 0}, {"executor": here, "shards": 10_001}):
        with pytest.raises(ValueError, match="shards"):
            wf.batch("smoke", 1, **wrong)  # type: ignore[arg-type]
    wf.batch("smoke", "1..6", executor=here, shards=3, out=tmp_path / "batch")
    with pytest.raises(wf.WildfireError, match="differs from the requested plan"):
        wf.batch("smoke", "1..7", executor=here, shards=3, out=tmp_path / "batch")
    with pytest.raises(wf.WildfireError, match="does not fit"):
        wf.batch("smoke", "1..6", executor=here, shards=2, out=tmp_path / "batch")
    with pytest.raises(wf.WildfireError, match="holds slice"):
        wf.batch("smoke", "1..6", out=tmp_path / "batch")


def test_a_worker_with_other_code_is_refused(tmp_path: pathlib.Path) -> None:
    class Other(Here):
        def submit(self, fn: Callable[..., Any], /, folder: str, number: int, of: int, rest: Any) -> Future[Any]:
            planners, *others = rest
            return super().submit(fn, folder, number, of, ({"mine": Mortal}, *others))

    arguments: dict[str, Any] = {"planner": "mine", "planners": {"mine": FirstCurve}, "executor": Other({}), "shards": 2}
    with pytest.raises(wf.WildfireError, match=r"shard 1 of 2: .* differs from the requested plan: .*version="):
        wf.batch("smoke", "1..2", **arguments)
    assert len(wf.batch("smoke", "1..2", version="1", **arguments)) == 2
