"""A wildfire contest between motion planners, open to your own planners and policies.

>>> import wildfire_contest as wf
>>> run = wf.run("contest", seed=7)
>>> run.outcome.winner
'unimog'
>>> batch = wf.batch("smoke", seeds="1..20", planner=["prm-rs", "hybrid-astar"])
>>> float(batch.runs["extinguished"].mean())  # doctest: +SKIP

Lengths are in metres, times in seconds, angles in radians, counter-clockwise from east. x points east and y north from the
field's south-west corner. A pose is that of the middle of the rear axle. Cells are counted from the south-west corner,
and in arrays of cells row 0 is the southernmost.
"""

from importlib import import_module
from types import ModuleType

from wildfire_contest import ompl
from wildfire_contest._core import (
    Batch,
    Checker,
    Path,
    Query,
    Run,
    Scenario,
    Site,
    Vehicle,
    Violation,
    __version__,
    audit,
    batch,
    certify,
    compare,
    dubins_length,
    find_path,
    judge,
    plan,
    plan_together,
    read_batch,
    reeds_shepp_length,
    run,
    scenario,
    search_grid,
    wavefront,
)
from wildfire_contest.columns import Columns
from wildfire_contest.errors import NoPath, ScenarioError, WildfireError
from wildfire_contest.outcome import Outcome
from wildfire_contest.planners import Disc, Factory, GridSearch, Planner, Planners, Pose
from wildfire_contest.program import main

__all__ = [
    "Batch",
    "Checker",
    "Columns",
    "Disc",
    "Factory",
    "GridSearch",
    "NoPath",
    "Outcome",
    "Path",
    "Planner",
    "Planners",
    "Pose",
    "Query",
    "Run",
    "Scenario",
    "ScenarioError",
    "Site",
    "Vehicle",
    "Violation",
    "WildfireError",
    "__version__",
    "audit",
    "batch",
    "certify",
    "compare",
    "dubins_length",
    "find_path",
    "judge",
    "main",
    "ompl",
    "plan",
    "plan_together",
    "read_batch",
    "reeds_shepp_length",
    "run",
    "scenario",
    "search_grid",
    "wavefront",
]


def __getattr__(name: str) -> ModuleType:
    """Import the environments on first access: they need gymnasium and pettingzoo."""
    if name in ("envs", "vector"):
        return import_module(f"wildfire_contest.{name}")
    msg = f"module 'wildfire_contest' has no attribute {name!r}"
    raise AttributeError(msg)
