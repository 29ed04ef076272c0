"""Measure steps per CPU second of the environments, and of others if installed: ``python envs.py [STEPS]``."""

import importlib.util
import sys
import time

import numpy as np

from wildfire_contest import envs
from wildfire_contest.vector import TruckVectorEnv

CHANGED = {"prm-rs": {}, "prm+primitives": {"unimog.planner": "prm+primitives"}}


def single(scenario, actions, steps):
    """Step through contests one after the other, always choosing the nearest fire."""
    env = envs.TruckEnv(scenario, actions=actions)
    seen, _ = env.reset(seed=1)
    begun = time.process_time()
    for _ in range(steps):
        seen, _, ended, _, _ = env.step(choice(seen, actions))
        if ended:
            seen, _ = env.reset()
    return steps / (time.process_time() - begun)


def choice(seen, actions):
    if actions == "nearest":
        return envs.nearest(seen)
    options = np.flatnonzero(seen["action_mask"])
    return options[-1] if options.size > 1 else 0


def side_by_side(scenario, steps, threads=1, n=64):
    env = TruckVectorEnv(n, scenario, actions="nearest", threads=threads)
    seen, _ = env.reset(seed=1)
    calls = max(steps // n, 1)
    begun = time.process_time()
    for _ in range(calls):
        # Candidates are sorted by distance: the first free one is the nearest.
        seen, *_ = env.step(np.argmax(seen["action_mask"][:, 1:], axis=1) + seen["action_mask"][:, 1:].any(axis=1))
    return calls * n / (time.process_time() - begun)


def pyrorl(steps):
    """Step PyroRL on its own 50 x 50 field, which has no vehicles."""
    import gymnasium
    import pyrorl  # noqa: F401
    import torch

    # Its idle threads would add to its CPU time.
    torch.set_num_threads(1)

    env = gymnasium.make(
        "pyrorl/PyroRL-v0",
        num_rows=50,
        num_cols=50,
        populated_areas=np.array([[10, 10], [30, 40]]),
        paths=np.array([[[row, 10] for row in range(10)], [[30, col] for col in range(41, 50)]], dtype=object),
        paths_to_pops={0: [[10, 10]], 1: [[30, 40]]},
    ).unwrapped
    env.reset()
    env.step(0)
    begun = time.process_time()
    for step in range(1, steps + 1):
        env.step(0)
        # PyroRL's own limit on the length of an episode.
        if step % 200 == 0:
            env.reset()
    return steps / (time.process_time() - begun)


def main():
    import wildfire_contest as wf

    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    ours = 0.0
    for planner, changes in CHANGED.items():
        scenario = wf.scenario("contest", changes)
        for actions in ("cells", "nearest"):
            print(f"TruckEnv, {planner}, {actions}: {single(scenario, actions, steps):8.0f} steps a CPU second")
        found = side_by_side(scenario, 4 * steps)
        ours = ours or found
        print(f"TruckVectorEnv(64), {planner}: {found:8.0f}")
        print(f"TruckVectorEnv(64, threads=2), {planner}: {side_by_side(scenario, 4 * steps, 2):8.0f}")
    if importlib.util.find_spec("pyrorl"):
        theirs = pyrorl(min(steps, 300))
        print(f"PyroRL, 50 x 50, nobody drives: {theirs:8.0f}; TruckVectorEnv(64) does {ours / theirs:.1f} times as many")
    else:
        print("PyroRL is not installed")


if __name__ == "__main__":
    main()
