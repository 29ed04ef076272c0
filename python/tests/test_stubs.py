"""The stubs say what the compiled half has."""

from __future__ import annotations

import inspect
import subprocess
import sys

import pytest

import wildfire_contest as wf


def test_stubs_pass_stubtest() -> None:
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "wildfire_contest._core"]
    tested = subprocess.run(command, capture_output=True, text=True, check=False)
    assert tested.returncode == 0, tested.stdout + tested.stderr


def test_everything_that_is_offered_has_words() -> None:
    for name in wf.__all__:
        offered = getattr(wf, name)
        if not isinstance(offered, type) and not inspect.isroutine(offered):
            continue
        assert offered.__doc__, name
        if isinstance(offered, type):
            for member, value in vars(offered).items():
                if not member.startswith("_"):
                    is_field = type(value).__name__ == "_tuplegetter"
                    assert is_field or getattr(value, "__doc__", None), f"{name}.{member}"
