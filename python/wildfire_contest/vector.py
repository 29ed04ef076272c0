"""Many contests per call, which write into the same arrays each time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from wildfire_contest import envs

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["TruckVectorEnv", "truck_vector_env"]

AUTORESET = {"next-step": AutoresetMode.NEXT_STEP, "same-step": AutoresetMode.SAME_STEP}


class TruckVectorEnv(VectorEnv[dict[str, Any], "NDArray[np.int64]", "NDArray[Any]"]):
    """`n` contests, each as in `wildfire_contest.envs.TruckEnv`, advanced together without the interpreter's lock.

    `reset` and `step` return the same arrays every time: copy the values that you want to keep.

    Parameters
    ----------
    n : int
        The number of contests side by side.
    scenario, play, actions, k, wait_s, observe
        As for `TruckEnv`.
    threads : int
        The number of threads that share the work of a step; it does not affect results.
    autoreset : {"next-step", "same-step"}
        When a finished contest restarts: in the next step, which ignores its action, or in the same step, in which case
                ``infos["final_obs"]`` has the last observation.
    """

    def __init__(
        self,
        n: int,
        scenario: Any = "contest",
        *,
        threads: int = 1,
        autoreset: str = "next-step",
        play: Sequence[str] | None = None,
        actions: str = "cells",
        k: int = 16,
        wait_s: float = 10.0,
        observe: str = "everything",
    ) -> None:
        if autoreset not in AUTORESET:
            msg = f'autoreset is {autoreset!r}; expected "next-step" or "same-step"'
            raise ValueError(msg)
        self._contests, self.played = envs.make_contests(
            scenario, n, play, together=False, actions=actions, k=k, wait_s=wait_s, threads=threads, observe=observe
        )
        if len({name.rsplit("_", 1)[0] for name in self.played}) > 1:
            msg = f"play is {self.played}; expected agents of one side"
            raise ValueError(msg)
        own_k = k if actions == "nearest" else None
        self.num_envs = n
        self.metadata = {"autoreset_mode": AUTORESET[autoreset]}
        self.single_observation_space = envs.observation_space(self._contests, own_k)
        self.single_action_space = spaces.Discrete(self._contests.actions)
        self.observation_space = batch_space(self.single_observation_space, n)
        self.action_space = batch_space(self.single_action_space, n)
        self._seen = envs.shared_arrays(self._contests, n)
        self._seen |= {name: array[:, 0] for name, array in envs.own_arrays(self._contests, n, 1, own_k).items()}
        self._same_step = autoreset == "same-step"
        self._waiting: list[int] = []
        self._truncated = np.zeros(n, np.bool_)
        self._all = np.ones(n, np.bool_)

    def _draw(self) -> int:
        return envs.random_seed(self.np_random)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Restart contests: with seeds `seed`, `seed` + 1 ..., with a list of seeds, or with random ones.

        ``options={"reset_mask": mask}`` restarts those alone for which the mask, of shape (n,), is true.
        """
        mask = np.asarray((options or {}).get("reset_mask", self._all), np.bool_)
        if mask.shape != (self.num_envs,) or not mask.any():
            msg = f"reset_mask has shape {mask.shape}; expected ({self.num_envs},), with at least one that is true"
            raise ValueError(msg)
        if seed is None:
            seeds: list[int | None] = [None] * self.num_envs
        elif isinstance(seed, (int, np.integer)):
            super().reset(seed=int(seed))
            seeds = [int(seed) + lane for lane in range(self.num_envs)]
        else:
            seeds = list(seed)
            if len(seeds) != self.num_envs:
                msg = f"found {len(seeds)} seeds for {self.num_envs} contests"
                raise ValueError(msg)
            if isinstance(seeds[0], (int, np.integer)):
                super().reset(seed=int(seeds[0]))
        resets = [(lane, self._draw() if own is None else int(own)) for lane, own in enumerate(seeds) if mask[lane]]
        self._contests.reset(resets)
        self._waiting = [lane for lane in self._waiting if not mask[lane]]
        return self._seen, self._infos()

    def _infos(self) -> dict[str, Any]:
        return {
            "dt_s": self._contests.dt_s,
            "_dt_s": self._all,
            "illegal": self._contests.illegal,
            "_illegal": self._all,
            "action_mask": self._seen["action_mask"],
            "_action_mask": self._all,
        }

    def step(
        self, actions: NDArray[np.int64]
    ) -> tuple[dict[str, Any], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Carry out an action in each contest."""
        contests = self._contests
        resets = [(lane, self._draw()) for lane in self._waiting]
        actions = np.ascontiguousarray(actions, np.int64)
        if actions.ndim != 1:
            msg = f"found actions of shape {actions.shape}; expected ({self.num_envs},)"
            raise ValueError(msg)
        contests.step(actions, resets)
        ended = contests.ended
        self._waiting = np.flatnonzero(ended).tolist() if ended.any() else []
        infos = self._infos()
        if not (self._same_step and self._waiting):
            return self._seen, contests.reward, ended, self._truncated, infos
        reward, ended = contests.reward.copy(), ended.copy()
        infos = {name: array.copy() for name, array in infos.items()}
        final = np.full(self.num_envs, None, object)
        for lane in self._waiting:
            final[lane] = {name: array[lane].copy() for name, array in self._seen.items()}
        contests.reset([(lane, self._draw()) for lane in self._waiting])
        self._waiting = []
        infos |= {"final_obs": final, "_final_obs": ended, "final_info": {"dt_s": infos["dt_s"]}, "_final_info": ended}
        return self._seen, reward, ended, self._truncated, infos


def truck_vector_env(num_envs: int = 1, **options: Any) -> TruckVectorEnv:
    """Return contests side by side; ``gymnasium.make_vec("wildfire/Truck-v0", num_envs)`` calls this."""
    return TruckVectorEnv(num_envs, **options)
