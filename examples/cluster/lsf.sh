# LSF: `bsub < lsf.sh`, then `bsub -w 'ended(big)' wildfire merge runs/big`. It queues a task again that ends with 75.
#BSUB -J "big[1-40]"
#BSUB -Q 75
wildfire batch plan.toml --out runs/big --array-env LSB_JOBINDEX --slices 40 --jobs 1
