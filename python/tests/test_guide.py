"""Pages of the guide and docstrings show what happens."""

from __future__ import annotations

import doctest
import pathlib
import types

import pytest

import wildfire_contest as wf

GUIDE = pathlib.Path(__file__).parents[2] / "docs"


@pytest.mark.skipif(not GUIDE.exists(), reason="the guide is in the repository")
@pytest.mark.parametrize("page", ["python.md"])
def test_the_guide_shows_what_happens(page: str) -> None:
    tested = doctest.testfile(str(GUIDE / page), module_relative=False)
    assert tested.failed == 0 and tested.attempted > 20


@pytest.mark.parametrize("module", [wf, wf.outcome, wf.ompl])
def test_docstrings_show_what_happens(module: types.ModuleType) -> None:
    if module is wf.ompl:
        pytest.importorskip("ompl")
    assert doctest.testmod(module).failed == 0
