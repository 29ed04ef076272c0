"""Errors of the package: their texts are the sentences of the command line."""

from __future__ import annotations


class WildfireError(Exception):
    """Something that was asked for cannot be done; the text says what and why."""


class ScenarioError(WildfireError):
    """A scenario that is refused.

    Attributes
    ----------
    file : str or None
        The file at fault, ``scenarios/NAME.toml`` for a built-in scenario, or ``--set`` for a change.
    line, column : int or None
        Where in it, both counted from 1.
    """

    def __init__(self, message: str, file: str | None = None, line: int | None = None, column: int | None = None) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column


class NoPath(Exception):
    """Raised by a planner that has no path, with the reason.

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

    Catch it to clean up, and raise it again: whatever is answered afterwards is too late.
    """
