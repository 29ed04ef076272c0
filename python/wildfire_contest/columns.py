"""Tables as columns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


class Columns(Mapping[str, NDArray[Any]]):
    """A table: a mapping of column names to numpy arrays with one value per row.

    ``wildfire schema`` prints the names, kinds and units. Integers are ``int64``, numbers ``float64``, flags ``bool``,
        text ``object`` arrays of ``str``. Missing numbers are nan and missing text is None; integers and flags with missing
        values are a ``numpy.ma.MaskedArray``.

    Attributes
    ----------
    units : Mapping[str, str]
        The unit of each column, such as ``"s"``; empty for names and plain counts.
    words : Mapping[str, str]
        The meaning of each column.
    """

    def __init__(
        self,
        columns: Mapping[str, NDArray[Any]],
        units: Mapping[str, str] | None = None,
        words: Mapping[str, str] | None = None,
    ) -> None:
        self._columns = dict(columns)
        self.units: Mapping[str, str] = dict(units or {})
        self.words: Mapping[str, str] = dict(words or {})

    def __getitem__(self, name: str) -> NDArray[Any]:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(unknown_name("column", name, self._columns)) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """The number of rows."""
        return next((len(column) for column in self._columns.values()), 0)

    def __eq__(self, other: object) -> bool:
        """Return whether both have the same columns in the same order, with the same values; nan equals nan."""
        if not isinstance(other, Columns):
            return NotImplemented
        return list(self) == list(other) and all(_same(self[name], other[name]) for name in self)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        shown = ", ".join(list(self)[:6]) + (", ..." if len(self) > 6 else "")
        return f"<Columns: {self.rows} rows of {len(self)}: {shown}>"

    def _repr_html_(self) -> str:
        """Show the first rows in a notebook."""
        rows = zip(*(column[:10].tolist() for column in self._columns.values()), strict=True)
        lines = ["".join(f"<td>{escape('' if value is None else str(value))}</td>" for value in row) for row in rows]
        head = "".join(f"<th>{escape(name)}</th>" for name in self)
        table = "".join(f"<tr>{line}</tr>" for line in [head, *lines])
        return f"<table>{table}</table><p>{self.rows} rows of {len(self)} columns</p>"

    def to_pandas(self) -> pandas.DataFrame:
        """Return a pandas DataFrame. Integers with missing values have the dtype ``Int64``."""
        import pandas as pd

        def series(array: NDArray[Any]) -> Any:
            if not isinstance(array, np.ma.MaskedArray):
                return array
            values = pd.Series(np.asarray(array.data))
            nullable = {"b": "boolean", "i": "Int64", "u": "UInt64"}[array.dtype.kind]
            return values.astype(nullable).mask(np.ma.getmaskarray(array))

        return pd.DataFrame({name: series(array) for name, array in self.items()})

    def to_polars(self) -> polars.DataFrame:
        """Return a polars DataFrame. Missing values are null."""
        import polars as pl

        types = {"b": pl.Boolean, "i": pl.Int64, "u": pl.UInt64, "f": pl.Float64, "O": pl.String}
        series = (pl.Series(name, _values(array), dtype=types[array.dtype.kind]) for name, array in self.items())
        return pl.DataFrame(list(series))

    def to_arrow(self) -> pyarrow.Table:
        """Return a ``pyarrow.Table``. Missing values are null; units and meanings are metadata of its fields."""
        import pyarrow as pa

        types = {"b": pa.bool_(), "i": pa.int64(), "u": pa.uint64(), "f": pa.float64(), "O": pa.string()}
        fields, arrays = [], []
        for name, array in self.items():
            kind = types[array.dtype.kind]
            about = {"unit": self.units.get(name, ""), "description": self.words.get(name, "")}
            fields.append(pa.field(name, kind, metadata=about))
            arrays.append(pa.array(_values(array), type=kind))
        return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def unknown_name(kind: str, name: object, known: Iterable[str]) -> str:
    """Return a message about an unknown name, with the closest known names."""
    near = get_close_matches(str(name), list(known), 3)
    return f"there is no {kind} {name!r}" + (f"; did you mean {' or '.join(map(repr, near))}?" if near else "")


def _values(array: NDArray[Any]) -> list[Any]:
    """Return a column as Python values, with None for missing ones."""
    if array.dtype.kind == "f":
        return [None if value != value else value for value in array.tolist()]
    values: list[Any] = array.tolist()
    return values


def _same(one: NDArray[Any], other: NDArray[Any]) -> bool:
    if one.dtype != other.dtype or one.shape != other.shape:
        return False
    if one.dtype.kind == "f":
        return bool(np.array_equal(one, other, equal_nan=True))
    masks = bool(np.array_equal(np.ma.getmaskarray(one), np.ma.getmaskarray(other)))
    return masks and bool(np.ma.allequal(one, other, fill_value=True))
