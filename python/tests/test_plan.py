"""Rows of `wildfire plan`, with planners of Python and of OMPL beside ours."""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import wildfire_contest as wf

MEASURED = {"cpu_build_s", "cpu_query_s"}


def test_rows_are_those_of_the_command_line() -> None:
    command = [sys.executable, "-m", "wildfire_contest", "plan", "--goals", "8", "--planner", "prm-rs,hybrid-astar", "--json"]
    rows = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["rows"]
    columns = wf.plan(planner=["prm-rs", "hybrid-astar"], goals=8)
    assert columns.rows == len(rows) == 16 and set(columns) == set(rows[0])
    for name in set(rows[0]) - MEASURED:
        values = [None if value != value else value for value in columns[name].tolist()]
        assert values == [row[name] for row in rows], name


def test_a_planner_of_python_stands_beside_the_others(first_curve: type) -> None:
    columns = wf.plan(planner=["mine", "prm-rs"], planners={"mine": first_curve}, goals=50)
    mine = columns["planner"] == "mine"
    assert mine.sum() == 50 and 5 < columns["success"][mine].sum() <= columns["success"][~mine].sum()
    assert all(violation is None for violation in columns["violation"])
    assert set(columns["reason"][mine & ~columns["success"].astype(bool)]) == {"disconnected"}


def test_fields_of_files(tmp_path: pathlib.Path, first_curve: type) -> None:
    vehicle = {"length": 4.9, "width": 2.2, "wheelbase": 3, "rear_overhang": 0.95, "min_turn_radius": 13}
    goals = [{"pose": [60, 20, 0]}, {"disc": [60, 60, 10]}]
    field = {"n": 20, "cell_m": 5, "cells_cr": [[10, 10]], "start": [20, 20, 0], "goals": goals, "vehicle": vehicle}
    path = tmp_path / "field.json"
    path.write_text(json.dumps(field))
    columns = wf.plan(path, planner="mine", planners={"mine": first_curve})
    assert columns.rows == 2 and columns["success"].all() and columns["length_m"][0] == pytest.approx(40)
    with pytest.raises(wf.WildfireError, match="nowhere"):
        wf.plan(tmp_path / "nowhere.json", planner="prm-rs")
    with pytest.raises(wf.WildfireError, match="nobody"):
        wf.plan(path, planner="nobody")


@pytest.mark.parametrize("name", ["RRTConnect"])
def test_ompl_drives_250_goals_without_a_violation(name: str) -> None:
    pytest.importorskip("ompl")
    planners = {"ompl": wf.ompl.planner(name, iterations=4000)}
    columns = wf.plan(planner="ompl", planners=planners, goals=250)
    assert columns.rows == 250 and all(violation is None for violation in columns["violation"])
    reasons = [reason for reason in columns["reason"] if reason is not None]
    assert columns["success"].sum() > 200 and "bad answer" not in reasons and "crashed" not in reasons, reasons


def test_a_contest_of_ompl_twice_is_equal() -> None:
    pytest.importorskip("ompl")
    planners = {"ompl": wf.ompl.planner("RRTConnect", iterations=2000)}
    scenario = wf.scenario("contest", {"duration_s": 600})
    runs = [wf.run(scenario, 3, planner="ompl", planners=planners) for _ in range(2)]
    assert runs[0].outcome == runs[1].outcome and runs[0].events == runs[1].events
    assert runs[0].outcome.extinguished > 0 and wf.audit(runs[0]) == []


def test_planners_of_ompl_that_are_not_there() -> None:
    pytest.importorskip("ompl")
    with pytest.raises(ValueError, match="no planner 'Nothing'"):
        wf.ompl.planner("Nothing")
    with pytest.raises(ValueError):
        wf.ompl.planner("RRTConnect", iterations=0)


def test_ompl_improves_and_simplifies() -> None:
    pytest.importorskip("ompl")
    plain = wf.plan(planner="ompl", planners={"ompl": wf.ompl.planner("RRTConnect")}, goals=6)
    better = wf.plan(planner="ompl", planners={"ompl": wf.ompl.planner("RRTstar", iterations=600)}, goals=6)
    simple = wf.plan(planner="ompl", planners={"ompl": wf.ompl.planner("RRTConnect", simplify=True)}, goals=6)
    assert np.nanmean(better["length_m"]) < np.nanmean(plain["length_m"])
    assert np.nanmean(simple["length_m"]) <= np.nanmean(plain["length_m"]) + 1e-6


def test_no_path_is_shorter_than_certified() -> None:
    checker = wf.Checker(np.zeros((20, 20), dtype=bool))
    start, goal = (20.0, 20.0, 0.0), (60.0, 40.0, 1.0)
    shortest = float(wf.reeds_shepp_length(start, goal, checker.vehicle.min_turn_radius))
    assert 0.99 * shortest < wf.certify(checker, start, goal, shortest) <= shortest
    assert wf.certify(checker, start, start, 0.0) == 0.0
    with pytest.raises(ValueError, match="length is -1"):
        wf.certify(checker, start, goal, -1.0)


def test_vehicles_plan_together_as_on_the_command_line(tmp_path: pathlib.Path) -> None:
    instance = tmp_path / "two.yaml"
    instance.write_text(
        "agents:\n- {name: a, start: [10, 10, 0.0], goal: [40, 10, 0.0]}\n- {name: b, start: [40, 20, 3.14], goal: [10, 20, 3.14]}\n"
        "map:\n  dimensions: [50, 50]\n  obstacles: []\n"
    )
    command = [sys.executable, "-m", "wildfire_contest", "plan", "--together", str(instance), "--json"]
    row = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["rows"][0]
    answer = wf.plan_together(instance)
    assert answer["status"] == "solved" and "schedule" in answer.pop("solution")
    assert {**answer, "cpu_s": None} == {**row, "cpu_s": None}
    with pytest.raises(ValueError, match="method is 'magic'; expected 'prioritised' or 'repair'"):
        wf.plan_together(instance, method="magic")
    with pytest.raises(wf.WildfireError, match="nowhere.yaml"):
        wf.plan_together(tmp_path / "nowhere.yaml")
