#!/bin/sh
# The study of docs/study.md from nothing: its runs, tables and figures.
#
#     benches/study/run.sh PROGRAM FOLDER [PICTURES]
#
# Writes two batches and tables.txt into FOLDER, and the six figures as SVG into PICTURES (FOLDER/figures). Run again, it
# writes the same tables except for CPU times.
set -eu
here=$(dirname "$0")
program=$1
folder=$2
pictures=${3:-$folder/figures}
mkdir -p "$folder" "$pictures"
"$program" batch "$here/plan.toml" --until decided --quiet --out "$folder/planners" > "$folder/planners.txt"
"$program" batch "$here/searches.toml" --quiet --out "$folder/searches" > "$folder/searches.txt"
"$program" report "$folder/planners" --quiet > /dev/null
"$program" report "$folder/searches" --quiet --metric cpu_wumpus_s > /dev/null

compare() {
    printf '\n## %s\n\n' "$1"
    shift
    "$program" compare --quiet "$@"
}
{
    compare 'Planners, planning free' "$folder/planners" --by planner --where unimog.seconds_per_expansion=0 \
        --metric saved,truck_distance_m,cpu_unimog_total_s
    compare 'Planners, planning charged' "$folder/planners" --by planner --where unimog.seconds_per_expansion=0.0005 \
        --metric saved
    compare 'Searches of the Wumpus' "$folder/searches" --by wumpus.planner --metric lit_by_wumpus,cpu_wumpus_s
} > "$folder/tables.txt"
python3 "$here/claims.py" "$folder/planners/runs.csv" "$folder/searches/runs.csv" >> "$folder/tables.txt"

number=1
for chart in planners/charts/sweep-field.coverage-extinguished planners/charts/sweep-field.size_m-extinguished \
    planners/charts/sweep-unimog.seconds_per_expansion-extinguished planners/charts/sweep-field.coverage-cpu_unimog_total_s \
    planners/charts/sweep-field.size_m-cpu_unimog_total_s searches/charts/sweep-field.size_m-cpu_wumpus_s; do
    cp "$folder/$chart.svg" "$pictures/study-$number.svg"
    number=$((number + 1))
done
cat "$folder/tables.txt"
