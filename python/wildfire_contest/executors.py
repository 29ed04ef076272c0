"""A batch whose shards run in an executor: of `concurrent.futures`, of Dask, or anything with its `submit`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from typing import Any, Protocol

from wildfire_contest import _core
from wildfire_contest.errors import WildfireError

ATTEMPTS = 3
"""How often a shard is submitted before the batch gives up."""


class Future(Protocol):
    """The result of a call, once it is there."""

    def result(self) -> Any:
        """Wait for the result and return it, or raise what ended the call."""
        ...


class Executor(Protocol):
    """What calls functions in workers, such as a ``concurrent.futures.Executor``."""

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future:
        """Call ``fn(*args)`` in a worker."""
        ...


def run_shard(folder: str, number: int, of: int, rest: tuple[Any, ...]) -> int:
    """Run what is missing of a shard, in a worker, and return how many of its runs were there before."""
    return _core.run_shard(folder, number, of, *rest)


def run_shards(executor: Executor | Callable[[], Executor], folder: str, shards: int, rest: tuple[Any, ...]) -> int:
    """Run all shards of the batch in a folder, and return how many of its runs were there before.

    Shards whose workers died are submitted again, together; their journals keep the runs that were finished.
    """
    held, waiting = 0, list(range(1, shards + 1))
    for attempt in range(1, ATTEMPTS + 1):
        failures: dict[int, Exception] = {}
        with _opened(executor) as opened:
            futures: dict[int, Future] = {}
            try:
                for number in waiting:
                    try:
                        futures[number] = opened.submit(run_shard, folder, number, shards, rest)
                    except BrokenExecutor as error:
                        failures[number] = error
                for number, future in futures.items():
                    try:
                        found = future.result()
                        held += found if attempt == 1 else 0
                    except WildfireError as error:
                        msg = f"shard {number} of {shards}: {error}"
                        raise WildfireError(msg) from error
                    except Exception as error:  # noqa: BLE001
                        failures[number] = error
            finally:
                for future in futures.values():
                    getattr(future, "cancel", lambda: None)()
        if not failures:
            break
        waiting = sorted(failures)
        first = failures[waiting[0]]
        is_broken = isinstance(first, BrokenExecutor) and hasattr(executor, "submit")
        if attempt == ATTEMPTS or is_broken:
            msg = f"shard {waiting[0]} of {shards} failed {attempt} times: {type(first).__name__}: {first}".replace(" 1 times", "")
            advice = " (a callable, such as `executor=lambda: ProcessPoolExecutor(4)`, would give another pool)"
            raise WildfireError(msg + advice * is_broken) from first
    return held


@contextmanager
def _opened(executor: Executor | Callable[[], Executor]) -> Iterator[Executor]:
    """Yield the caller's executor as it is, or one of its callable, which then is shut down."""
    if hasattr(executor, "submit"):
        yield executor
        return
    made = executor()
    try:
        yield made
    finally:
        getattr(made, "shutdown", lambda: None)()
