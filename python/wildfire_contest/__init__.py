"""A wildfire contest between motion planners, with planners and policies of your own."""

from wildfire_contest._core import (
    Checker,
    Path,
    Query,
    Run,
    Scenario,
    Vehicle,
    __version__,
    dubins_length,
    reeds_shepp_length,
    run,
    scenario,
)
from wildfire_contest.columns import Columns
from wildfire_contest.errors import NoPath, ScenarioError, WildfireError
from wildfire_contest.outcome import Outcome
from wildfire_contest.planners import Disc, Factory, Planner, Planners, Pose

__all__ = [
    "Checker",
    "Columns",
    "Disc",
    "Factory",
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
    "Vehicle",
    "WildfireError",
    "__version__",
    "dubins_length",
    "reeds_shepp_length",
    "run",
    "scenario",
]
