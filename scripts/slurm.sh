#!/usr/bin/env bash
# Runs a small campaign through a Slurm of one node, this machine, and through none: the two tables are
# one. Needs root; skipped where Debian's packages of Slurm cannot be installed.
#   scripts/slurm.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "$0")/.."

program=$(realpath "${1:-build/ci/src/mindahl}")
if [ "$(id -u)" -ne 0 ] || ! ./scripts/install-dependencies.sh --workflow >/dev/null 2>&1; then
  echo "slurm: skipped: Slurm is not installed and cannot be, or the user is not root"
  exit
fi

scratch=$(mktemp -d)
chmod 755 "$scratch" # munge's clients, whoever they are, look for its socket there
daemons=()
stop() {
  if ((${#daemons[@]})); then
    kill "${daemons[@]}" 2>/dev/null || true
    wait || true
  fi
  rm -rf "$scratch"
}
trap stop EXIT

export SLURM_CONF=$scratch/slurm.conf
cat >"$SLURM_CONF" <<END
ClusterName=mindahl
SlurmctldHost=$(hostname -s)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthInfo=socket=$scratch/munge.socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
StateSaveLocation=$scratch/state
SlurmdSpoolDir=$scratch/spool
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/slurmd.pid
NodeName=$(hostname -s) CPUs=$(nproc) RealMemory=1000
PartitionName=all Nodes=ALL Default=YES
END
mkdir "$scratch/state" "$scratch/spool"
head -c 1024 /dev/urandom >"$scratch/munge.key"
chmod 400 "$scratch/munge.key"
munged --foreground --force --key-file="$scratch/munge.key" --socket="$scratch/munge.socket" \
  --pid-file="$scratch/munge.pid" --seed-file="$scratch/munge.seed" &>"$scratch/munged.log" &
daemons+=($!)
slurmctld -D &>"$scratch/slurmctld.log" &
daemons+=($!)
slurmd -D &>"$scratch/slurmd.log" &
daemons+=($!)
for _ in {1..60}; do
  [[ $(sinfo --noheader --format=%t 2>/dev/null) == idle ]] && break
  sleep 1
done
if ! srun true; then
  tail -n 20 "$scratch"/*.log >&2
  exit 1
fi

workflow=$PWD/workflow
mkdir "$scratch/records"
for seed in 1 2 3; do
  "$program" simulate --sigma 5e7 --slip-force "$((60 - 3 * seed))" --amplitude 2.5e-6 --cycles 12 \
    --noise-force 0.5 --seed "$seed" -o "$scratch/records/test $seed.csv"
done
cd "$scratch"
campaign() {
  snakemake --snakefile "$workflow/Snakefile" --quiet --config records=records "program=$program" "results=$@"
}
campaign alone --cores 2
campaign cluster --profile "$workflow/profiles/slurm"
cmp alone/campaign.csv cluster/campaign.csv
ls slurm-*.txt >/dev/null # each job's own output
echo "slurm: the table of $(ls cluster/tests/*.csv | wc -l) tests is that of a run without it"
