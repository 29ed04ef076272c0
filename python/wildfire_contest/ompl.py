"""Planners of OMPL, the Open Motion Planning Library, for the truck.

Needs the package ``ompl`` (``pip install wildfire-contest[ompl]``), 2.0 or newer.

>>> import wildfire_contest as wf
>>> factory = wf.ompl.planner("RRTConnect", iterations=20_000)
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildfire_contest.errors import NoPath

if TYPE_CHECKING:
    from wildfire_contest._core import Checker, Query, Site

_ONE_AT_A_TIME = threading.Lock()
"""OMPL derives the seeds of all its generators from a single one per process."""

_START_SHARE = 0.9
_LEAST_CLEARANCE = 0.01
_SIMPLIFYING_ROUNDS = 10


def planner(
    name: str,
    *,
    iterations: int = 20_000,
    simplify: bool = False,
    clearance: float = 0.1,
    goals: int = 24,
    params: Mapping[str, object] | None = None,
) -> Callable[[Site], OmplPlanner]:
    """Return a factory of OMPL planners, to pass in like your own planners.

    The planner searches over Reeds-Shepp curves of the vehicle's turning radius. A pose is valid if the checker reports it
        as free, a motion if its whole curve is free. A drive ends in one of the poses of ``checker.goal_poses``. Runs are
        reproducible: the generator is seeded with ``site.seed`` before each query, and a query ends after a number of
        evaluations of the termination condition, never by time.

    Parameters
    ----------
    name : str
        A class of ``ompl.geometric``, such as ``"RRTConnect"``, ``"RRTstar"`` or ``"BITstar"``.
    iterations : int
        The number of evaluations of the termination condition. Planners that improve a path use them all.
    simplify : bool
        Whether OMPL shortens the path found, in at most 10 rounds.
    clearance : float
        Metres to keep from bushes and border; less if the truck starts with less.
    goals : int
        The number of goal poses to sample in a goal disc.
    params : mapping, optional
        Parameters of the planner under OMPL's names, such as ``{"range": 20}``.

    Raises
    ------
    ImportError
        OMPL is not installed.
    ValueError
        OMPL has no planner of this name.
    """
    from ompl import geometric

    made = getattr(geometric, name, None)
    if not (isinstance(made, type) and hasattr(made, "solve")):
        raise ValueError(f"ompl.geometric has no planner {name!r}")
    if iterations < 1 or goals < 1:
        raise ValueError("iterations and goals must be at least 1")

    # The arguments are part of the fingerprint.
    return functools.partial(
        OmplPlanner,
        made=made,
        iterations=iterations,
        simplify=simplify,
        clearance=clearance,
        goals=goals,
        params=tuple((params or {}).items()),
    )


class OmplPlanner:
    """An OMPL planner for one truck; created by the factory that :func:`planner` returns."""

    def __init__(
        self,
        site: Site,
        made: Callable[[Any], Any],
        iterations: int,
        simplify: bool,
        clearance: float,
        goals: int,
        params: tuple[tuple[str, object], ...],
    ) -> None:
        self.made = made
        self.iterations = iterations
        self.simplify = simplify
        self.clearance = clearance
        self.goals = goals
        self.params = params
        self.radius = site.vehicle.min_turn_radius
        # OMPL seeds have 32 bits, and 0 would let OMPL choose a seed.
        self.seed = site.seed % (2**31 - 1) + 1

    def plan(self, query: Query) -> NDArray[np.float64]:
        """Find poses that lead to the goal, each joined to the one before by the shortest Reeds-Shepp curve."""
        from ompl import util

        checker = query.checker
        if query.meets(query.start):
            return np.empty((0, 3))
        room = float(checker.clearance(query.start))
        if not checker.pose_is_free(query.start):
            raise NoPath("start-blocked")
        clearance = min(self.clearance, max(_START_SHARE * room, _LEAST_CLEARANCE))
        ends = checker.goal_poses(query.goal, self.goals, clearance)
        if len(ends) == 0:
            raise NoPath("goal-blocked")
        with _ONE_AT_A_TIME:
            # OMPL warns of every seed but the first.
            level = util.getLogLevel()
            util.setLogLevel(util.LogLevel.LOG_NONE)
            try:
                util.RNG.setSeed(self.seed)
                poses = self._search(checker, query.start, ends, clearance)
            finally:
                util.setLogLevel(level)
        if poses is None:
            raise NoPath("budget-spent")
        return poses

    def _search(
        self, checker: Checker, start: tuple[float, float, float], ends: NDArray[np.float64], clearance: float
    ) -> NDArray[np.float64] | None:
        from ompl import base, geometric

        space = base.ReedsSheppStateSpace(self.radius)
        bounds = base.RealVectorBounds(2)
        for axis, size in enumerate(checker.size_m):
            bounds.setLow(axis, 0.0)
            bounds.setHigh(axis, size)
        space.setBounds(bounds)
        setup = geometric.SimpleSetup(space)
        information = setup.getSpaceInformation()

        def is_valid(state: Any) -> bool:
            return bool(checker.pose_is_free((state.getX(), state.getY(), state.getYaw()), clearance))

        class CurveIsFree(base.MotionValidator):  # type: ignore[misc]
            def checkMotion(self, one: Any, other: Any) -> bool:
                here = (one.getX(), one.getY(), one.getYaw())
                there = (other.getX(), other.getY(), other.getYaw())
                return bool(checker.curve_is_free(here, there, clearance))

        def state(pose: Any) -> Any:
            made = space.allocState()
            made.setX(float(pose[0]))
            made.setY(float(pose[1]))
            made.setYaw(float(pose[2]))
            return made

        setup.setStateValidityChecker(is_valid)
        validator = CurveIsFree(information)
        information.setMotionValidator(validator)
        setup.setStartState(state(start))
        goal = base.GoalStates(information)
        for end in ends:
            goal.addState(state(end))
        setup.setGoal(goal)
        search = self.made(information)
        for name, value in self.params:
            search.params().setParam(name, str(value))
        setup.setPlanner(search)
        setup.solve(_after(self.iterations))
        if not setup.haveExactSolutionPath():
            return None
        path = setup.getSolutionPath()
        if self.simplify:
            geometric.PathSimplifier(information).simplify(path, _after(_SIMPLIFYING_ROUNDS))
        poses = [(state.getX(), state.getY(), state.getYaw()) for state in path.getStates()]
        return np.array(poses[1:], dtype=np.float64).reshape(-1, 3)


def _after(iterations: int) -> Any:
    """Return a termination condition that is met after a number of evaluations."""
    from ompl import base

    left = iterations

    def is_met() -> bool:
        nonlocal left
        left -= 1
        return left < 0

    return base.PlannerTerminationCondition(is_met)
