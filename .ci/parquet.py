"""Holds the Parquet files of a batch against its CSV file, with DuckDB. Usage: parquet.py FOLDER"""

import sys

import duckdb

folder = sys.argv[1]
runs, calls, states, csv = (
    f"'{folder}/{name}'" for name in ("runs.parquet", "planner_calls.parquet", "states.parquet", "runs.csv")
)


def one(query):
    return duckdb.sql(query).fetchall()[0]


def same(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: {found}, expected {expected}")
    print(f"{what}: {found}")


def columns_of(table):
    return [row[0] for row in duckdb.sql(f"DESCRIBE SELECT * FROM {table}").fetchall()]


columns = columns_of(runs)
if columns != columns_of(csv):
    sys.exit(f"columns: {columns}, expected {columns_of(csv)}")
same("rows", one(f"SELECT count(*) FROM {runs}"), one(f"SELECT count(*) FROM {csv}"))
for name in columns:
    differing = one(
        f"""SELECT count(*) FROM {runs} p JOIN {csv} c USING (run)
        WHERE coalesce(p."{name}"::VARCHAR, '') != coalesce(c."{name}"::VARCHAR, '')
        AND try_cast(p."{name}" AS DOUBLE) IS DISTINCT FROM try_cast(c."{name}" AS DOUBLE)"""
    )
    same(f"rows that differ in {name}", differing, (0,))
same("calls", one(f"SELECT count(*) FROM {calls}"), one(f"SELECT sum(truck_plans + wumpus_plans) FROM {csv}"))
same("states", one(f"SELECT count(*) FROM {states}"), one(f"SELECT 61 * count(*) FROM {csv} WHERE status = 'done'"))
last = f"SELECT run, extinguished FROM {states} QUALIFY row_number() OVER (PARTITION BY run ORDER BY t_s DESC) = 1"
same("last states", one(f"SELECT sum(extinguished) FROM ({last})"), one(f"SELECT sum(extinguished) FROM {csv}"))
