"""Compare OMPL's planners with the built-in ones in the contest, with and without rescue: bushes saved and CPU time.

    python benches/ompl_contest.py [SEEDS] [NAME=ITERATIONS ...]

Needs numpy and ompl. Prints a Markdown table; intervals are Student's t at 95 %.
"""

import sys
from statistics import NormalDist

import numpy as np
import wildfire_contest as wf

BUILT_IN = ["prm-rs", "hybrid-astar", "prm+primitives", "lattice"]
USUAL = ["RRTConnect=20000", "RRTstar=200", "BITstar=20"]


def interval(values: np.ndarray, decimals: int) -> str:
    """Write a mean and its half interval."""
    count = len(values)
    # Cornish and Fisher's expansion of Student's quantile.
    z = NormalDist().inv_cdf(0.975)
    t = z + (z**3 + z) / (4 * (count - 1)) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * (count - 1) ** 2)
    return f"{values.mean():.{decimals}f} ± {t * values.std(ddof=1) / count**0.5:.{decimals}f}"


def main() -> None:
    """Run all contests and print the table."""
    seeds = sys.argv[1] if len(sys.argv) > 1 else "1..50"
    asked = dict(word.split("=") for word in sys.argv[2:] or USUAL)
    ompl = {f"ompl-{name.lower()}": wf.ompl.planner(name, iterations=int(looks)) for name, looks in asked.items()}
    batch = wf.batch(
        "contest",
        seeds,
        planner=[*BUILT_IN, *ompl],
        planners=ompl,
        sweep={"unimog.rescue": [False, True]},
        jobs=2,
    )
    runs = batch.runs
    print("| planner | saved, no rescue | saved, rescued | failed queries | CPU s a run |")
    print("|---|---|---|---|---|")
    for name in [*BUILT_IN, *ompl]:
        cells = []
        for rescue in (False, True):
            swept = np.array([str(value).lower() for value in runs["unimog.rescue"]])
            chosen = (runs["planner"] == name) & (swept == str(rescue).lower())
            cells.append(interval((runs["intact"] + runs["extinguished"])[chosen].astype(float), 1))
            if not rescue:
                failed = sum(runs[column][chosen].sum() for column in runs if column.startswith("truck_failed_"))
                share = 100 * failed / max(1, runs["truck_plans"][chosen].sum())
                cpu = interval(runs["cpu_unimog_total_s"][chosen].astype(float), 3)
        print(f"| {name} | {cells[0]} | {cells[1]} | {share:.1f} % | {cpu} |")


if __name__ == "__main__":
    main()
