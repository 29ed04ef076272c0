"""One run: its outcome, its tables, its pictures."""

from __future__ import annotations

import copy
import csv
import json
import pathlib
import pickle
import subprocess
import sys

import numpy as np
import pytest

import wildfire_contest as wf


def program(*words: str) -> str:
    """Return what the program prints."""
    command = [sys.executable, "-m", "wildfire_contest", *words]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def run() -> wf.Run:
    return wf.run("smoke", seed=3)


def test_a_run_is_that_of_the_command_line() -> None:
    for scenario, seed in (("smoke", 3), ("contest", 7), ("fleet", 2)):
        printed = json.loads(program("run", scenario, "--seed", str(seed), "--json"))
        run = wf.run(scenario, seed).to_dict()
        for measured in (printed, run):
            del measured["measured"]
            for agent in measured["agents"]:
                for name in [name for name in agent if name.startswith("cpu_")]:
                    del agent[name]
        assert run == printed


def test_the_outcome_has_names_and_attributes(run: wf.Run) -> None:
    outcome = run.outcome
    assert outcome["obstacles"] == outcome.obstacles == outcome.intact + outcome.burning + outcome.burned_out + outcome.extinguished
    assert outcome == wf.run("smoke", 3).outcome and outcome != wf.run("smoke", 4).outcome
    assert dict(outcome)["status"] == "done" and "wall_run_s" not in outcome and "wall_run_s" in run.measured
    assert pickle.loads(pickle.dumps(outcome)) == copy.deepcopy(outcome) == outcome
    again = pickle.loads(pickle.dumps(run))
    assert again.outcome == outcome and again.to_dict() == run.to_dict() and again.events == run.events
    with pytest.raises(AttributeError, match="its names are"):
        _ = outcome.nothing


def test_events_and_trace_are_those_of_the_command_line(run: wf.Run, tmp_path: pathlib.Path) -> None:
    events, trace = tmp_path / "events.csv", tmp_path / "trace.csv"
    program("run", "smoke", "--seed", "3", "--events", str(events), "--trace", str(trace), "--step", "0.5")
    for path, found in ((events, run.events), (trace, run.trace(step_s=0.5))):
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert list(found) == list(rows[0]) and found.rows == len(rows)
        for name, column in found.items():
            written = [row[name] for row in rows]
            if column.dtype.kind == "f":
                assert column.tolist() == [float(number) for number in written], name
            else:
                assert ["" if value is None else str(value) for value in column.tolist()] == written, name


def test_calls_and_states_agree_with_the_outcome(run: wf.Run) -> None:
    calls = run.calls
    trucks = np.array([agent.startswith("unimog") for agent in calls["agent"]])
    assert int(trucks.sum()) == run.outcome.truck_plans
    assert run.states["intact"][-1] == run.outcome.intact and run.states["t_s"][-1] == 300
    assert set(run.agents["agent"]) == {"wumpus/0", "unimog/0"}


def test_pictures_have_the_size_that_was_asked_for(run: wf.Run) -> None:
    picture = run.picture(at_s=60, size=(400, 500))
    assert picture.shape == (500, 400, 4) and picture.dtype == np.uint8 and (picture[..., 3] == 255).all()
    assert (picture == run.picture(60.0, (400, 500))).all()
    assert (run.picture(60.0, 400) == run.picture(60.0, (400, 400))).all() and run._repr_png_()[1:4] == b"PNG"
    assert not (picture == run.picture(120.0, (400, 500))).all()
    with pytest.raises(ValueError, match="size is"):
        run.picture(size=(1, 1))
    for at_s in (-1.0, 1e9, float("nan")):
        with pytest.raises(ValueError, match="at_s is"):
            run.picture(at_s=at_s)


def test_steps_that_lead_nowhere_are_refused(run: wf.Run) -> None:
    for step_s in (0.0, -1.0, 1e-9, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="step_s is"):
            run.trace(step_s)


def test_a_recording_is_written(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "run.wildfire"
    run = wf.run("smoke", 3, record=path)
    assert wf.audit(path) == [] and wf.audit(run) == []
    other = tmp_path / "again.wildfire"
    run.write(other)
    assert path.read_bytes() == other.read_bytes()
    with pytest.raises(wf.WildfireError, match="cannot write"):
        run.write(tmp_path / "nowhere" / "run.wildfire")


def test_seeds_out_of_range_are_refused() -> None:
    for seed in (-1, 2**64):
        with pytest.raises((OverflowError, TypeError)):
            wf.run("smoke", seed)
    assert wf.run("smoke", 2**64 - 1).seed == 2**64 - 1
