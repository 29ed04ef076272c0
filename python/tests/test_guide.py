"""What the guide and the docstrings show is so."""

from __future__ import annotations

import doctest
import pathlib

import pytest

import wildfire_contest as wf

GUIDE = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


@pytest.mark.skipif(not GUIDE.exists(), reason="the guide is in the repository")
def test_the_guide_shows_what_happens() -> None:
    tested = doctest.testfile(str(GUIDE), module_relative=False)
    assert tested.failed == 0 and tested.attempted > 20


def test_docstrings_show_what_happens() -> None:
    for module in (wf, wf.outcome, wf.ompl):
        assert doctest.testmod(module).failed == 0, module
