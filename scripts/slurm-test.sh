#!/usr/bin/env bash
# Runs a study on a real single-node Slurm in a temporary folder, as an array of 16 shards of 2,000 points. Two of
# the tasks are killed midway and requeued. The joined tables must be byte-identical to those of a single process.
set -euo pipefail

# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

take_no_options "usage: scripts/slurm-test.sh     (ECHOMARCH=PATH: use this program instead of building one)" "$@"
program="${ECHOMARCH:+$(realpath "$ECHOMARCH")}"
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# Daemons are in /usr/sbin, which is not in every user's PATH.
export PATH="$PATH:/usr/sbin:/sbin"
provide_packages \
    "command:slurmctld    slurmctld         Slurm: assigns tasks to nodes" \
    "command:slurmd       slurmd            Slurm: a node" \
    "command:sbatch       slurm-client      Slurm: its commands" \
    "command:munged       munge             authenticates Slurm's parts"
if [[ -z "$program" ]]; then
    run cargo build --release --locked -p echomarch-cli --no-default-features --features parquet
    program="$(realpath "${CARGO_TARGET_DIR:-target}")/release/echomarch"
fi
sbatch_file="$(realpath examples/cluster/study.sbatch)"

readonly SHARDS=16
# Points of the study: 10 × 10 positions times 20 seeds.
readonly POINTS=2000

folder="$(mktemp -d)"
daemons=()
clean_up() {
    ((${#daemons[@]} == 0)) || kill "${daemons[@]}" 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$folder"
}
trap clean_up EXIT
cd "$folder"

# Waits up to ten minutes for a command to succeed. Slurm itself holds a requeued task for two minutes.
wait_for() {
    local what="$1" turn
    shift
    for ((turn = 0; turn < 6000; turn++)); do
        "$@" >/dev/null 2>&1 && return 0
        sleep 0.1
    done
    complain "timed out waiting for $what"
    tail -n 5 ./*.log >&2 || true
    return 1
}

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'
}

start_slurm() {
    local host user cores memory
    host="$(hostname -s)"
    user="$(id -un)"
    cores="$(nproc)"
    memory="$(awk '/MemTotal/ {print int($2 / 1024)}' /proc/meminfo)"
    mkdir state spool
    (umask 077 && head -c 1024 /dev/urandom >munge.key)
    munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
        --pid-file="$folder/munged.pid" --log-file="$folder/munged.log" \
        --seed-file="$folder/munge.seed" 2>munged-start.log &
    daemons+=($!)
    wait_for munged test -S munge.socket
    cat >slurm.conf <<CONF
ClusterName=test
SlurmctldHost=$host(localhost)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=2
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
# cgroups are not used, because a container may lack them.
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
KillWait=2
NodeName=$host NodeAddr=localhost CPUs=$cores RealMemory=$memory
PartitionName=test Nodes=$host Default=YES State=UP
CONF
    export SLURM_CONF="$folder/slurm.conf"
    slurmctld -D -f slurm.conf >slurmctld.log 2>&1 &
    daemons+=($!)
    slurmd -D -f slurm.conf >slurmd.log 2>&1 &
    daemons+=($!)
    wait_for "an idle node" node_is_idle
}

node_is_idle() {
    sinfo -h -o %t | grep -q '^idle$'
}

# The working file of shard $1, and its number of lines.
work_of() {
    printf 'array/shards/%05d-of-%05d.work' "$1" "$SHARDS"
}

rows_of() {
    wc -l 2>/dev/null <"$(work_of "$1")" || echo 0
}

is_in_the_middle() {
    (($(rows_of "$1") > 10))
}

has_ended() {
    ! squeue -h -j "$1" -t pending,configuring,running,completing,requeued -o %i | grep -q .
}

has_failed() {
    scontrol show job "$1" | grep -q 'JobState=FAILED'
}

# Kills the program of a task, as a node does that runs out of memory.
kill_program() {
    local id pid
    id="$(squeue -h -j "$1" -o %A)"
    for pid in $(scontrol listpids "$id" | awk 'NR > 1 {print $1}'); do
        if [[ "$(readlink "/proc/$pid/exe")" == "$program" ]]; then
            kill -KILL "$pid"
            return 0
        fi
    done
    complain "task $1 does not run the program"
    return 1
}

cat >study.ron <<RON
Study(
    scenes: [Scene(of: "corner")],
    listeners: Grid(from: (-12, 0, 1), to: (12, 0, 12), counts: (10, 1, 10)),
    settings: All(waves: [32768], iterations: [4]),
    seeds: Range(from: 1, count: 20),
)
RON

start_slurm
sinfo --version
# The study requires this machine's renderer.
renderer="$("$program" study study.ron --count --json --quiet |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["renderer"])')"
export ECHOMARCH="$program" ECHOMARCH_RENDERER="$renderer"

began=$SECONDS
job="$(sbatch --parsable --array=1-$SHARDS "$sbatch_file" study.ron array $SHARDS)"
say "job $job: an array of $SHARDS shards of $POINTS points"

# One task is requeued while it runs: Slurm kills the task and starts it again.
wait_for "task 2" is_in_the_middle 2
run scontrol requeue "${job}_2"
# The program of another task is killed. The task is requeued after Slurm has noticed the end of the program.
wait_for "task 7" is_in_the_middle 7
run kill_program "${job}_7"
wait_for "the end of task 7" has_failed "${job}_7"
say "shard 7 has $(($(rows_of 7) - 1)) points"
run scontrol requeue "${job}_7"

wait_for "the array" has_ended "$job"
say "the array took $((SECONDS - began)) s"
grep -hE 'echomarch:|error' ./*-"$job"-*.log || true

"$program" study study.ron -o array --join --quiet
"$program" study study.ron -o whole --quiet
for table in study.csv study.parquet study.json; do
    cmp "array/$table" "whole/$table"
done
rows="$(($(wc -l <array/study.csv) - 1))"
if ((rows != POINTS)); then
    complain "$rows rows, not $POINTS"
    exit 1
fi
restarts="$(for task in 2 7; do scontrol show job "${job}_$task" | grep -o 'Restarts=[0-9]*'; done)"
say "$restarts" | tr '\n' ' '
say
say "the tables of the array are byte-identical to those of one process: $(sha256sum array/study.csv)"
