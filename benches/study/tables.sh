#!/bin/sh
# Tables and figures from the batches of run.sh: benches/study/tables.sh PROGRAM FOLDER PICTURES
set -eu
here=$(dirname "$0")
program=$1
folder=$2
pictures=$3
mkdir -p "$pictures"
"$program" report "$folder/planners" --quiet > "$folder/report.txt"
"$program" report "$folder/searches" --quiet --metric cpu_wumpus_s > /dev/null
{
    printf '## Planners, planning free\n\n'
    "$program" compare --quiet "$folder/planners" --by planner --where unimog.seconds_per_expansion=0 --metric saved
    printf '\n## Planners, planning charged\n\n'
    "$program" compare --quiet "$folder/planners" --by planner --where unimog.seconds_per_expansion=0.0005 --metric saved
    printf '\n## prm-rs and hybrid-astar\n\n'
    for charge in 0 0.0005; do
        "$program" compare --quiet "$folder/planners" --by planner=prm-rs,hybrid-astar \
            --where unimog.seconds_per_expansion=$charge --metric saved
    done
    printf '\n## Searches of the Wumpus\n\n'
    "$program" compare --quiet "$folder/searches" --by wumpus.planner --metric lit_by_wumpus
    python3 "$here/claims.py" "$folder/planners/runs.csv" "$folder/searches/runs.csv"
} > "$folder/tables.txt"
number=1
for chart in planners/charts/sweep-field.coverage-extinguished planners/charts/sweep-field.size_m-extinguished \
    planners/charts/sweep-unimog.seconds_per_expansion-extinguished planners/charts/sweep-field.coverage-cpu_unimog_total_s \
    planners/charts/sweep-field.size_m-cpu_unimog_total_s searches/charts/sweep-field.size_m-cpu_wumpus_s; do
    cp "$folder/$chart.svg" "$pictures/study-$number.svg"
    number=$((number + 1))
done
