#!/bin/sh
# The study of docs/paper/study.md from nothing: its runs, tables and figures.
#
#     SEEDS=1..40 benches/study/run.sh PROGRAM FOLDER [PICTURES]
#
# Writes batches and tables.txt into FOLDER, and six figures as SVG into PICTURES (FOLDER/figures). Run again, it writes the
# same tables except for CPU times.
set -eu
here=$(dirname "$0")
program=$1
folder=$2
pictures=${3:-$folder/figures}
seeds=${SEEDS:-1..40}
mkdir -p "$folder" "$pictures"
"$program" batch "$here/plan.toml" --seeds "$seeds" --until decided --quiet --out "$folder/planners" > "$folder/planners.txt"
"$program" batch "$here/searches.toml" --quiet --out "$folder/searches" > "$folder/searches.txt"
"$here/tables.sh" "$program" "$folder" "$pictures"
