"""Environments for reinforcement learning: the contest as a sequence of decisions.

An agent is asked for a decision when its built-in rule would choose and it has something to choose from. A step carries out
the action and lasts until the next played agent is asked; the scenario determines planning and driving.

Needs gymnasium, and pettingzoo for several agents: ``pip install wildfire-contest[envs]``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

try:
    import gymnasium
    from gymnasium import spaces
except ModuleNotFoundError as error:
    raise ModuleNotFoundError("this module needs gymnasium: pip install 'wildfire-contest[envs]'", name=error.name) from error

from wildfire_contest import _core
from wildfire_contest.policies import Policy

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["TEST_SEEDS", "TRAINING_SEEDS", "DriveEnv", "Policy", "TruckEnv", "contest_v0", "nearest", "random_seed"]

TEST_SEEDS = range(0, 2**32)
"""Seeds for tests: the small numbers that people type, such as 1 to 1000. Training without a seed never uses them."""

TRAINING_SEEDS = range(2**32, 2**53)
"""Seeds from which ``reset()`` without a seed picks at random."""

PICTURE_SIZE = (800, 800)
"""Width and height of pictures, in pixels."""


def random_seed(generator: np.random.Generator) -> int:
    """Return a random seed of a contest for training, one of `TRAINING_SEEDS`."""
    return int(generator.integers(TRAINING_SEEDS.start, TRAINING_SEEDS.stop))


def make_contests(
    scenario: Any,
    lanes: int,
    play: Sequence[str] | None,
    *,
    together: bool,
    actions: str,
    k: int,
    wait_s: float,
    threads: int = 1,
    observe: str = "everything",
) -> tuple[_core.Contests, list[str]]:
    """Create contests side by side, and return them with the names of the played agents: by default all trucks."""
    if actions not in ("cells", "nearest"):
        msg = f'actions is {actions!r}; expected "cells" or "nearest"'
        raise ValueError(msg)
    if observe not in ("everything", "sight"):
        msg = f'observe is {observe!r}; expected "everything" or "sight"'
        raise ValueError(msg)
    if play is None:
        play = [name for name in _core.agents_of(scenario) if name.startswith("unimog")]
    nearest_k = k if actions == "nearest" else None
    contests = _core.Contests(
        scenario,
        lanes,
        list(play),
        together=together,
        nearest=nearest_k,
        wait_s=wait_s,
        threads=threads,
        by_sight=observe == "sight",
    )
    return contests, list(play)


def observation_space(contests: _core.Contests, k: int | None) -> spaces.Dict:
    """Return the observation space; `k` is the number of candidates, if there are any."""
    rows, cols = contests.shape
    agents = len(contests.agents_named)
    parts: dict[str, spaces.Space[Any]] = {
        "cells": spaces.Box(0, 4, (rows, cols), np.uint8),
        "burning_s": spaces.Box(0, np.inf, (rows, cols), np.float32),
        "agents": spaces.Box(-np.inf, np.inf, (agents, 8), np.float32),
        "time_s": spaces.Box(0, np.inf, (2,), np.float32),
        "action_mask": spaces.Box(0, 1, (contests.actions,), np.int8),
    }
    if k is not None:
        parts["candidates"] = spaces.Box(-np.inf, np.inf, (k, 6), np.float32)
    return spaces.Dict(parts)


def shared_arrays(contests: _core.Contests, lanes: int) -> dict[str, NDArray[Any]]:
    """Return the part of the observation that all agents share, by lane. Steps write into the same arrays."""
    rows, cols = contests.shape
    return {
        "cells": contests.cells.reshape(lanes, rows, cols),
        "burning_s": contests.burning_s.reshape(lanes, rows, cols),
        "agents": contests.agents.reshape(lanes, -1, 8),
        "time_s": contests.time_s.reshape(lanes, 2),
    }


def own_arrays(contests: _core.Contests, lanes: int, seats: int, k: int | None) -> dict[str, NDArray[Any]]:
    """Return the part of the observation that belongs to one agent, by lane and seat."""
    arrays: dict[str, NDArray[Any]] = {"action_mask": contests.action_mask.reshape(lanes, seats, -1)}
    if k is not None:
        arrays["candidates"] = contests.candidates.reshape(lanes, seats, k, 6)
    return arrays


class TruckEnv(gymnasium.Env[dict[str, Any], np.int64]):
    """The contest as a Gymnasium environment, ``wildfire/Truck-v0``.

    Parameters
    ----------
    scenario : str, path or Scenario
        The scenario to play.
    play : sequence of str, optional
        The agents to play: by default all trucks, one at a time (``observation["agents"][:, 7]`` shows whose turn it is).
    actions : {"cells", "nearest"}
        ``"cells"``: 0 waits, 1 + row * columns + column drives to a cell. ``"nearest"``: 0 waits, 1 + i drives to
                candidate i of the `k` nearest.
    k : int
        The number of candidates with ``actions="nearest"``.
    wait_s : float
        The longest wait in seconds: action 0 lasts until a bush changes, but at most this long.
    observe : {"everything", "sight"}
        ``"sight"``: what the team of trucks sees by the scenario's table ``[sight]``. A bush that burns unseen looks intact
                and cannot be chosen, and the row of an unseen Wumpus is -1, -1, 0, 0, -1, -1, 0, 0. Only trucks can be played.
    render_mode : {None, "rgb_array"}
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 4}  # noqa: RUF012

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
        if render_mode not in (None, "rgb_array"):
            msg = f'render_mode is {render_mode!r}; expected None or "rgb_array"'
            raise ValueError(msg)
        self._contests, self.played = make_contests(
            scenario, 1, play, together=False, actions=actions, k=k, wait_s=wait_s, observe=observe
        )
        if len({name.rsplit("_", 1)[0] for name in self.played}) > 1:
            msg = f"play is {self.played}; expected agents of one side; use an environment for several agents to mix sides"
            raise ValueError(msg)
        own_k = k if actions == "nearest" else None
        self.observation_space = observation_space(self._contests, own_k)
        self.action_space = spaces.Discrete(self._contests.actions)
        self.render_mode = render_mode
        views = {name: array[0] for name, array in shared_arrays(self._contests, 1).items()}
        views |= {name: array[0, 0] for name, array in own_arrays(self._contests, 1, 1, own_k).items()}
        self._views = views
        self._reward, self._dt_s = self._contests.reward, self._contests.dt_s
        self._illegal, self._ended = self._contests.illegal, self._contests.ended
        self._action = np.zeros(1, np.int64)

    def _seen(self) -> dict[str, Any]:
        return {name: view.copy() for name, view in self._views.items()}

    def _first_observation(self) -> tuple[dict[str, Any], dict[str, Any]]:
        seen = self._seen()
        return seen, {"dt_s": 0.0, "illegal": 0, "action_mask": seen["action_mask"]}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict[str, Any], dict[str, Any]]:
        """Start a contest: that of `seed`, or the next in the random sequence that the last seed started."""
        super().reset(seed=seed, options=options)
        self._contests.reset([(0, random_seed(self.np_random) if seed is None else seed)])
        return self._first_observation()

    def step(self, action: np.int64 | int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Carry out an action and advance to the next decision.

        A masked action waits, and ``info["illegal"]`` is 1; an action outside the space raises `ValueError`.
                ``info["dt_s"]`` is the simulated time that the step took.
        """
        self._action[0] = action
        self._contests.step(self._action, [])
        seen = self._seen()
        info = {"dt_s": float(self._dt_s[0]), "illegal": int(self._illegal[0]), "action_mask": seen["action_mask"]}
        return seen, float(self._reward[0]), bool(self._ended[0]), False, info

    def save(self) -> _core.SavedContest:
        """Return a copy of the contest as it is now, for `restore`. It can be pickled: then it is played again up to there."""
        return self._contests.save(0)

    def restore(self, state: _core.SavedContest, *, future: int | None = None) -> tuple[dict[str, Any], dict[str, Any]]:
        """Make the contest what it was when it was saved.

        Without `future` it goes on as it did. With a number, what is left to chance is drawn again from here on, so that a
        planner that tries actions does not know the future; the same number is the same future.
        """
        self._contests.restore(0, state, future)
        return self._first_observation()

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override]
        """Return a picture of the contest's current state, of shape (height, width, 3)."""
        return None if self.render_mode is None else self._contests.picture(0, PICTURE_SIZE)

    def action_masks(self) -> NDArray[np.bool_]:
        """Return which actions are allowed, in the form that ``MaskablePPO`` of sb3-contrib expects."""
        masks: NDArray[np.bool_] = self._views["action_mask"] == 1
        return masks


def nearest(observation: dict[str, Any]) -> int:
    """Choose as the built-in nearest-fire rule does, from an observation with ``actions="nearest"``.

    Candidates are sorted by distance, so this is the first free one.
    """
    free = np.flatnonzero(observation["action_mask"][1:])
    return int(free[0]) + 1 if free.size else 0


class DriveEnv(gymnasium.Env[dict[str, Any], "NDArray[np.float32]"]):
    """Steer the truck to a goal, ``wildfire/Drive-v0``.

    The action is a fraction of the sharpest curvature, positive to the left, and a fraction of the top speed, negative in
        reverse; a step is half a second of simulated time. ``clearance`` is the distance to the nearest bush or border in tens
        of metres, on 64 x 64 points half a metre apart around the truck: row 0 is 15.75 m to its right, column 0 as far behind.
        ``goal`` is the offset of the goal, ahead and to the left, and its radius, in metres.

    The reward is the progress towards the goal in metres, plus 10 on arrival and -10 on contact; either ends the drive. Not
        every goal is reachable; ``gymnasium.make`` ends a drive after 1000 steps.
    """

    metadata = {"render_modes": []}  # noqa: RUF012

    def __init__(self, scenario: Any = "contest", *, truck: int = 0) -> None:
        self._driver = _core.Driver(scenario, truck)
        self.observation_space = spaces.Dict(
            {
                "clearance": spaces.Box(-1, 10, (64, 64), np.float32),
                "goal": spaces.Box(-np.inf, np.inf, (3,), np.float32),
            }
        )
        self.action_space = spaces.Box(-1, 1, (2,), np.float32)
        self.render_mode = None

    def _seen(self) -> dict[str, Any]:
        clearance, goal = self._driver.seen()
        return {"clearance": clearance, "goal": goal}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict[str, Any], dict[str, Any]]:
        """Start a drive on the field of `seed`, or of the next seed in the random sequence that the last one started."""
        super().reset(seed=seed, options=options)
        self._driver.reset(random_seed(self.np_random) if seed is None else seed)
        return self._seen(), {}

    def step(self, action: NDArray[np.float32]) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Drive for half a second."""
        nearer, arrived, touched = self._driver.step(float(action[0]), float(action[1]))
        reward = nearer + 10.0 * arrived - 10.0 * touched
        return self._seen(), reward, arrived or touched, False, {"arrived": arrived}


def __getattr__(name: str) -> ModuleType:
    """Import the contest for several agents on first access: it needs pettingzoo."""
    if name == "contest_v0":
        return import_module("wildfire_contest.contest_v0")
    msg = f"module 'wildfire_contest.envs' has no attribute {name!r}"
    raise AttributeError(msg)


gymnasium.register(
    id="wildfire/Truck-v0",
    entry_point="wildfire_contest.envs:TruckEnv",
    vector_entry_point="wildfire_contest.vector:truck_vector_env",
)
gymnasium.register(id="wildfire/Drive-v0", entry_point="wildfire_contest.envs:DriveEnv", max_episode_steps=1000)

Act = Callable[[dict[str, Any]], int]
