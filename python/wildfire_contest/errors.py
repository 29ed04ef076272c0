"""Errors of the package, with the messages of the command line."""

from __future__ import annotations


class WildfireError(Exception):
    """A request that cannot be carried out; the message explains why."""


class ScenarioError(WildfireError):
    """An invalid scenario.

    Attributes
    ----------
    file : str or None
        The file with the error: ``scenarios/NAME.toml`` for a built-in scenario, ``--set`` for a change.
    line, column : int or None
        The position in it, both counted from 1.
    """

    def __init__(self, message: str, file: str | None = None, line: int | None = None, column: int | None = None) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column


class NoPath(Exception):
    """Raised by a planner that finds no path, with the reason.

    Parameters
    ----------
    reason : str
        ``"start-blocked"``, ``"goal-blocked"``, ``"disconnected"`` or ``"budget-spent"``.
    """

    def __init__(self, reason: str = "disconnected") -> None:
        super().__init__(reason)
        self.reason = reason


class QueryTimedOut(BaseException):
    """Raised in a planner or a policy whose query has taken more CPU time than the scenario allows.

    Catch it to clean up, then raise it again: any later answer is too late.
    """
