"""The interface of custom planners."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from wildfire_contest._core import Path, Query, Site


class Disc(NamedTuple):
    """A goal: the centre of the body within `radius` of a point, at any heading.

    Metres, from the field's south-west corner.
    """

    x: float
    y: float
    radius: float


class Pose(NamedTuple):
    """A pose of the middle of the rear axle, also as a goal: within 1 mm and 0.001 rad.

    Metres from the field's south-west corner, radians counter-clockwise from east.
    """

    x: float
    y: float
    heading: float


class GridSearch(NamedTuple):
    """The result of a search on a grid map."""

    path: NDArray[np.int64]
    """The rows and columns of the cells from start to goal, shape (n, 2); with Theta*, of those where the path turns.

    Empty without a path.
    """

    cost: float
    """The length of the path in cells; inf without a path."""

    expanded: NDArray[np.int64]
    """The cells whose neighbours were examined, in order, shape (m, 2)."""


class Planner(Protocol):
    """Anything with a method `plan`.

    A *factory* creates the planner: it is called with a `Site` once per truck and run; a class will do. The planner answers
        for that truck until the run ends. To be reproducible, the same query must get the same answer regardless of earlier
        queries: use a random generator seeded with ``site.seed``, and bound the search by samples or expansions, not by
        seconds.
    """

    def plan(self, query: Query) -> Path | ArrayLike | None:
        """Find a path from ``query.start`` to ``query.goal``.

        Returns
        -------
        Path, or array of shape (n, 2), or array of shape (n, 3), or None
            ``(n, 2)``: segments of constant curvature (1/m, positive to the left) and signed length (m, negative in
            reverse), from ``query.start`` on. ``(n, 3)``: poses after the start, joined by the shortest Reeds-Shepp
            curves of the vehicle's turning radius. None: start and goal are not connected.

        Raises
        ------
        NoPath
            There is no path, for another reason.
        Exception
            Any other exception marks the query as *crashed*, with the last line of the traceback; the run continues.
        """
        ...


Factory = Callable[["Site"], Planner]
"""Creates a planner for one truck in one run."""

Planners = Mapping[str, Factory]
"""Factories by name: 1 to 40 of ``a-z 0-9 + - _ .``, starting with a letter, and not the name of a built-in planner."""
