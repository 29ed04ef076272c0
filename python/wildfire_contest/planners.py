"""What a planner of one's own is, and what it is told."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from wildfire_contest._core import Path, Query, Site


class Disc(NamedTuple):
    """A goal: the centre of the body within `radius` of a place, at any heading.

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


class Planner(Protocol):
    """Anything with a method `plan`.

    A planner is made by a *factory*, which is called with a `Site` once for each truck and run; a class will do. It
    answers for that truck until the run is over. The same queries must get the same answers, whatever was asked
    before, or runs cannot be repeated: draw from a generator that is seeded by ``site.seed``, stop after samples or
    expansions and not after seconds.
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
            Any other makes the query *crashed*, with the last line of the traceback; the run goes on.
        """
        ...


Factory = Callable[["Site"], Planner]
"""Makes a planner for one truck in one run."""

Planners = Mapping[str, Factory]
"""Factories by names: 1 to 40 of ``a-z 0-9 + - _ .``, a letter first, and not that of a built-in planner."""
