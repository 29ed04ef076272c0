"""One planner in Rust, in Python and as a program gives the same outcomes: `tests/contest/same_planner.rs` has written them."""

from __future__ import annotations

import csv
import importlib.util
import pathlib
import sys

import numpy as np
import pytest

import wildfire_contest as wf

FOLDER = pathlib.Path(__file__).parents[2] / "tests" / "data" / "same_planner"

pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="the outcomes are in the repository")


def expected() -> list[dict[str, str]]:
    with (FOLDER / "outcomes.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_planner_in_python_gives_the_outcomes_of_the_file() -> None:
    spec = importlib.util.spec_from_file_location("same_planner", FOLDER / "planner.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    rows = expected()
    for row in rows:
        outcome = wf.run("contest", int(row["seed"]), planner="first-place", planners={"first-place": module.FirstPlace}).outcome
        written = {name: "" if value is None else value for name, value in outcome.items()}
        assert written.keys() == row.keys() | {"message"}
        for name, value in ((name, value) for name, value in written.items() if name in row):
            found = np.format_float_positional(value, trim="-") if isinstance(value, float) else str(value)
            assert found == row[name] or float(found) == float(row[name]), (row["seed"], name)
    assert len(rows) == 20


@pytest.mark.skipif(sys.platform == "win32", reason="programs run where there are process groups")
def test_planner_as_a_program_gives_the_outcomes_of_the_file(tmp_path: pathlib.Path) -> None:
    command = f"first-place={sys.executable} {FOLDER / 'planner.py'}"
    options = ["--command", command, "--planner", "first-place", "--seeds", "1..20", "--jobs", "1", "--out", str(tmp_path / "out")]
    assert wf.main(["--quiet", "batch", "contest", *options]) == 0
    with (tmp_path / "out" / "runs.csv").open(newline="") as file:
        found = list(csv.DictReader(file))
    for row, again in zip(expected(), found, strict=True):
        for name in row:
            assert name == "run" or row[name] == again[name], (row["seed"], name)
