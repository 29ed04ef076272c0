# Grid Engine: `qsub grid_engine.sh`, then `qsub -hold_jid big -cwd -b y wildfire merge runs/big`. It queues a task again that ends with 99.
#$ -N big -t 1-40 -cwd -notify
wildfire batch plan.toml --out runs/big --array-env SGE_TASK_ID --slices 40 --jobs 1
code=$?
[ $code -eq 75 ] && exit 99
exit $code
