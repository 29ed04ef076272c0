"""The score of CreditBench, on the sample in the repository."""

import pathlib
import runpy

import pytest

np = pytest.importorskip("numpy")
pytest.importorskip("pyarrow")

ROOT = pathlib.Path(__file__).parents[2]
SAMPLE = [str(ROOT / "assets/credit/sample" / part) for part in ("solo", "fleet", "duel")]


@pytest.fixture(scope="module")
def credit():
    return runpy.run_path(str(ROOT / "python/examples/credit.py"))


def test_the_truth_has_the_best_score_and_its_opposite_the_worst(credit):
    options = credit["read"](SAMPLE)
    everywhere = np.ones(len(options["truth"]), bool)
    best, worst = (credit["score"](options, sign * options["truth"], everywhere) for sign in (1, -1))
    assert best["rank correlation"] == pytest.approx(1)
    assert worst["rank correlation"] == pytest.approx(-1)
    assert best["regret"] == pytest.approx(0)
    assert (worst["regret"] > 0).all()


def test_played_futures_tell_more_than_chance(credit, capsys):
    credit["main"](SAMPLE)
    lines = capsys.readouterr().out.splitlines()
    correlation = {line[:18].strip(): float(line[18:].split()[0]) for line in lines[2:8]}
    assert list(correlation)[-1] == "chance"
    assert min(correlation["difference reward"], correlation["few futures"]) > 0.5 > abs(correlation["chance"])
