"""Planners of Python in runs: what they are told, and what becomes of what they say."""

from __future__ import annotations

import math
import pathlib
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from conftest import outcomes

import wildfire_contest as wf

BRIEF = {"duration_s": 120}


def answering(answer: Callable[[wf.Query], Any]) -> type:
    """Return planners that answer by a function."""

    class Answering:
        def __init__(self, site: wf.Site) -> None:
            pass

        def plan(self, query: wf.Query) -> Any:
            return answer(query)

    return Answering


def run_with(answer: Callable[[wf.Query], Any], seed: int = 1) -> wf.Run:
    scenario = wf.scenario("smoke", BRIEF)
    return wf.run(scenario, seed, planner="mine", planners={"mine": answering(answer)})


def failures(run: wf.Run) -> dict[str, int]:
    outcome = dict(run.outcome)
    found = {name.removeprefix("truck_failed_"): outcome[name] for name in outcome if name.startswith("truck_failed_")}
    return {name: count for name, count in found.items() if count}


def test_a_planner_puts_fires_out_and_the_audit_finds_nothing(first_curve: type) -> None:
    run = wf.run("contest", 7, planner="mine", planners={"mine": first_curve})
    assert run.outcome.planner == "mine" and run.outcome.extinguished > 0 and run.measured["cpu_source"] == "thread"
    assert wf.audit(run) == [] and run.outcome == wf.run("contest", 7, planner="mine", planners={"mine": first_curve}).outcome


def test_a_factory_is_called_once_a_truck_and_run_and_told_of_the_site() -> None:
    sites: list[wf.Site] = []

    def factory(site: wf.Site) -> Any:
        sites.append(site)
        return answering(lambda query: None)(site)

    scenario = wf.scenario("fleet", {"unimog.planner": "mine", "planner.mine.settings": {"range_m": 12, "deep": {"a": [1]}}})
    wf.run(scenario.with_({"duration_s": 60}), 1, planners={"mine": factory})
    assert [site.truck for site in sites] == list(range(len(sites))) and len(sites) > 1
    assert all(site.settings == {"range_m": 12, "deep": {"a": [1]}} for site in sites)
    assert len({site.seed for site in sites}) == len(sites) and all(0 <= site.seed < 2**53 for site in sites)
    assert sites[0].vehicle.min_turn_radius == 13 and sites[0].checker.size_m[0] > 0
    first = [site.seed for site in sites]
    sites.clear()
    wf.run(scenario.with_({"duration_s": 60}), 1, planners={"mine": factory})
    assert [site.seed for site in sites] == first


@pytest.mark.parametrize(
    ("answer", "failure", "words"),
    [
        (lambda query: None, "disconnected", None),
        (lambda query: [[0.0, 1.0, 2.0, 3.0]], "bad_answer", "shape (1, 4); expected a Path"),
        (lambda query: "north", "bad_answer", "a str; expected a Path"),
        (lambda query: object(), "bad_answer", "a object; expected"),
        (lambda query: [[1, 2], [3]], "bad_answer", "expected a Path"),
        (lambda query: [[float("nan"), 1.0]], "bad_answer", "curvature is NaN"),
        (lambda query: [[float("inf"), 1.0, 0.0]], "bad_answer", "pose 1 of 1"),
        (lambda query: [[1.0, 5.0]], "bad_answer", "a turn of radius"),
        (lambda query: [[0.0, 1e5]], "bad_answer", ""),
        (lambda query: np.zeros((20_000, 2)), "bad_answer", "20000"),
        (lambda query: [], "bad_answer", "from the centre of the goal's disc"),
        (lambda query: wf.Path((1, 2, 3), [[0, 1]]), "bad_answer", "it begins at"),
        (lambda query: 1 / 0, "crashed", "ZeroDivisionError: division by zero"),
        (lambda query: [][1], "crashed", "IndexError: list index out of range"),
    ],
)
def test_what_is_no_path_costs_a_query(answer: Callable[[wf.Query], Any], failure: str, words: str | None) -> None:
    run = run_with(answer)
    assert set(failures(run)) == {failure} and run.outcome.extinguished == 0 and run.outcome.status == "done"
    assert words is None or words in run.messages[0], run.messages[:1]
    assert words is None or words in run.outcome.message
    assert len(run.messages) <= 20


@pytest.mark.parametrize("reason", ["start-blocked", "goal-blocked", "disconnected", "budget-spent"])
def test_a_planner_says_why_it_has_no_path(reason: str) -> None:
    def answer(query: wf.Query) -> None:
        raise wf.NoPath(reason)

    assert set(failures(run_with(answer))) == {reason.replace("-", "_")}


def test_another_reason_is_a_bad_answer() -> None:
    def answer(query: wf.Query) -> None:
        raise wf.NoPath("too tired")

    run = run_with(answer)
    assert set(failures(run)) == {"bad_answer"} and "too tired" in run.messages[0]


def test_the_first_exception_of_a_run_is_printed_whole(capfd: pytest.CaptureFixture[str]) -> None:
    def answer(query: wf.Query) -> None:
        raise KeyError(f"query at {query.start}")

    run = run_with(answer)
    printed = capfd.readouterr().err
    assert run.outcome.truck_failed_crashed > 1 and printed.count("Traceback") == 1 and "in answer" in printed


def test_segments_poses_and_paths_drive_the_same_way(first_curve: type) -> None:
    def as_path(query: wf.Query, poses: Any) -> wf.Path:
        return wf.Path.through(query.start, poses, 13.0)

    forms: list[Callable[[wf.Query, Any], Any]] = [
        lambda query, poses: poses,
        lambda query, poses: poses.tolist(),
        lambda query, poses: poses.astype(np.float64, order="F"),
        as_path,
        lambda query, poses: as_path(query, poses).segments,
        lambda query, poses: as_path(query, poses).segments.tolist(),
    ]
    outcomes = []
    for form in forms:

        class Form(first_curve):  # type: ignore[misc, valid-type]
            def plan(self, query: wf.Query) -> Any:
                poses = super().plan(query)
                return None if poses is None else form(query, poses)

        outcomes.append(wf.run("smoke", 2, planner="mine", planners={"mine": Form}).outcome)
    assert all(outcome == outcomes[0] for outcome in outcomes) and outcomes[0].extinguished > 0


def test_single_precision_is_precise_enough(first_curve: type) -> None:
    class Rounded(first_curve):  # type: ignore[misc, valid-type]
        def plan(self, query: wf.Query) -> Any:
            poses = super().plan(query)
            return None if poses is None else wf.Path.through(query.start, poses, 13.0).segments.astype(np.float32)

    run = wf.run("smoke", 2, planner="mine", planners={"mine": Rounded})
    assert run.outcome.extinguished > 0 and not any("radius" in message for message in run.messages)
    assert wf.audit(run) == []


@pytest.mark.parametrize("end", [KeyboardInterrupt, SystemExit, GeneratorExit])
def test_what_ends_the_program_ends_the_run(end: type[BaseException]) -> None:
    def answer(query: wf.Query) -> None:
        raise end("now")

    with pytest.raises(end, match="now"):
        run_with(answer)


def test_a_factory_that_fails_fails_the_run() -> None:
    def fails(site: wf.Site) -> Any:
        raise ValueError("no licence")

    with pytest.raises(wf.WildfireError, match="could not be built: ValueError: no licence"):
        wf.run("smoke", planner="mine", planners={"mine": fails})
    with pytest.raises(wf.WildfireError, match="no method `plan`"):
        wf.run("smoke", planner="mine", planners={"mine": lambda site: 3})
    with pytest.raises(KeyboardInterrupt):

        def ends(site: wf.Site) -> Any:
            raise KeyboardInterrupt

        wf.run("smoke", planner="mine", planners={"mine": ends})


def test_a_query_that_takes_too_long_is_timed_out(capfd: pytest.CaptureFixture[str]) -> None:
    scenario = wf.scenario("smoke", {"duration_s": 60, "planner.mine.query_cpu_s": 0.05, "unimog.planner": "mine"})

    def forever(query: wf.Query) -> None:
        while True:
            pass

    def late(query: wf.Query) -> Any:
        try:
            forever(query)
        except BaseException:
            return []

    for answer in (forever, late):
        run = wf.run(scenario, 1, planners={"mine": answering(answer)})
        assert set(failures(run)) == {"timed_out"} and "no answer within 0.05 s of CPU time" in run.messages[0]
    batch = wf.batch(scenario, 1, planners={"mine": answering(forever)})
    assert batch.runs["truck_failed_timed_out"][0] == failures(run)["timed_out"] > 0
    pauses = iter([10.2])
    in_time = wf.run(scenario, 1, planners={"mine": answering(lambda query: time.sleep(next(pauses, 0.0)))})
    assert set(failures(in_time)) == {"disconnected"}, "waiting is no CPU time"
    warned = capfd.readouterr().err
    assert warned.startswith("wildfire: the planner `mine`, asked for a path to (") and warned.endswith("has taken 10 s so far\n")


def test_programs_are_started_where_they_are_trusted(tmp_path: pathlib.Path) -> None:
    program = tmp_path / "silent.py"
    program.write_text(SILENT)
    command = [sys.executable, str(program)]
    named = wf.scenario("smoke", BRIEF | {"unimog.planner": "mine", "planner.mine.command": command})
    with pytest.raises(wf.WildfireError, match="nor a program that may be started"):
        wf.run(named, 1)
    assert set(failures(wf.run(named, 1, trust=True))) == {"disconnected"}
    assert wf.batch(named, 1, trust=True).runs["truck_failed_disconnected"][0] > 0


SILENT = """
import json, sys
for asked in map(json.loads, sys.stdin):
    answers = {"hello": {"protocol": asked.get("protocol")}, "field": {}, "plan": {"id": asked.get("id"), "reason": "disconnected"}}
    kind = {"hello": "hello", "field": "ready", "plan": "none"}.get(asked["type"]) or sys.exit()
    print(json.dumps({"type": kind} | answers[asked["type"]]), flush=True)
"""


@pytest.mark.parametrize("name", ["prm-rs", "Mine", "", "a" * 41, "a b", "-a", "é"])
def test_names_that_no_planner_can_have_are_refused(name: str) -> None:
    with pytest.raises(wf.WildfireError):
        wf.run("smoke", planners={name: answering(lambda query: None)})


def test_what_makes_no_planner_is_refused_before_the_run() -> None:
    with pytest.raises(TypeError, match="expected a callable"):
        wf.run("smoke", planners={"mine": 3})  # type: ignore[dict-item]
    with pytest.raises(TypeError):
        wf.run("smoke", planners={3: answering(lambda query: None)})  # type: ignore[dict-item]


def test_names_with_all_their_letters_are_known_everywhere() -> None:
    name = "r2-d2_v1.0+x"
    planners = {name: answering(lambda query: None)}
    assert wf.run("smoke", 1, planner=name, planners=planners).outcome.planner == name
    assert set(wf.batch("smoke", 1, planner=[name, "prm-rs"], planners=planners).runs["planner"]) == {name, "prm-rs"}


def test_a_planner_is_not_rescued_unless_the_scenario_says_so() -> None:
    planners = {"silent": answering(lambda query: None)}
    alone = wf.run("smoke", 1, planner="silent", planners=planners)
    assert alone.outcome.extinguished == 0
    rescued = wf.scenario("smoke", {"unimog.rescue": True})
    assert wf.run(rescued, 1, planner="silent", planners=planners).outcome.extinguished > 0


def test_the_lock_is_free_while_it_simulates() -> None:
    ticks, is_over = 0, threading.Event()

    def count() -> None:
        nonlocal ticks
        while not is_over.wait(0.001):
            ticks += 1

    counting = threading.Thread(target=count)
    counting.start()
    before = ticks
    wf.batch("contest", seeds="1..4")
    during = ticks - before
    is_over.set()
    counting.join()
    assert during > 3


def test_planners_of_several_threads_take_turns(first_curve: type) -> None:
    one = wf.batch("smoke", "1..6", planner="mine", planners={"mine": first_curve})
    four = wf.batch("smoke", "1..6", planner="mine", planners={"mine": first_curve}, jobs=4)
    assert outcomes(one.runs) == outcomes(four.runs) and outcomes(one.calls) == outcomes(four.calls)


def test_runs_may_run_in_planners() -> None:
    inner: list[int] = []

    def answer(query: wf.Query) -> None:
        if not inner:
            inner.append(wf.run("smoke", 5).outcome.extinguished)

    run_with(answer)
    assert inner == [wf.run("smoke", 5).outcome.extinguished]


def test_a_query_is_in_metres_and_radians() -> None:
    seen: list[wf.Query] = []
    run_with(lambda query: seen.append(query))
    query = seen[0]
    assert isinstance(query.goal, wf.Disc) and query.goal.radius > 0
    assert len(query.start) == 3 and -math.pi < query.start[2] <= math.pi
    assert query.checker.pose_is_free(query.start)
