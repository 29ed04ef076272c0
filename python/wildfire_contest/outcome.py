"""The outcome of one run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from wildfire_contest.columns import unknown_name


class Outcome(Mapping[str, Any]):
    """The outcome of a run: the columns of ``runs.csv`` that are not measured, as items or attributes.

    The same scenario and seed give the same outcome on every machine. A value that does not exist is None.

    >>> import wildfire_contest as wf
    >>> outcome = wf.run("smoke", seed=1).outcome
    >>> outcome.obstacles == outcome.intact + outcome.burning + outcome.burned_out + outcome.extinguished
    True
    >>> outcome["status"]
    'done'
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = dict(values)

    def __getitem__(self, name: str) -> Any:
        try:
            return self._values[name]
        except KeyError:
            raise KeyError(unknown_name("column", name, self._values)) from None

    def __getattr__(self, name: str) -> Any:
        # Copying and unpickling access names before there are values.
        values: dict[str, Any] = self.__dict__.get("_values", {})
        if name in values:
            return values[name]
        raise AttributeError(f"{unknown_name('column', name, values)}; its names are {', '.join(values)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._values]

    def __repr__(self) -> str:
        shown = ("scenario", "seed", "planner", "obstacles", "intact", "extinguished", "winner")
        return f"Outcome({', '.join(f'{name}={self._values.get(name)!r}' for name in shown)}, ...)"
