"""Scores estimators of credit on CreditBench: `python credit.py credit/*`, folders of `wildfire why --bench credit`.

    pip install wildfire-contest[arrow]

Each decision has the option that the agent took, whose gain is 0, and others, whose gains were measured by playing them in
the same futures. The truth of an option is its mean gain over the second half of the futures; estimators see at most the
first half, and train on runs of even seeds. Scores are means over decisions of odd seeds, with standard errors over runs.
"""

from __future__ import annotations

import pathlib
import sys
from typing import Any

import numpy as np
import pyarrow.parquet

Array = np.ndarray[Any, Any]
FEATURES = ("distance_m", "burning_s", "intact_near", "burning_near", "other_truck_m")
NEIGHBOURS = 50
BINS = 10


def read(folders: list[str]) -> dict[str, Array]:
    """Returns the options of all decisions with at least three: arrays with a row for each, sorted by decision.

    `x` has the features of each option, and `decision` and `run` number decisions and runs from 0.
    """
    parts: dict[str, list[Array]] = {name: [] for name in ("x", "truth", "first", "half", "decision", "run", "seed", "part")}
    decisions = runs = 0
    for part, folder in enumerate(folders):
        table = pyarrow.parquet.read_table(pathlib.Path(folder) / "decisions.parquet").to_pydict()
        rows = {name: np.array([np.nan if value is None else value for value in column], float)
                for name, column in table.items() if name not in ("scenario", "agent", "planner", "policy") and not
                isinstance(next(iter(column), None), str)}
        agents = np.unique(table["agent"], return_inverse=True)[1]
        keys = np.stack([rows["run"], agents, rows["decision"]], axis=1)
        _, firsts, number, counts = np.unique(keys, axis=0, return_index=True, return_inverse=True, return_counts=True)
        number = number.ravel()
        took = ~np.isnan(rows["chosen_distance_m"])
        kept = (counts[number] >= 2) & took
        owns = firsts[(counts >= 2) & took[firsts]]
        x = np.concatenate([np.stack([rows[f"choice_{name}"] for name in FEATURES], axis=1)[kept],
                            np.stack([rows[f"chosen_{name}"] for name in FEATURES], axis=1)[owns]])
        half = np.floor(rows["futures"] / 2)
        second = (rows["futures"] * rows["gain"] - half * rows["half_gain"]) / (rows["futures"] - half)
        own = np.zeros(len(owns))
        for name, values in (("truth", second), ("first", rows["first_gain"]), ("half", rows["half_gain"])):
            parts[name].append(np.concatenate([values[kept], own]))
        for name, values in (("decision", number + decisions), ("run", rows["run"] + runs), ("seed", rows["seed"])):
            parts[name].append(np.concatenate([values[kept], values[owns]]))
        parts["x"].append(np.nan_to_num(x))
        parts["part"].append(np.full(len(x), part))
        decisions, runs = decisions + len(counts), runs + int(rows["run"].max())
    joined = {name: np.concatenate(values) for name, values in parts.items()}
    order = np.argsort(joined["decision"], kind="stable")
    return {name: values[order] for name, values in joined.items()}


def own_rows(options: dict[str, Array]) -> Array:
    """Returns for each option the place of the one that was taken, the last of its decision."""
    last = np.r_[options["decision"][1:] != options["decision"][:-1], True]
    places = np.flatnonzero(last)
    return places[np.searchsorted(options["decision"][places], options["decision"])]


def difference_reward(options: dict[str, Array], train: Array) -> Array:
    """Returns the gain in a single future. Any baseline that is the same for all options of a decision ranks alike."""
    return options["first"]


def few_futures(options: dict[str, Array], train: Array) -> Array:
    """Returns the mean gain over the first half of the futures: what more plays of the same decision buy."""
    return options["half"]


def leave_one_out(options: dict[str, Array], train: Array) -> Array:
    """Returns the mean gain of the most similar options of other runs, in a single future each."""
    x = options["x"] - options["x"][own_rows(options)]
    x = x / np.maximum(x[train].std(axis=0), 1e-9)
    known = np.random.default_rng(1).permutation(np.flatnonzero(train))[:20_000]
    estimates = np.zeros(len(x))
    for places in np.array_split(np.arange(len(x)), max(1, len(x) // 200)):
        far = ((x[places, None, :] - x[None, known, :]) ** 2).sum(axis=2)
        far[options["run"][places, None] == options["run"][known]] = np.inf
        near = np.argpartition(far, NEIGHBOURS, axis=1)[:, :NEIGHBOURS]
        estimates[places] = options["first"][known[near]].mean(axis=1)
    return estimates


def critic(options: dict[str, Array], train: Array) -> Array:
    """Returns the gain by a ridge regression on features, their logarithms and all products, less those of the option taken."""
    x = np.concatenate([options["x"], np.log1p(options["x"])], axis=1)
    x = x / np.maximum(x[train].std(axis=0), 1e-9)
    first, second = np.triu_indices(x.shape[1])
    x = np.concatenate([x, x[:, first] * x[:, second]], axis=1)
    x -= x[own_rows(options)]
    weights = np.linalg.solve(x[train].T @ x[train] + np.eye(x.shape[1]), x[train].T @ options["half"][train])
    return x @ weights


def nearest(options: dict[str, Array], train: Array) -> Array:
    """Prefers the option that is nearest to the agent."""
    return options["x"][own_rows(options), 0] - options["x"][:, 0]


def chance(options: dict[str, Array], train: Array) -> Array:
    return np.random.default_rng(2).random(len(options["truth"]))


def ranks(values: Array) -> Array:
    """Returns ranks from 0, the mean rank for equal values."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    return (ends - (counts + 1) / 2)[inverse]


def score(options: dict[str, Array], estimate: Array, test: Array) -> dict[str, Array]:
    """Returns rank correlation and regret of the greedy choice, by decision, with the runs that they belong to."""
    edges = np.flatnonzero(np.r_[True, options["decision"][1:] != options["decision"][:-1]])
    rows = []
    for places in np.split(np.arange(len(estimate)), edges[1:]):
        truth, guess = options["truth"][places], estimate[places]
        if not test[places[0]] or np.ptp(truth) == 0:
            continue
        a, b = ranks(truth), ranks(guess)
        spread = a.std() * b.std()
        correlation = ((a - a.mean()) * (b - b.mean())).mean() / spread if spread else 0.0
        best = np.flatnonzero(guess == guess.max())
        rows.append((options["run"][places[0]], correlation, truth.max() - truth[best].mean()))
    run, correlation, regret = np.array(rows).T
    return {"run": run, "rank correlation": correlation, "regret": regret}


def by_run(run: Array, values: Array) -> tuple[float, float]:
    """Returns the mean over decisions, and its standard error with runs as clusters."""
    mean = values.mean()
    sums = np.bincount(np.unique(run, return_inverse=True)[1], values - mean)
    return float(mean), float(np.sqrt((sums**2).sum()) / len(values))


def calibration(truth: Array, estimate: Array, train: Array, test: Array) -> float:
    """Returns by how many bushes estimates miss on average, in ten bins, after scaling them on the training runs."""
    scale = (estimate[train] @ truth[train]) / max(estimate[train] @ estimate[train], 1e-9)
    order = np.argsort(estimate[test], kind="stable")
    bins = np.array_split(order, BINS)
    return float(np.mean([abs(truth[test][places].mean() - scale * estimate[test][places].mean()) for places in bins]))


ESTIMATORS = (difference_reward, few_futures, leave_one_out, critic, nearest, chance)


def main(folders: list[str]) -> None:
    options = read(folders)
    train, test = options["seed"] % 2 == 0, options["seed"] % 2 == 1
    count = len(np.unique(options["decision"][test]))
    print(f"{len(options['truth'])} options of {len(np.unique(options['decision']))} decisions; {count} decisions for scores")
    print(f"{'estimator':18} {'rank correlation':>18} {'regret, bushes':>18} {'calibration':>12} {'from chance':>12}")
    estimates = {estimator.__name__.replace("_", " "): estimator(options, train) for estimator in ESTIMATORS}
    scores = {name: score(options, estimate, test) for name, estimate in estimates.items()}
    for name, found in scores.items():
        means = [by_run(found["run"], found[what]) for what in ("rank correlation", "regret")]
        apart, error = by_run(found["run"], found["rank correlation"] - scores["chance"]["rank correlation"])
        cells = [f"{mean:.3f} +- {deviation:.3f}" for mean, deviation in means]
        missed = calibration(options["truth"], estimates[name], train, test)
        print(f"{name:18} {cells[0]:>18} {cells[1]:>18} {missed:12.3f} {apart / error if error else 0:10.1f} s")
    order = sorted(scores, key=lambda name: -scores[name]["rank correlation"].mean())
    for better, worse in zip(order, order[1:]):
        apart, error = by_run(scores[better]["run"], scores[better]["rank correlation"] - scores[worse]["rank correlation"])
        print(f"{better} before {worse}: {apart:.3f}, {apart / error:.1f} standard errors")


if __name__ == "__main__":
    main(sys.argv[1:])
