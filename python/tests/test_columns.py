"""Tables as columns of numpy, pandas, polars and Arrow."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping

import numpy as np
import pytest
from conftest import outcomes

import wildfire_contest as wf
from wildfire_contest import Columns


@pytest.fixture(scope="module")
def calls() -> Columns:
    return wf.run("smoke", 3).calls


def test_columns_are_a_mapping(calls: Columns) -> None:
    assert isinstance(calls, Mapping) and len(calls) == len(list(calls)) == len(calls.keys())
    assert calls.rows == len(calls["t_s"]) and "nothing" not in calls
    with pytest.raises(KeyError):
        calls["nothing"]
    again, other = (outcomes(wf.run("smoke", seed).calls) for seed in (3, 4))
    assert outcomes(calls) == again != other


@pytest.mark.parametrize(("table", "schema"), [("runs", "runs"), ("calls", "planner-calls"), ("states", "states")])
def test_names_types_and_units_are_those_of_the_schema(table: str, schema: str) -> None:
    command = [sys.executable, "-m", "wildfire_contest", "schema", schema]
    properties = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["properties"]
    columns: Columns = getattr(wf.batch("smoke", seeds="1..2"), table)
    assert sorted(columns) == sorted(properties)
    kinds = {"integer": "i", "number": "f", "string": "O", "boolean": "b"}
    for name, about in properties.items():
        kind = about["type"] if isinstance(about["type"], str) else about["type"][0]
        assert columns[name].dtype.kind == kinds[kind], name
        assert columns.units[name] == about.get("unit", "") and columns.words[name] == about["description"]


def test_what_is_missing_is_masked_or_nan_or_none(calls: Columns) -> None:
    failed = ~calls["solved"].astype(bool)
    assert (np.isnan(calls["solution_length_m"]) == failed).all()
    assert (np.ma.getmaskarray(calls["cusps"]) == failed).all() and calls["cusps"].dtype == np.int64
    wumpus = np.array([agent.startswith("wumpus") for agent in calls["agent"]])
    assert all(found is None for found in calls["found_by"][wumpus])


def example() -> Columns:
    """Return a table with each kind of column, whole and with a hole."""
    mask = [False, True, False]
    return Columns(
        {
            "count": np.array([1, 2, 3]),
            "count_or_none": np.ma.MaskedArray([1, 2, 3], mask),
            "large": np.array([1, 2, 2**64 - 1], dtype=np.uint64),
            "real": np.array([0.5, np.nan, -1.0]),
            "flag": np.array([True, False, True]),
            "flag_or_none": np.ma.MaskedArray([True, False, True], mask),
            "text": np.array(["a", None, "c"], dtype=object),
        },
        units={"real": "s"},
        words={"real": "time"},
    )


def test_to_pandas() -> None:
    pandas = pytest.importorskip("pandas")
    frame = example().to_pandas()
    assert list(frame.columns) == list(example()) and len(frame) == 3
    assert str(frame["count"].dtype) == "int64" and str(frame["count_or_none"].dtype) == "Int64"
    assert str(frame["flag_or_none"].dtype) == "boolean"
    assert frame["count_or_none"].isna().tolist() == [False, True, False]
    assert frame["count_or_none"].sum() == 4 and frame["large"].iloc[2] == 2**64 - 1
    assert pandas.isna(frame["text"].iloc[1]) and frame["real"].isna().tolist() == [False, True, False]


def test_to_polars() -> None:
    pytest.importorskip("polars")
    frame = example().to_polars()
    assert frame["count_or_none"].to_list() == [1, None, 3] and frame["real"].to_list() == [0.5, None, -1.0]
    assert frame["flag_or_none"].to_list() == [True, None, True] and frame["text"].to_list() == ["a", None, "c"]
    assert frame["large"].to_list()[2] == 2**64 - 1


def test_to_arrow() -> None:
    pytest.importorskip("pyarrow")
    table = example().to_arrow()
    assert table.column("count_or_none").to_pylist() == [1, None, 3]
    assert table.column("real").to_pylist() == [0.5, None, -1.0]
    assert table.schema.field("real").metadata == {b"unit": b"s", b"description": b"time"}


def test_columns_compare_with_their_holes() -> None:
    other = {**example(), "count_or_none": np.ma.MaskedArray([1, 7, 3], [False, True, False])}
    assert example() == Columns(other) and example() == example()
    assert example() != Columns({**other, "count_or_none": np.array([1, 7, 3])})
    assert example() != Columns({name: example()[name] for name in reversed(list(example()))})
    assert example() != 1
