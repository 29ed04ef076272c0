"""Watches threads that execute Python and interrupts them."""

from __future__ import annotations

import ctypes
import sys
import threading
import time


def here(limit_s: float | None) -> tuple[int, int | None, float]:
    """Return this thread, its CPU clock, and the reading of that clock at which the limit is reached.

    The clock is None if there is no limit or if the system provides no clocks of other threads.
    """
    thread = threading.get_ident()
    if limit_s is None or not hasattr(time, "pthread_getcpuclockid"):
        return thread, None, 0.0
    clock = time.pthread_getcpuclockid(thread)
    return thread, clock, time.clock_gettime(clock) + limit_s


def is_past(clock: int, end: float) -> bool:
    """Return whether a clock is past a time."""
    return time.clock_gettime(clock) > end


def raise_in(thread: int, exception: type[BaseException] | None) -> None:
    """Raise an exception in a thread when it next executes Python; None cancels one that is still pending."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), exception and ctypes.py_object(exception))


def say(sentence: str) -> None:
    """Write a line to stderr."""
    print(f"wildfire: {sentence}", file=sys.stderr)  # noqa: T201
