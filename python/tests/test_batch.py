"""Batches: equal to the command line's, resumed, compared, audited."""

from __future__ import annotations

import csv
import pathlib
import pickle
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest
from conftest import outcomes

import wildfire_contest as wf
from wildfire_contest.fingerprint import fingerprint


def table(path: pathlib.Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def is_same(value: Any, written: str, kind: str) -> bool:
    if value is None or value is np.ma.masked:
        return written == ""
    if kind == "f":
        return float(written) == value if written else bool(np.isnan(value))
    return {"b": str(value).lower()}.get(kind, str(value)) == written


def test_a_batch_is_that_of_the_command_line(tmp_path: pathlib.Path) -> None:
    out = tmp_path / "cli"
    options = ["--seeds", "1..3,9", "--planner", "prm-rs,hybrid-astar", "--set", "field.coverage=0.05,0.1", "--jobs", "1"]
    assert wf.main(["--quiet", "batch", "smoke", *options, "--out", str(out)]) == 0
    batch = wf.batch("smoke", "1..3,9", planner=["prm-rs", "hybrid-astar"], sweep={"field.coverage": [0.05, 0.1]})
    assert len(batch) == 16 and batch.not_done == 0 and batch.folder is None
    for name, columns in (("runs.csv", batch.runs), ("agents.csv", batch.agents)):
        rows = table(out / name)
        assert list(columns) == list(rows[0]) and columns.rows == len(rows)
        for column in columns:
            if column.startswith(("cpu_", "wall_")):
                continue
            kind = columns[column].dtype.kind
            assert all(is_same(value, row[column], kind) for value, row in zip(columns[column], rows, strict=True)), column


def test_long_tables_are_those_of_parquet_files(tmp_path: pathlib.Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    out = tmp_path / "batch"
    batch = wf.batch("smoke", "1..3", sweep={"field.coverage": [0.05, 0.1]}, out=out)
    for name, columns in (("runs", batch.runs), ("planner_calls", batch.calls), ("states", batch.states)):
        expected, found = parquet.read_table(out / f"{name}.parquet"), columns.to_arrow()
        assert expected.column_names == found.column_names
        for column in expected.column_names:
            assert expected.column(column).to_pylist() == found.column(column).to_pylist(), column


def test_seeds_are_a_text_or_numbers() -> None:
    forms: list[Any] = ["1..3,9", [1, 2, 3, 9], (1, 2, 3, 9), iter([1, 2, 3, 9]), np.array([1, 2, 3, 9])]
    for seeds in forms:
        assert list(wf.batch("smoke", seeds).runs["seed"]) == [1, 2, 3, 9]
    assert list(wf.batch("smoke", range(3)).runs["seed"]) == [0, 1, 2] and list(wf.batch("smoke", 7).runs["seed"]) == [7]
    large = wf.batch("smoke", [2**64 - 1]).runs["seed"]
    assert large.dtype == np.uint64 and large[0] == 2**64 - 1
    for wrong in ("", "3..1", [1, 1], [], [-1], "x"):
        with pytest.raises((wf.WildfireError, OverflowError)):
            wf.batch("smoke", wrong)
    with pytest.raises(TypeError, match="seeds are"):
        wf.batch("smoke", 1.5)  # type: ignore[arg-type]


def test_several_scenarios_are_told_apart_by_their_names() -> None:
    calm = wf.scenario("smoke", {"name": "calm", "fire.burn_out_s": 30})
    batch = wf.batch(["smoke", calm], 1)
    assert list(batch.runs["scenario"]) == ["smoke", "calm"]
    with pytest.raises(wf.WildfireError, match="two scenarios are named `smoke`"):
        wf.batch(["smoke", wf.scenario("smoke", {"fire.burn_out_s": 30})], 1)


def test_the_same_call_goes_on_where_a_batch_was_stopped(tmp_path: pathlib.Path, first_curve: type) -> None:
    out, asked = tmp_path / "batch", []

    class Stopping(first_curve):  # type: ignore[misc, valid-type]
        def __init__(self, site: wf.Site) -> None:
            super().__init__(site)
            asked.append(site.seed)
            if len(asked) == 4:
                raise KeyboardInterrupt

    # It is the same planner, without what stops it.
    arguments: dict[str, Any] = {"seeds": "1..6", "planner": "mine", "out": out, "version": "1"}
    with pytest.raises(KeyboardInterrupt):
        wf.batch("smoke", planners={"mine": Stopping}, **arguments)
    assert not (out / "runs.csv").exists() and (out / "plan.json").exists()
    resumed = wf.batch("smoke", planners={"mine": first_curve}, **arguments)
    whole = wf.batch("smoke", "1..6", planner="mine", planners={"mine": first_curve})
    assert outcomes(resumed.runs) == outcomes(whole.runs)
    assert resumed.folder == out and wf.batch("smoke", planners={"mine": first_curve}, **arguments).runs == resumed.runs
    with pytest.raises(wf.WildfireError, match="differs from the requested plan"):
        wf.batch("smoke", planners={"mine": first_curve}, **(arguments | {"seeds": "1..7"}))


def test_a_folder_is_not_taken_for_that_of_another_planner(tmp_path: pathlib.Path, capfd: pytest.CaptureFixture[str]) -> None:
    def batch(code: str, **options: Any) -> wf.Batch:
        names: dict[str, Any] = {}
        exec(code, names)
        options = {"planners": {"mine": names["Mine"]}, "out": tmp_path / "batch"} | options
        return wf.batch("smoke", "1..2", planner="mine", **options)

    code = "def helper():\n    return None\nclass Mine:\n    def __init__(self, site): pass\n    def plan(self, query): return helper()\n"
    first = batch(code)
    assert capfd.readouterr().err == "" and "read from" not in repr(first)
    again = batch(code)
    assert again.runs == first.runs and "read from" in repr(again)
    assert capfd.readouterr().err == f"wildfire: read from {tmp_path / 'batch'}, nothing was run\n"
    for other in (code.replace("return None", "return []"), code.replace("__init__(self, site): pass", "__init__(self, site): self.n = 1")):
        with pytest.raises(wf.WildfireError, match=r"planner\.mine\.sha256\.code is .* there"):
            batch(other)
    assert batch(code.replace("None", "[]"), version="1", out=tmp_path / "other").not_done == 0
    assert batch(code, version="1", out=tmp_path / "other").not_done == 0
    with pytest.raises(wf.WildfireError, match='version is "1" there, but "2" was requested'):
        batch(code, version="2", out=tmp_path / "other")
    assert fingerprint(wf.policies.Policy(lambda seen: 0)) != fingerprint(wf.policies.Policy(lambda seen: 1))
    makers = [lambda n=n: n for n in (1, 1, 2)]
    assert fingerprint(makers[0]) == fingerprint(makers[1]) != fingerprint(makers[2])


def test_batches_are_read_and_pickled_by_their_folders(tmp_path: pathlib.Path) -> None:
    batch = wf.batch("smoke", "1..2", out=tmp_path / "batch")
    for read in (pickle.loads(pickle.dumps(batch)), wf.read_batch(tmp_path / "batch")):
        assert (read.runs, read.tables, read.folder, len(read)) == (batch.runs, batch.tables, batch.folder, 2)
    assert "TABLE" in batch._repr_html_() and "<th>seed</th>" in batch.runs._repr_html_()
    with pytest.raises(wf.WildfireError, match="out=FOLDER"):
        pickle.dumps(wf.batch("smoke", 1))
    with pytest.raises(KeyError, match="did you mean 'extinguished'"):
        batch.runs["extinguised"]


@pytest.mark.parametrize("end", [KeyboardInterrupt, SystemExit])
def test_planners_end_a_batch_of_several_threads(end: type[BaseException], tmp_path: pathlib.Path) -> None:
    options: dict[str, Any] = {"planner": "mine", "out": tmp_path / "batch", "version": "1"}

    class Ending:
        def __init__(self, site: wf.Site) -> None:
            pass

        def plan(self, query: wf.Query) -> None:
            raise end

    with pytest.raises(end):
        wf.batch("smoke", "1..50", planners={"mine": Ending}, jobs=3, **options)
    # Nothing that was cut short is in the journal.
    again = wf.batch("smoke", "1..50", planners={"mine": lambda site: Silent()}, **options)
    assert set(again.runs["status"]) == {"done"} and not any(again.runs["truck_failed_crashed"])


class Silent:
    def plan(self, query: wf.Query) -> None:
        return None


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such signal")
def test_control_c_stops_a_batch(tmp_path: pathlib.Path) -> None:
    script = "import signal, wildfire_contest as wf, sys; signal.signal(signal.SIGINT, signal.default_int_handler); wf.batch('contest', '1..5000', out=sys.argv[1])"
    out = tmp_path / "batch"
    process = subprocess.Popen([sys.executable, "-c", script, str(out)], stderr=subprocess.PIPE, text=True)
    while not (out / "machines.json").exists() and process.poll() is None:
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, words = process.communicate(timeout=600)
    assert process.returncode != 0 and "KeyboardInterrupt" in words
    assert (out / "plan.json").exists() and not (out / "runs.csv").exists()


def test_a_batch_in_another_thread_is_as_good() -> None:
    found: list[wf.Batch] = []
    thread = threading.Thread(target=lambda: found.append(wf.batch("smoke", "1..2")))
    thread.start()
    thread.join(timeout=600)
    assert found[0].runs.rows == 2


def test_runs_that_cannot_take_place_are_rows(first_curve: type) -> None:
    class Choosy(first_curve):  # type: ignore[misc, valid-type]
        def __init__(self, site: wf.Site) -> None:
            if site.seed % 2:
                raise ValueError("odd")
            super().__init__(site)

    batch = wf.batch("smoke", "1..10", planner="mine", planners={"mine": Choosy})
    failed = batch.runs["status"] == "failed"
    assert 0 < failed.sum() == batch.not_done < 10
    assert all("ValueError: odd" in message for message in batch.runs["message"][failed])
    assert np.ma.getmaskarray(batch.runs["intact"])[failed].all() and batch.runs["intact"].dtype == np.int64


def test_comparisons_are_in_pairs_by_seed(tmp_path: pathlib.Path) -> None:
    one = wf.batch("smoke", "1..12", planner="prm-rs", out=tmp_path / "one")
    other = wf.batch("smoke", "1..12", planner="prm-rs", sweep={"unimog.speed_mps": [2.0]})
    compared = wf.compare(one, other, metric=["saved", "truck_distance_m"])
    assert "prm-rs" in compared["description_a"][0] and compared["description_a"][0] != compared["description"][0]
    assert list(compared["metric"]) == ["saved", "truck_distance_m"] and list(compared["pairs"]) == [12, 12]
    saved = [batch.runs["intact"] + batch.runs["extinguished"] for batch in (one, other)]
    assert compared["difference"][0] == pytest.approx((saved[1] - saved[0]).mean())
    assert compared["low"][0] <= compared["difference"][0] <= compared["high"][0]
    assert wf.compare(tmp_path / "one", other, metric="saved")["sentence"][0] == compared["sentence"][0]
    swept = wf.batch("smoke", "1..6", planner=["prm-rs", "hybrid-astar"])
    assert wf.compare(swept, metric="saved").rows == wf.compare(swept, by="planner", metric="saved").rows == 1
    assert wf.compare(swept, by=("planner", ["hybrid-astar", "prm-rs"]), metric="saved")["description"][0].count("prm-rs")
    for wrong in ((), (tmp_path / "nowhere",)):
        with pytest.raises(wf.WildfireError):
            wf.compare(*wrong)
    with pytest.raises(wf.WildfireError):
        wf.compare(one, metric="nothing")


def test_batches_of_python_are_audited_from_python(tmp_path: pathlib.Path, first_curve: type) -> None:
    planners = {"mine": first_curve}
    batch = wf.batch("smoke", "1..3", planner="mine", planners=planners, out=tmp_path / "batch")
    assert wf.audit(batch, planners=planners) == [] and wf.audit(tmp_path / "batch", planners=planners) == []
    # Another planner of that name gives other runs, which the rows do not say.
    violations = wf.audit(batch, planners={"mine": lambda site: Silent()})
    assert violations and "seed" in violations[0].run and "its row has" in violations[0].text and violations[0].time_s is None
    recorded = wf.batch("smoke", "1..2", record="all", out=tmp_path / "recorded")
    assert wf.audit([recorded, tmp_path / "recorded" / "recordings"]) == []
    for wrong in (tmp_path / "nowhere", tmp_path):
        with pytest.raises(wf.WildfireError):
            wf.audit(wrong)


def test_the_command_line_refuses_batches_with_planners_of_python(tmp_path: pathlib.Path, first_curve: type) -> None:
    wf.batch("smoke", "1..2", planner="mine", planners={"mine": first_curve}, out=tmp_path / "batch")
    command = [sys.executable, "-m", "wildfire_contest", "audit", str(tmp_path / "batch")]
    audited = subprocess.run(command, capture_output=True, text=True, check=False)
    assert audited.returncode == 2 and "planner `mine`, which was registered" in audited.stderr and audited.stdout == ""
    with pytest.raises(wf.WildfireError, match="planner `mine`, which was registered"):
        wf.audit(tmp_path / "batch")
    (tmp_path / "batch" / "runs.csv").unlink()
    journal = (tmp_path / "batch" / "runs.journal").read_bytes()
    command = [sys.executable, "-m", "wildfire_contest", "batch", "--resume", str(tmp_path / "batch")]
    resumed = subprocess.run(command, capture_output=True, text=True, check=False)
    assert resumed.returncode == 2 and "planner `mine`" in resumed.stderr
    assert (tmp_path / "batch" / "runs.journal").read_bytes() == journal


def test_wrong_words_are_refused(tmp_path: pathlib.Path) -> None:
    assert wf.batch("smoke", 1, jobs=-1).not_done == 0
    for jobs in (0, -2, 10_000):
        with pytest.raises(ValueError, match="jobs is"):
            wf.batch("smoke", 1, jobs=jobs)
    with pytest.raises(ValueError, match="record"):
        wf.batch("smoke", 1, record="some")  # type: ignore[arg-type]
    with pytest.raises(wf.WildfireError):
        wf.batch("smoke", 1, sweep={"field.coverage": []})
    with pytest.raises(wf.ScenarioError, match="covrage"):
        wf.batch("smoke", 1, sweep={"field.covrage": [0.1]})
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(wf.WildfireError, match="expected a folder"):
        wf.batch("smoke", 1, out=file)


def test_tables_are_text() -> None:
    assert "smoke" in wf.batch("smoke", "1..2").tables


def test_the_exit_code_of_the_command_line_is_returned(capfd: pytest.CaptureFixture[str]) -> None:
    assert wf.main(["run", "smoke", "--seed", "1"]) == 0 and "smoke, seed 1" in capfd.readouterr().out
    assert wf.main(["run", "nowhere"]) == 2 and "nowhere" in capfd.readouterr().err
    assert wf.main(["--nonsense"]) == 2 and wf.main(["--version"]) == 0
