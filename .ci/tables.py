"""Holds the tables of a batch against each other, as pandas and polars read them. Usage: tables.py FOLDER"""

import sys

import pandas
import polars

folder = sys.argv[1]


def same(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: {found}, expected {expected}")
    print(f"{what}: {str(found)[:80]}")


csv, parquet = pandas.read_csv(f"{folder}/runs.csv"), pandas.read_parquet(f"{folder}/runs.parquet")
lazy = polars.scan_parquet(f"{folder}/runs.parquet").collect()
same("columns, by pandas", list(parquet.columns), list(csv.columns))
same("columns, by polars", lazy.columns, list(csv.columns))
same("columns of CSV, by polars", polars.read_csv(f"{folder}/runs.csv", infer_schema_length=None).columns, lazy.columns)
same("rows", (len(parquet), lazy.height), (len(csv), len(csv)))
numbers = csv.select_dtypes("number").columns
for name in numbers:
    pandas.testing.assert_series_equal(
        csv[name].astype(float), parquet[name].astype(float), rtol=1e-11, obj=name
    )
same("numbers", len(numbers) > 40, True)
means = csv.groupby("planner")["extinguished"].mean().to_dict()
grouped = lazy.group_by("planner").agg(polars.col("extinguished").mean())
same("means by planner", {name: round(mean, 9) for name, mean in grouped.rows()}, {name: round(mean, 9) for name, mean in means.items()})
