"""Play dispatchers against arsonists, all against all, and print the table with what each can be exploited for.

    python cross.py --trucks 4 --wumpuses 2 --seeds 1..40

The value of the game, in bushes lost per thousand, is that of the best mixtures of both sides: linear programming by
multiplicative weights (Freund and Schapire, "Adaptive game playing using multiplicative weights", 1999). A side is
exploitable by what its worst opponent takes beyond that value.
"""

import argparse

import numpy as np

import wildfire_contest as wf

DISPATCHERS = {
    "nearest": ("nearest", "centroids"),
    "nearest-savable": ("nearest-savable", "centroids"),
    "threat-first": ("threat-first", "centroids"),
    "auction": ("auction", "centroids"),
    "auction, learned": ("auction", "learned"),
    "rollout, learned": ("rollout", "learned"),
}
ARSONISTS = ["random-intact", "nearest-intact", "farthest-from-truck", "densest", "densest-apart", "learned"]
ROUNDS = 20_000


def losses(arguments):
    """Return the mean of bushes lost per thousand, by dispatcher and arsonist."""
    scenarios = []
    for name, (policy, idle) in DISPATCHERS.items():
        for goal in ARSONISTS:
            changes = {
                "duration_s": 1800,
                "field.size_m": 500,
                "unimog.count": arguments.trucks,
                "unimog.planner": "hybrid-astar",
                "wumpus.count": arguments.wumpuses,
                "wumpus.goal": goal,
                "dispatch.policy": policy,
                "dispatch.idle": idle,
            }
            scenarios.append(wf.scenario("contest-1", changes | {"name": f"{name} {goal}"}))
    runs = wf.batch(scenarios, arguments.seeds, jobs=arguments.jobs).runs
    burned = 1000 * np.array(runs["burned_ratio"]).reshape(len(DISPATCHERS), len(ARSONISTS), -1)
    return burned.mean(axis=2), 1.96 * burned.std(axis=2, ddof=1) / np.sqrt(burned.shape[2])


def mixtures(table):
    """Return the best mixtures of dispatchers, who want little, and of arsonists, who want much."""
    scaled = table / table.max()
    ours, theirs = np.zeros(len(table)), np.zeros(table.shape[1])
    means = [np.zeros_like(ours), np.zeros_like(theirs)]
    for number in range(1, ROUNDS + 1):
        shares = [np.exp(side - side.max()) for side in (ours, theirs)]
        shares = [share / share.sum() for share in shares]
        for mean, share in zip(means, shares):
            mean += share / ROUNDS
        rate = np.sqrt(8 / number)
        ours -= rate * scaled @ shares[1]
        theirs += rate * shares[0] @ scaled
    return means


def main():
    """Print the table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trucks", type=int, default=4)
    parser.add_argument("--wumpuses", type=int, default=2)
    parser.add_argument("--seeds", default="1..40")
    parser.add_argument("--jobs", type=int, default=-1)
    table, widths = losses(arguments := parser.parse_args())
    ours, theirs = mixtures(table)
    value = ours @ table @ theirs
    print("| | " + " | ".join(ARSONISTS) + " | exploitable | share |")
    print("|---|" + "---|" * (len(ARSONISTS) + 2))
    for name, row, width, share in zip(DISPATCHERS, table, widths, ours):
        cells = [f"{mean:.0f} ± {half:.0f}" for mean, half in zip(row, width)]
        print(f"| {name} | {' | '.join(cells)} | {max(0, round(max(row) - value))} | {share:.2f} |")
    print("| exploitable | " + " | ".join(f"{max(0, round(value - least))}" for least in table.min(axis=0)) + " | | |")
    print("| share | " + " | ".join(f"{share:.2f}" for share in theirs) + " | | |")
    bounds = (table @ theirs).min(), (ours @ table).max()
    seeds = f"{arguments.trucks} trucks, {arguments.wumpuses} Wumpuses, seeds {arguments.seeds}"
    print(f"\nValue of the game: {value:.1f}, between {bounds[0]:.1f} and {bounds[1]:.1f} ({seeds}).")


if __name__ == "__main__":
    main()
