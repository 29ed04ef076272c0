"""A dispatcher that looks ahead: Monte Carlo tree search of one level, by saving and restoring the contest.

For each decision it tries the nearest fires, plays some futures of each to the end with the rule of the nearest fire, and
takes the best. Futures are drawn again, so that it does not know what the arsonist will do.

    python tree_search.py [SCENARIO] [SEEDS]
"""

import sys

import numpy as np

from wildfire_contest import envs

CHOICES = 3
FUTURES = 4
HORIZON_S = 120.0


def play_on(env, seen, horizon_s):
    """Go for the nearest fire until the end or the horizon; return the points gained."""
    total = time_s = 0.0
    ended = False
    while not ended and time_s < horizon_s:
        seen, reward, ended, _, info = env.step(envs.nearest(seen))
        total += reward
        time_s += info["dt_s"]
    return total


def best_action(env, seen):
    """Return the action whose futures bring most points."""
    actions = [int(action) for action in np.flatnonzero(seen["action_mask"]) if action > 0][:CHOICES]
    if len(actions) < 2:
        return actions[0] if actions else 0
    state, values = env.save(), []
    for action in actions:
        value = 0.0
        for future in range(FUTURES):
            env.restore(state, future=future)
            seen, reward, ended, _, info = env.step(action)
            value += reward + (0.0 if ended else play_on(env, seen, HORIZON_S - info["dt_s"]))
        values.append(value)
    env.restore(state)
    return actions[int(np.argmax(values))]


def main(scenario="fleet", seeds=10):
    """Play some seeds with both rules and print the points of the trucks' side over the arsonist's."""
    env = envs.TruckEnv(scenario, actions="nearest", k=8)
    gains = []
    for seed in range(1, seeds + 1):
        scores = []
        for rule in (lambda _, seen: envs.nearest(seen), best_action):
            seen, _ = env.reset(seed=seed)
            score, ended = 0.0, False
            while not ended:
                seen, reward, ended, _, _ = env.step(rule(env, seen))
                score += reward
            scores.append(score)
        gains.append(scores[1] - scores[0])
        print(f"seed {seed}: nearest {scores[0]:.0f}, tree search {scores[1]:.0f}", flush=True)
    error = np.std(gains, ddof=1) / np.sqrt(len(gains))
    print(f"tree search gains {np.mean(gains):.1f} points, standard error {error:.1f}")


if __name__ == "__main__":
    main(*sys.argv[1:2], *map(int, sys.argv[2:3]))
