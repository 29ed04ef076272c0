"""Planners that several tests use."""

from __future__ import annotations

import numpy as np
import pytest

import wildfire_contest as wf


class FirstCurve:
    """Drives the shortest curve into the goal that is free, of those to the poses that the checker offers."""

    def __init__(self, site: wf.Site) -> None:
        self.site = site

    def plan(self, query: wf.Query) -> np.ndarray | None:
        ends = query.checker.goal_poses(query.goal, n=64)
        radius = self.site.vehicle.min_turn_radius
        order = np.argsort(wf.reeds_shepp_length(query.start, ends, radius), kind="stable")
        free = query.checker.curve_is_free(query.start, ends[order], clearance=0.02)
        return ends[order][free][:1] if free.any() else None


@pytest.fixture
def first_curve() -> type[FirstCurve]:
    return FirstCurve


def outcomes(columns: wf.Columns) -> wf.Columns:
    """Return the columns that are equal whenever a seed is run again."""
    return wf.Columns({name: columns[name] for name in columns if not name.startswith(("cpu_", "wall_"))})
