"""Tunes a planner by Optuna's ask and tell: each trial is a batch of the same seeds.

    pip install wildfire-contest optuna
    python tune.py 30
"""

from __future__ import annotations

import sys

import optuna

import wildfire_contest as wf

SEEDS = "1..40"


def saved(changes: dict[str, float]) -> float:
    """Returns the mean number of bushes saved with these settings of the planner."""
    runs = wf.batch(wf.scenario("contest", changes), SEEDS, planner="hybrid-astar", jobs=-1).runs
    return float(runs["intact"].mean() + runs["extinguished"].mean())


def main(trials: int) -> None:
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=1))
    for _ in range(trials):
        trial = study.ask()
        changes = {
            "unimog.hybrid.heuristic_weight": trial.suggest_float("unimog.hybrid.heuristic_weight", 1.0, 2.0),
            "unimog.hybrid.step_m": trial.suggest_float("unimog.hybrid.step_m", 2.0, 6.0),
        }
        study.tell(trial, saved(changes))
    print(f"{study.best_value:.2f} bushes saved with {study.best_params}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30)
