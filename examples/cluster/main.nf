// Nextflow: each task has a folder of its own, and the last one collects all slices.
process slice {
    errorStrategy { task.exitStatus == 75 ? 'retry' : 'terminate' }
    input: path plan; val k
    output: path "slice/*"
    script: "wildfire batch $plan --out slice --shard $k/40 --jobs 1"
}
process merge {
    publishDir 'runs'
    input: path 'big/*'
    output: path 'big'
    script: "wildfire merge big"
}
workflow { merge(slice(file('plan.toml'), Channel.of(1..40)).flatten().unique { it.name }.collect()) }
