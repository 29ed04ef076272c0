"""Train the networks of the `learned` policies.

    python train.py posts               # where idle trucks wait: minutes
    python train.py lights              # what an arsonist lights: an hour of CPU
    python train.py lights --generations 4 --seeds 2 --weights mine.json

`posts` is fitted: its weights of bushes are the density of the next ignition, given the recent ones, by maximum likelihood
over recorded contests. `lights` is evolved: antithetic samples with ranks for fitness and Adam for steps (Salimans et
al., "Evolution strategies as a scalable alternative to reinforcement learning", 2017). All candidates of a generation play
the same seeds, so they differ by their weights alone. Training uses seeds from 10,000 upwards.

Contests are exact and numpy's generator is seeded, so a training repeated gives the same weights. They replace those in
`weights.json`; the curve is a CSV file beside it.
"""

import argparse
import csv
import json
from pathlib import Path

import numpy as np

import wildfire_contest as wf

# Trucks, Wumpuses and their goals, on 500 m.
TEAMS = {
    "posts": [(2, 1, "random-intact"), (4, 2, "random-intact")],
    "lights": [(2, 1, "learned"), (4, 2, "learned")],
}
SIZES = {"posts": 3, "lights": 7}
HIDDEN = 8
SIDE_M = 500.0
FIRST_SEED = 10_000


def scenarios(part, weights):
    """Return the scenarios on which a part is trained."""
    for trucks, wumpuses, goal in TEAMS[part]:
        changes = {
            "duration_s": 1800,
            "field.size_m": SIDE_M,
            "unimog.count": trucks,
            "unimog.planner": "hybrid-astar",
            "wumpus.count": wumpuses,
            "wumpus.goal": goal,
            "dispatch.policy": "auction",
            "dispatch.idle": "centroids",
        }
        changes |= {f"learned.{key}": list(value) for key, value in weights.items()}
        yield wf.scenario("contest-1", changes)


# Regression: where the next fire begins.

MOST_IGNITIONS = 8  # as many as the policy remembers
FORGOTTEN_S = 300.0
LEAST = 0.02  # the least weight of a bush
ELSEWHERE = 64  # places that are compared with that of the ignition


def ignitions(scenario, seed):
    """Return times and places of the fires that Wumpuses lit, one row each."""
    events = wf.run(scenario, seed=seed).events
    lit = [row for row, detail in enumerate(events["detail"]) if detail == "cause=lit"]
    cell_m = 5.0
    columns = [events["t_s"], cell_m * (events["col"] + 0.5), cell_m * (events["row"] + 0.5)]
    return np.array([[column[row] for column in columns] for row in lit], dtype=float).reshape(-1, 3)


def samples(contests, rng):
    """Return inputs by sample, place and ignition, which ignitions there were, and what samples count."""
    inputs, known, counts = [], [], []
    for lit in contests:
        for before, (next_s, *place) in zip(lit, lit[1:]):
            for _ in range(2):
                now_s = rng.uniform(before[0], next_s)
                recent = [row for row in lit if 0 <= now_s - row[0] < FORGOTTEN_S][-MOST_IGNITIONS:]
                places = np.vstack([place, rng.uniform(0, SIDE_M, (ELSEWHERE, 2))])
                sample, is_there = np.zeros((len(places), MOST_IGNITIONS, 3)), np.zeros(MOST_IGNITIONS)
                for number, (lit_s, x, y) in enumerate(recent):
                    sample[:, number, 0] = np.hypot(places[:, 0] - x, places[:, 1] - y) / 100
                    sample[:, number, 1] = (now_s - lit_s) / 60
                    sample[:, number, 2] = rng.choice([0.5, 1.0])
                    is_there[number] = 1
                inputs.append(sample)
                known.append(is_there)
                # A truck can use what comes soon.
                counts.append(np.exp((now_s - next_s) / 60))
    return np.array(inputs), np.array(known), np.array(counts)


def fit(arguments):
    """Return the weights of `posts` of greatest likelihood, and the rows of the curve."""
    rng = np.random.default_rng(arguments.seed)
    seeds = range(FIRST_SEED, FIRST_SEED + arguments.contests)
    contests = [ignitions(scenario, seed) for scenario in scenarios("posts", {}) for seed in seeds]
    inputs, known, counts = samples(contests, rng)
    order = rng.permutation(len(counts))
    held_out, used = order[: len(order) // 5], order[len(order) // 5 :]
    hidden, bias = rng.normal(0, 1, (HIDDEN, 3)), 0.5 + rng.normal(0, 1, HIDDEN)
    parts = [hidden, bias, rng.normal(0, 0.3, HIDDEN), np.zeros(1)]
    first, second, rows = [0 * part for part in parts], [0 * part for part in parts], []

    def weigh(sample):
        units = np.maximum(inputs[sample] @ parts[0].T + parts[1], 0)
        weights = 1 + ((units @ parts[2] + parts[3]) * known[sample][:, None, :]).sum(axis=2)
        return units, weights

    def loss(sample):
        weights = np.maximum(weigh(sample)[1], LEAST)
        return np.average(np.log(weights[:, 1:].mean(axis=1) / weights[:, 0]), weights=counts[sample])

    for step in range(1, arguments.steps + 1):
        sample = rng.choice(used, 128)
        units, weights = weigh(sample)
        floored = np.maximum(weights, LEAST)
        slope = np.tile(1 / floored[:, 1:].sum(axis=1, keepdims=True), floored.shape[1])
        slope[:, 0] = -1 / floored[:, 0]
        slope *= (counts[sample] / counts[sample].sum())[:, None]
        # A little slope is left below the least weight, or a place could never rise again.
        slope = np.where(weights > LEAST, slope, 0.05 * slope * (weights > -1))
        output = slope[:, :, None] * known[sample][:, None, :]
        inner = output[..., None] * parts[2] * (units > 0)
        slopes = [
            np.einsum("npkh,npki->hi", inner, inputs[sample]),
            inner.sum(axis=(0, 1, 2)),
            (units * output[..., None]).sum(axis=(0, 1, 2)),
            output.sum(keepdims=True).reshape(1),
        ]
        rate = 0.01 * (1 + np.cos(np.pi * step / arguments.steps))
        for part, slope, mean, square in zip(parts, slopes, first, second):
            mean += 0.1 * (slope - mean)
            square += 0.01 * (slope**2 - square)
            part -= rate * mean / (1 - 0.9**step) / (np.sqrt(square / (1 - 0.99**step)) + 1e-8)
        if step % (arguments.steps // 10) == 0:
            rows.append({"step": step, "loss": loss(used), "held_out": loss(held_out)})
            print(f"posts {step}: loss {rows[-1]['loss']:.3f}, held out {rows[-1]['held_out']:.3f}", flush=True)
    return np.concatenate([np.hstack([parts[0], parts[1][:, None]]).ravel(), *parts[2:]]), rows


# Evolution.


def losses(part, candidates, others, seeds, jobs):
    """Return the loss of each candidate, relative to that of a network that changes nothing."""
    played = []
    for number, candidate in enumerate([0 * candidates[0], *candidates]):
        for team, scenario in enumerate(scenarios(part, others | {part: candidate})):
            played.append(scenario.with_({"name": f"{number}-{team}"}))
    runs = wf.batch(played, seeds, jobs=jobs, record="none").runs
    burned = np.array(runs["burned_ratio"]).reshape(1 + len(candidates), len(TEAMS[part]), -1).mean(axis=2)
    return (burned[1:] / burned[0]).mean(axis=1)


def initial(part, rng):
    """Return a network that changes nothing, whose hidden units already look at their inputs."""
    inputs = SIZES[part]
    hidden = rng.normal(0, 1 / np.sqrt(inputs), (HIDDEN, inputs + 1))
    return np.concatenate([hidden.ravel(), np.zeros(HIDDEN + 1)])


def evolve(part, others, start, arguments):
    """Return the weights after training, and the rows of its curve."""
    rng = np.random.default_rng(arguments.seed)
    mean = np.array(start) if np.any(start) else initial(part, rng)
    first, second, rows = np.zeros_like(mean), np.zeros_like(mean), []
    pairs = arguments.population // 2
    for generation in range(1, arguments.generations + 1):
        begin = FIRST_SEED + arguments.seeds * (generation - 1) + 100_000 * arguments.seed
        noise = rng.normal(size=(pairs, len(mean)))
        noise = np.concatenate([noise, -noise])
        candidates = [mean, *(mean + arguments.sigma * noise)]
        loss = losses(part, candidates, others, range(begin, begin + arguments.seeds), arguments.jobs)
        rows.append({"generation": generation, "loss": loss[0], "of_candidates": loss[1:].mean()})
        print(f"{part} {generation}: loss {loss[0]:.3f}, of candidates {loss[1:].mean():.3f}", flush=True)
        # The losses of trucks are what an arsonist wants.
        ranks = np.argsort(np.argsort(loss[1:])) / (2 * pairs - 1) - 0.5
        gradient = ranks @ noise / (2 * pairs * arguments.sigma)
        first = 0.9 * first + 0.1 * gradient
        second = 0.99 * second + 0.01 * gradient**2
        step = (first / (1 - 0.9**generation)) / (np.sqrt(second / (1 - 0.99**generation)) + 1e-8)
        mean = mean + arguments.rate * step
    return mean, rows


def main():
    """Train one part from the weights of a file and put the result into it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", choices=SIZES)
    parser.add_argument("--weights", type=Path, default=Path("weights.json"))
    parser.add_argument("--contests", type=int, default=60, help="recorded contests of each team, for posts")
    parser.add_argument("--steps", type=int, default=3000, help="steps of the fit, for posts")
    parser.add_argument("--generations", type=int, default=16)
    parser.add_argument("--population", type=int, default=12)
    parser.add_argument("--seeds", type=int, default=3, help="contests of each candidate and team in a generation")
    parser.add_argument("--sigma", type=float, default=0.15)
    parser.add_argument("--rate", type=float, default=0.08)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    weights = json.loads(arguments.weights.read_text()) if arguments.weights.exists() else {}
    zeros = {part: [0.0] * (HIDDEN * (inputs + 2) + 1) for part, inputs in SIZES.items()}
    weights, part = zeros | weights, arguments.part
    mean, rows = fit(arguments) if part == "posts" else evolve(part, weights, weights[part], arguments)
    weights[part] = [float(f"{weight:.4g}") for weight in mean]
    lines = [f' "{part}": {json.dumps(weights[part])}' for part in SIZES]
    arguments.weights.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    with open(arguments.weights.with_name(f"{part}.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows({key: f"{value:.4g}" for key, value in row.items()} for row in rows)


if __name__ == "__main__":
    main()
