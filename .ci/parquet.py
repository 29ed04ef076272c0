"""Holds the Parquet files of a batch against its CSV file, with DuckDB. Usage: parquet.py FOLDER"""

import json
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

# What other programs compute with: counts can be subtracted, what does not exist is null, and files name their plan.
plan = json.load(open(f"{folder}/plan.json"))
for name, file in (("runs", runs), ("planner_calls", calls), ("states", states)):
    schema = duckdb.sql(f"SELECT name, type, repetition_type, logical_type FROM parquet_schema({file}) OFFSET 1").fetchall()
    unsigned = [column for column, _, _, logical in schema if logical and "isSigned=0" in logical]
    same(f"unsigned columns of {name}", unsigned, [])
    types = {row[0]: row[1] for row in duckdb.sql(f"DESCRIBE SELECT * FROM {file}").fetchall()}
    same(f"types of {name}", {*types.values()} - {"BIGINT", "DOUBLE", "VARCHAR", "BOOLEAN"}, set())
    required = {column for column, _, repetition, _ in schema if repetition == "REQUIRED"}
    same(f"columns of {name} that say which run it is and may be null", {"scenario", "seed", "run"} - required, set())
    for column in (column for column, kind in types.items() if kind == "VARCHAR"):
        same(f"empty texts of {name} in {column}", one(f"SELECT count(*) FROM {file} WHERE \"{column}\" = ''"), (0,))
    metadata = dict(duckdb.sql(f"SELECT decode(key), decode(value) FROM parquet_kv_metadata({file})").fetchall())
    for key in ("content_sha256", "program_version"):
        same(f"{key} of {name}", metadata.get(key), plan[key])
same("messages of runs that are done", one(f"SELECT count(message) FROM {runs} WHERE status = 'done'"), (0,))
difference = "min(intact - extinguished), max(intact - extinguished)"
same("differences of counts", one(f"SELECT {difference} FROM {runs}"), one(f"SELECT {difference} FROM {csv}"))
if one(f"SELECT min(intact - extinguished) FROM {runs}")[0] >= 0:
    sys.exit("no run has fewer bushes intact than extinguished: the differences say nothing")
