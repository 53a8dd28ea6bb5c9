#!/bin/sh
# A campaign as an array of Slurm, without Snakemake: job K of N takes the K-th of N shards of the
# tests that a list names, one a line, and goes on where it was ended.
#   sbatch --array=1-20 workflow/slurm_array.sh tests.txt results --normal-load 50
# Then one table: workflow/merge_tables.py campaign.csv campaign.json results/shard-*.csv
# (the shards in the order of their numbers: their names have leading zeros).
#SBATCH --job-name=mindahl
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
#SBATCH --mem=500M
#SBATCH --requeue
set -eu
tests=$1
results=$2
shift 2
mkdir -p "$results"
shard=$(printf '%s/shard-%06d' "$results" "$SLURM_ARRAY_TASK_ID")
status=0
mindahl track --separate --files-from "$tests" \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --output "$shard.csv" \
    --json "$shard.json" --threads "${SLURM_CPUS_PER_TASK:-1}" --resume "$@" || status=$?
# 3: a test failed, as its row says; the others are done.
[ "$status" -eq 0 ] || [ "$status" -eq 3 ]
