"""Custom policies: they decide which agent goes where, and are passed in by name like planners."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any


class Policy:
    """A policy that receives the observations of the environments, for ``policies={"net": Policy(act, ...)}``.

    Parameters
    ----------
    act : callable
        Maps an observation, as in `wildfire_contest.envs.TruckEnv`, to an action. If both trucks and Wumpuses follow the
                policy, it decides for both; ``observation["agents"][:, 7]`` is 1 for the agent whose turn it is. For crews
                it maps a dictionary with the key ``line`` to points of line in metres.
    actions, k, wait_s
        As for `TruckEnv`.
    per_run : bool
        If true, `act` creates the callable instead: it is called once per run with a dictionary of ``scenario``, ``seed``,
                ``agents``, ``plays``, ``settings`` and ``draw``, a seed reserved for the policy.
    """

    def __init__(
        self,
        act: Callable[[Any], Any],
        *,
        actions: str = "cells",
        k: int = 16,
        wait_s: float = 10.0,
        per_run: bool = False,
    ) -> None:
        if not callable(act):
            msg = f"a policy is a {type(act).__name__}; expected a callable that takes an observation"
            raise TypeError(msg)
        if actions not in ("cells", "nearest"):
            msg = f'actions is {actions!r}; expected "cells" or "nearest"'
            raise ValueError(msg)
        if actions == "nearest" and not 1 <= k <= 1000:
            msg = f"k is {k}; expected 1 to 1000"
            raise ValueError(msg)
        if not 0.1 <= wait_s <= 1e6:
            msg = f"wait_s is {wait_s}; expected 0.1 to 1e6"
            raise ValueError(msg)
        self.act = act
        self.nearest = k if actions == "nearest" else None
        self.wait_s = wait_s
        self.per_run = per_run


Policies = Mapping[str, "Policy | Callable[[dict[str, Any]], int]"]
"""Policies by name; a callable is a `Policy` over all cells."""


def as_policy(given: Policy | Callable[[Any], Any]) -> Policy:
    """Return the policy itself, or wrap a callable as one."""
    return given if isinstance(given, Policy) else Policy(given)
