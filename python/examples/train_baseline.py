"""Train a small policy for the trucks of `fleet` in minutes, and compare it with the built-in rule.

The policy chooses the candidate with the highest linear score. Evolution strategies (Salimans et al., "Evolution
strategies as a scalable alternative to reinforcement learning", 2017) find the weights: many contests run side by side,
each with different weights, on seeds that tests never use. Run it as
``python train_baseline.py [GENERATIONS] [FILE.npy]``.
"""

import sys
import time

import numpy as np

import wildfire_contest as wf
from wildfire_contest import envs
from wildfire_contest.vector import TruckVectorEnv

SCENARIO = "fleet"
# Training plays only the first quarter of an hour, which is as informative and four times as fast.
TRAINING = {"duration_s": 900}
K = 16
LANES = 64
STEP, NOISE = 0.15, 0.15
BURN_OUT_S, SPEED_MPS, DWELL_S = 60.0, 6.0, 5.0
FEATURES = ("distance", "burning", "cluster", "slack", "in time", "other truck", "nearer than the other")


def features(candidates, agents):
    """Return the features of each candidate; leading axes may have any shape."""
    dx, dy, distance, burning, cluster, free = np.moveaxis(candidates, -1, 0)
    trucks = agents[..., -3:, :]
    own = (trucks[..., 7] > 0).argmax(-1)[..., None]
    x, y = (np.take_along_axis(trucks[..., part], own, -1) for part in (0, 1))
    east, north = x + dx, y + dy
    apart = np.hypot(trucks[..., None, :, 0] - east[..., None], trucks[..., None, :, 1] - north[..., None])
    apart = np.where(trucks[..., None, :, 7] > 0, np.inf, apart).min(-1)
    slack = BURN_OUT_S - burning - DWELL_S - distance / SPEED_MPS
    numbers = [
        distance / 100,
        burning / BURN_OUT_S,
        np.minimum(cluster, 10) / 10,
        np.clip(slack / BURN_OUT_S, -1, 1),
        slack > 0,
        np.minimum(apart, 250) / 100,
        distance < apart,
    ]
    return np.stack(numbers, -1).astype(np.float32), free > 0


def choose(weights, candidates, agents):
    """Return actions: the free candidate with the best score, or 0."""
    numbers, free = features(candidates, agents)
    scores = np.where(free, (numbers * weights[..., None, :]).sum(-1), -np.inf)
    return np.where(free.any(-1), 1 + scores.argmax(-1), 0)


def play(env, weights, seeds):
    """Return the trucks' lead in points, in one contest per row of weights."""
    seen, _ = env.reset(seed=[int(seed) for seed in seeds])
    lead, over = np.zeros(env.num_envs), np.zeros(env.num_envs, bool)
    while not over.all():
        seen, reward, ended, _, _ = env.step(choose(weights, seen["candidates"], seen["agents"]))
        lead += np.where(over, 0, reward)
        over |= ended
    return lead


def train(generations):
    """Return the mean of the weights over the last third of the generations."""
    dice = np.random.default_rng(1)
    env = TruckVectorEnv(LANES, wf.scenario(SCENARIO, TRAINING), actions="nearest", k=K, threads=2)
    # The search starts from the nearest-fire rule.
    weights = np.zeros(len(FEATURES))
    weights[0] = -1.0
    history = []
    for generation in range(generations):
        noise = dice.normal(size=(LANES // 2, len(FEATURES)))
        noise = np.concatenate([noise, -noise])
        # Four fields, each played with pairs of opposite noise.
        fields = [envs.random_seed(dice) for _ in range(4)]
        seeds = np.tile(np.repeat(fields, LANES // 8), 2)
        lead = play(env, weights + NOISE * noise, seeds)
        gain = lead[: LANES // 2] - lead[LANES // 2 :]
        gain /= gain.std() + 1e-9
        weights = weights + STEP * (gain[:, None] * noise[: LANES // 2]).mean(0)
        history.append(weights)
        print(f"generation {generation + 1:3}: mean lead {lead.mean():7.1f}", flush=True)
    return np.mean(history[-max(1, generations // 3) :], axis=0)


def compare(weights, seeds):
    """Play the policy and the built-in rule on the same seeds, and print the paired differences."""

    def act(seen):
        return int(choose(weights, seen["candidates"], seen["agents"]))

    rule = wf.scenario(SCENARIO)
    own = rule.with_({"unimog.goal": "net"})
    runs = [
        wf.batch(rule, seeds).runs,
        wf.batch(own, seeds, policies={"net": envs.Policy(act, actions="nearest", k=K)}).runs,
    ]
    for column in ("extinguished", "truck_score"):
        difference = runs[1][column].astype(float) - runs[0][column].astype(float)
        error = difference.std(ddof=1) / np.sqrt(len(difference))
        print(
            f"{column}: {runs[0][column].mean():.1f} by nearest-burning, {runs[1][column].mean():.1f} by net; paired "
            f"{difference.mean():+.2f} (95% {difference.mean() - 1.98 * error:+.2f} to {difference.mean() + 1.98 * error:+.2f})"
        )


def main():
    generations = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    begun, used = time.monotonic(), time.process_time()
    weights = train(generations)
    print(f"trained in {time.monotonic() - begun:.0f} s, {time.process_time() - used:.0f} s of CPU time")
    for name, weight in zip(FEATURES, weights, strict=True):
        print(f"  {name:22} {weight:+.3f}")
    if len(sys.argv) > 2:
        np.save(sys.argv[2], weights)
    compare(weights, "1..100")


if __name__ == "__main__":
    main()
