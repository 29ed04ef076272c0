"""Scenarios: changes, texts, and what is wrong with them."""

from __future__ import annotations

import pathlib
import pickle

import numpy as np
import pytest

import wildfire_contest as wf


def test_a_scenario_is_written_and_read_back() -> None:
    for name in ("contest", "smoke", "fleet", "dense"):
        scenario = wf.scenario(name, {"unimog.prm.samples": 501})
        assert wf.Scenario.from_toml(scenario.to_toml()) == scenario
        assert scenario != wf.scenario(name) and pickle.loads(pickle.dumps(scenario)) == scenario
    unknown = pickle.loads(pickle.dumps(wf.scenario("smoke", {"unimog.planner": "mine"})))
    with pytest.raises(wf.ScenarioError, match="mine"):
        wf.run(unknown)


def test_changes_are_python_values() -> None:
    changed = wf.scenario(
        "smoke",
        {
            "name": 'of "mine"',
            "duration_s": np.float64(60),
            "fire.relight": True,
            "unimog.prm.samples": np.int64(300),
            "field.shapes": ("I", "O"),
        },
    )
    assert changed.name == 'of "mine"' and changed.duration_s == 60
    text = changed.to_toml()
    assert "relight = true" in text and "samples = 300" in text and '["I", "O"]' in text
    assert changed.with_({"duration_s": 30}).duration_s == 30 and changed.duration_s == 60


def test_a_path_names_a_scenario(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(wf.scenario("smoke").to_toml())
    assert wf.scenario(path).to_toml() == wf.scenario("smoke").to_toml()


def test_refusals_have_a_place(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text("duration_s = 60\n[fire]\nburn_out_s = -1\n[[wumpus]]\n[[unimog]]\n")
    with pytest.raises(wf.ScenarioError, match="burn_out_s") as refusal:
        wf.scenario(path)
    assert (refusal.value.file, refusal.value.line) == (str(path), 3)
    with pytest.raises(wf.ScenarioError, match="did you mean `contest`") as refusal:
        wf.scenario("contst")
    assert refusal.value.line is None
    with pytest.raises(wf.ScenarioError, match="burn_out_s") as refusal:
        wf.scenario("smoke", {"fire.burn_out_s": -1})
    assert (refusal.value.file, refusal.value.line) == ("--set", 1)
    assert isinstance(refusal.value, wf.WildfireError)


@pytest.mark.parametrize("value", [object(), float("nan"), {1: 2}, b"bytes"])
def test_values_of_another_kind_are_refused(value: object) -> None:
    with pytest.raises((TypeError, wf.ScenarioError)):
        wf.scenario("smoke", {"fire.burn_out_s": value})
    with pytest.raises(ValueError, match="is not a key of a scenario"):
        wf.scenario("smoke", {"a=b": 1})


def test_a_list_in_itself_is_refused() -> None:
    endless: list[object] = []
    endless.append(endless)
    with pytest.raises(TypeError, match="too deep"):
        wf.scenario("smoke", {"field.shapes": endless})


def test_planners_that_nobody_brings_are_refused_with_the_nearest_name() -> None:
    scenario = wf.scenario("smoke", {"unimog.planner": "prm-r"})
    with pytest.raises(wf.ScenarioError, match="prm-rs"):
        wf.run(scenario)
    with pytest.raises(wf.ScenarioError, match="prm-rs"):
        wf.batch("smoke", seeds=1, planner="prm-r")


def test_a_scenario_gives_the_checker_of_its_field() -> None:
    checker = wf.scenario("contest").checker(seed=7)
    assert checker.size_m == (250.0, 250.0) and checker.occupied.shape == (50, 50)
    assert int(checker.occupied.sum()) == wf.run("contest", 7).outcome.obstacles


def test_arguments_of_other_types_are_refused_in_a_sentence() -> None:
    run = wf.run("smoke", seed=1)
    for ask, sentence in [
        (lambda: wf.run(5), "found a int; expected a Scenario, or the name or the path of one"),
        (lambda: wf.batch(["smoke", 5]), "found a int; expected a Scenario, or the name or the path of one"),
        (lambda: wf.batch("smoke", planner=5), "'int' object is not an instance of 'str'"),
        (lambda: wf.audit([run, 5]), "found a int; expected a Run, a Batch, or a path"),
        (lambda: wf.compare("smoke", by=5), "found a int; expected a column, or a column with its values"),
        (lambda: run.picture(size=-1), r"found a int; expected a size in pixels, or \(width, height\)"),
    ]:
        with pytest.raises(TypeError, match=f"^{sentence}") as caught:
            ask()
        assert "\n" not in str(caught.value)
    with pytest.raises(wf.WildfireError, match="^`R R T`: a name is 1 to 40 of"):
        wf.plan(planner="R R T")


def test_a_damaged_module_is_refused_with_the_byte(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "damaged.wasm"
    path.write_bytes(b"\0asm\1\0\0\0and then something else")
    scenario = wf.scenario("smoke", {"unimog.planner": "mine"})
    with pytest.raises(wf.ScenarioError, match=r"^--set:1:21: `.*damaged\.wasm` is not a valid module: .* at byte \d+$"):
        scenario.with_({"planner.mine.module": str(path)})
