"""The contest as PettingZoo environments for several agents: ``parallel_env()`` and ``env()``.

From PettingZoo 1.27 on, ``pettingzoo.make("parallel", "wildfire/Contest-v0")`` makes the first, with ``"aec"`` the second.

Agents are ``wumpus_0`` ... and ``unimog_0`` ...; agents that are not in `play` follow the scenario's policies.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pettingzoo
from gymnasium import spaces
from gymnasium.utils import seeding
from pettingzoo import AECEnv, ParallelEnv

from wildfire_contest import _core, envs

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["ContestAEC", "ContestParallel", "env", "parallel_env"]

METADATA = {"name": "contest_v0", "render_modes": ["rgb_array"], "render_fps": 4, "is_parallelizable": False}


class _Contest:
    """The parts shared by both environments for several agents."""

    def __init__(
        self,
        scenario: Any,
        play: Sequence[str] | None,
        *,
        together: bool,
        actions: str,
        k: int,
        wait_s: float,
        observe: str,
        render_mode: str | None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            msg = f'render_mode is {render_mode!r}; expected None or "rgb_array"'
            raise ValueError(msg)
        if play is None:
            play = _core.agents_of(scenario)
        self.contests, self.played = envs.make_contests(
            scenario, 1, play, together=together, actions=actions, k=k, wait_s=wait_s, observe=observe
        )
        own_k = k if actions == "nearest" else None
        seats = len(self.played) if together else 1
        self.space = envs.observation_space(self.contests, own_k)
        self.shared = {name: array[0] for name, array in envs.shared_arrays(self.contests, 1).items()}
        self.own = {name: array[0] for name, array in envs.own_arrays(self.contests, 1, seats, own_k).items()}
        self.actions = np.zeros(seats, np.int64)
        self.np_random: np.random.Generator | None = None

    def reset(self, seed: int | None) -> None:
        if seed is not None or self.np_random is None:
            self.np_random, _ = seeding.np_random(seed)
        self.contests.reset([(0, envs.random_seed(self.np_random) if seed is None else seed)])

    def expect_begun(self) -> None:
        if self.np_random is None:
            msg = "there is no contest to play yet: call reset first"
            raise IndexError(msg)

    def seen(self, seat: int | None) -> dict[str, Any]:
        """Return the observation from a seat, or that of an agent that has no choice."""
        seen = {name: array.copy() for name, array in self.shared.items()}
        if seat is not None:
            return seen | {name: array[seat].copy() for name, array in self.own.items()}
        for name, array in self.own.items():
            seen[name] = np.zeros_like(array[0])
        return seen | {"action_mask": self.mask(None)}

    def mask(self, seat: int | None) -> NDArray[np.int8]:
        """Return the action mask of a seat, or that of an agent that can only wait."""
        mask: NDArray[np.int8] = self.own["action_mask"][seat or 0].copy()
        if seat is None:
            mask[:] = 0
            mask[0] = 1
        return mask


class ContestParallel(ParallelEnv[str, dict[str, Any], int]):
    """All agents that have a decision to make act together; the others can only wait, and their actions are ignored."""

    metadata = METADATA | {"is_parallelizable": True}

    def __init__(
        self,
        scenario: Any = "contest",
        *,
        play: Sequence[str] | None = None,
        actions: str = "cells",
        k: int = 16,
        wait_s: float = 10.0,
        observe: str = "everything",
        render_mode: str | None = None,
    ) -> None:
        self._contest = _Contest(
            scenario, play, together=True, actions=actions, k=k, wait_s=wait_s, observe=observe, render_mode=render_mode
        )
        self.render_mode = render_mode
        self.possible_agents = list(self._contest.played)
        self.agents: list[str] = []
        self._action_space = {name: spaces.Discrete(self._contest.contests.actions) for name in self.possible_agents}
        self._observation_space = dict.fromkeys(self.possible_agents, self._contest.space)

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        return self._observation_space[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        return self._action_space[agent]

    def _seen(self) -> dict[str, dict[str, Any]]:
        return {name: self._contest.seen(seat) for seat, name in enumerate(self.possible_agents)}

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, dict[str, Any]], dict[str, dict[str, Any]]]:
        self._contest.reset(seed)
        self.agents = list(self.possible_agents)
        seen = self._seen()
        infos = {name: {"dt_s": 0.0, "illegal": 0, "action_mask": seen[name]["action_mask"]} for name in self.agents}
        return seen, infos

    def step(self, actions: dict[str, int]) -> tuple[dict[str, Any], ...]:
        self._contest.expect_begun()
        if not self.agents:
            return {}, {}, {}, {}, {}
        for seat, name in enumerate(self.possible_agents):
            self._contest.actions[seat] = actions.get(name, 0)
        contests = self._contest.contests
        contests.step(self._contest.actions, [])
        ended, dt_s = bool(contests.ended[0]), float(contests.dt_s[0])
        seats = list(enumerate(self.possible_agents))
        rewards = {name: float(contests.reward[seat]) for seat, name in seats}
        seen = self._seen()
        infos = {
            name: {"dt_s": dt_s, "illegal": int(contests.illegal[seat]), "action_mask": seen[name]["action_mask"]}
            for seat, name in seats
        }
        if ended:
            self.agents = []
        names = self.possible_agents
        return seen, rewards, dict.fromkeys(names, ended), dict.fromkeys(names, False), infos

    def render(self) -> NDArray[np.uint8] | None:
        return None if self.render_mode is None else self._contest.contests.picture(0, envs.PICTURE_SIZE)

    def close(self) -> None:
        """Do nothing: a contest holds no resources that must be closed."""

    def state(self) -> NDArray[np.float32]:
        """Return the whole shared observation in one array."""
        shared = self._contest.shared
        return np.concatenate([array.ravel().astype(np.float32) for array in shared.values()])


class ContestAEC(AECEnv[str, dict[str, Any], int]):
    """One agent acts at a time: only the agent that has a decision to make is selected."""

    metadata = METADATA

    def __init__(
        self,
        scenario: Any = "contest",
        *,
        play: Sequence[str] | None = None,
        actions: str = "cells",
        k: int = 16,
        wait_s: float = 10.0,
        observe: str = "everything",
        render_mode: str | None = None,
    ) -> None:
        super().__init__()
        self._contest = _Contest(
            scenario, play, together=False, actions=actions, k=k, wait_s=wait_s, observe=observe, render_mode=render_mode
        )
        self.render_mode = render_mode
        self.possible_agents = list(self._contest.played)
        self.agents: list[str] = []
        self._asked: str | None = None
        self._action_space = {name: spaces.Discrete(self._contest.contests.actions) for name in self.possible_agents}
        self._observation_space = dict.fromkeys(self.possible_agents, self._contest.space)

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        return self._observation_space[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        return self._action_space[agent]

    def observe(self, agent: str) -> dict[str, Any]:
        return self._contest.seen(0 if agent == self._asked else None)

    def _select(self) -> None:
        turn = int(self._contest.contests.turn[0])
        self._asked = self.possible_agents[turn] if turn >= 0 else None
        if self._asked is not None:
            self.agent_selection = self._asked
            self.infos[self._asked]["action_mask"] = self._contest.mask(0)

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> None:
        self._contest.reset(seed)
        self.agents = list(self.possible_agents)
        self.rewards = dict.fromkeys(self.agents, 0.0)
        self._cumulative_rewards = dict.fromkeys(self.agents, 0.0)
        ended = bool(self._contest.contests.ended[0])
        self.terminations = dict.fromkeys(self.agents, ended)
        self.truncations = dict.fromkeys(self.agents, False)
        self.infos: dict[str, dict[str, Any]] = {
            name: {"dt_s": 0.0, "illegal": 0, "action_mask": self._contest.mask(None)} for name in self.agents
        }
        self.agent_selection = self.agents[0]
        self._select()

    def step(self, action: int | None) -> None:
        self._contest.expect_begun()
        agent = self.agent_selection
        if self.terminations[agent]:
            self._was_dead_step(action)
            return
        contests = self._contest.contests
        self._contest.actions[0] = action
        contests.step(self._contest.actions, [])
        self._cumulative_rewards[agent] = 0.0
        mask = self._contest.mask(None)
        self.infos[agent] = {"dt_s": 0.0, "illegal": int(contests.illegal[0]), "action_mask": mask}
        # The seat's reward is that of the first played agent; the game is zero-sum.
        gained, first = float(contests.reward[0]), self.possible_agents[0].split("_")[0]
        for name in self.agents:
            self.rewards[name] = gained if name.split("_")[0] == first else -gained
            self.infos[name]["dt_s"] += float(contests.dt_s[0])
        self._accumulate_rewards()
        if contests.ended[0]:
            self.terminations = dict.fromkeys(self.agents, True)
            self._asked = None
            self._deads_step_first()
        else:
            self._select()

    def render(self) -> NDArray[np.uint8] | None:
        return None if self.render_mode is None else self._contest.contests.picture(0, envs.PICTURE_SIZE)

    def close(self) -> None:
        """Do nothing: a contest holds no resources that must be closed."""


def parallel_env(scenario: Any = "contest", **options: Any) -> ContestParallel:
    """Return the contest in which all agents with a decision to make act together."""
    return ContestParallel(scenario, **options)


def env(scenario: Any = "contest", **options: Any) -> ContestAEC:
    """Return the contest in which agents act one at a time."""
    return ContestAEC(scenario, **options)


if hasattr(pettingzoo, "register"):
    pettingzoo.register("parallel", "wildfire/Contest-v0", f"{__name__}:parallel_env")
    pettingzoo.register("aec", "wildfire/Contest-v0", f"{__name__}:env")
