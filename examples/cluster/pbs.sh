# PBS Professional, OpenPBS: `id=$(qsub pbs.sh)`, then the merge with `qsub -W depend=afterany:$id merge.sh`.
#PBS -N big -J 1-40 -r y
cd "$PBS_O_WORKDIR"
wildfire batch plan.toml --out runs/big --array-env PBS_ARRAY_INDEX --slices 40 --jobs 1
