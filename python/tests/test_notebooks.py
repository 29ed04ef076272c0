"""The notebooks run from top to bottom."""

from __future__ import annotations

import json
import pathlib

import pytest

NOTEBOOKS = sorted((pathlib.Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs(notebook: pathlib.Path) -> None:
    names: dict[str, object] = {"__name__": "__main__"}
    for number, cell in enumerate(json.loads(notebook.read_text())["cells"]):
        assert cell.get("outputs", []) == [], "outputs are not kept"
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), f"{notebook.name}, cell {number}", "exec"), names)


def test_all_notebooks_are_there() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["analyse-a-batch", "from-a-question-to-a-figure", "my-planner-against-prm-rs"]
