#!/usr/bin/env bash
# Slurm on this machine, two nodes: a render in eight parts (deploy/slurm), joined, has the bytes of
# one that is not cut. Then once more, with a node killed in the middle and a task that is asked to
# stop.
#
#     tools/test_slurm.sh PROGRAM [ROUND...]
#
# Rounds: undisturbed, killed; both by default. Needs slurmctld, slurmd and munged, which it installs
# with apt as root. Daemons of its own, with ports and files of their own, end with it.
set -euo pipefail
cd "$(dirname "$0")/.."

program=$(realpath "$1")
shift
rounds=("${@:-}")
[ -n "${rounds[0]}" ] || rounds=(undisturbed killed)
scene=$PWD/scenes/cornell-box/cornell-box.gltf
settings=(--resolution 128x128 --spp 64)
# Seconds for one round.
patience=${PATIENCE:-900}

say() { echo "test-slurm: $*" >&2; }
fail() {
    say "$*"
    tail -n 5 "$work"/*.log "$work"/out/*.txt >&2 || true
    exit 1
}

if [ "$(id -u)" -ne 0 ]; then
    say 'needs root: slurmd starts tasks by the names of their users'
    exit 1
fi
if ! command -v slurmctld slurmd munged sbatch > /dev/null; then
    say 'installing slurm-wlm munge'
    apt-get -q update >&2
    apt-get -q install -y --no-install-recommends slurm-wlm munge >&2
fi

work=$(mktemp -d /tmp/steradian-slurm-XXXXXX)
# By which this script's processes are known.
export STERADIAN_SLURM_TEST=$work

# Processes that this script started and whose environment has all these entries.
ours() {
    local entry files
    files=$(grep -lsaF "STERADIAN_SLURM_TEST=$work" /proc/[0-9]*/environ || true)
    for entry in "$@"; do
        [ -z "$files" ] || files=$(grep -lszxF -e "$entry" $files || true)
    done
    sed -n 's|^/proc/\([0-9]*\)/environ$|\1|p' <<< "$files"
}
cleanup() {
    local status=$? try pid
    trap - EXIT INT TERM
    for try in TERM KILL; do
        for pid in $(STERADIAN_SLURM_TEST='' ours); do
            # Not this script: what is around it has no such entry, what it starts has.
            [ "$pid" = "$$" ] || [ "$pid" = "$BASHPID" ] || kill "-$try" "$pid" 2> /dev/null || true
        done
        sleep 2
    done
    if [ "$status" -eq 0 ]; then rm -rf "$work"; else say "files are in $work"; fi
    exit "$status"
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

host=$(hostname -s)
free_ports() { # how many
    python3 - "$1" << 'P'
import socket, sys
sockets = [socket.socket() for _ in range(int(sys.argv[1]))]
for s in sockets:
    s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))
P
}
read -r port_controller port_1 port_2 <<< "$(free_ports 3)"
mkdir "$work/munge" "$work/out" "$work/state"
chmod 755 "$work" "$work/munge"
dd if=/dev/urandom of="$work/munge/key" bs=128 count=1 status=none
chmod 400 "$work/munge/key"
munged --force --key-file "$work/munge/key" --socket "$work/munge/socket" \
    --pid-file "$work/munge/pid" --log-file "$work/munge.log" --seed-file "$work/munge/seed"

export SLURM_CONF=$work/slurm.conf
cat > "$SLURM_CONF" << C
ClusterName=steradian
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
# The second is also how long a task that is put back waits, 120 s by default.
AuthInfo=socket=$work/munge/socket,cred_expire=20
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SlurmctldPort=$port_controller
SlurmctldPidFile=$work/controller.pid
SlurmctldLogFile=$work/controller.log
SlurmdPidFile=$work/%n.pid
SlurmdLogFile=$work/%n.log
SlurmdSpoolDir=$work/spool-%n
StateSaveLocation=$work/state
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobRequeue=1
RequeueExit=75
SlurmdTimeout=10
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$port_1 CPUs=1 RealMemory=1000
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$port_2 CPUs=1 RealMemory=1000
PartitionName=render Nodes=n1,n2 Default=YES State=UP
C
slurmctld
slurmd -N n1
slurmd -N n2
for _ in {1..60}; do
    [ "$(sinfo -h -t idle -o %D 2> /dev/null)" = 2 ] && break
    sleep 0.5
done
[ "$(sinfo -h -t idle -o %D)" = 2 ] || fail 'the nodes did not come up'
say "$(sinfo -V), nodes n1 and n2 of $host"

say 'the whole'
LP_NUM_THREADS=1 "$program" render "$scene" -q -o "$work/whole.exr" "${settings[@]}"

wait_for() { # what, command...
    local what=$1 begin=$SECONDS
    shift
    until "$@"; do
        [ $((SECONDS - begin)) -lt "$patience" ] || fail "no $what after $patience s"
        sleep 0.2
    done
}
# Process of a task that renders, by node.
render_on() { ours "SLURMD_NODENAME=$1" | while read -r pid; do
    [ "$(readlink "/proc/$pid/exe")" != "$program" ] || echo "$pid"
done; }
renders_on() { [ -n "$(render_on "$1")" ]; }
is_done() { [ -z "$(squeue -h -j "$1" 2> /dev/null)" ]; }
part_of() { tr '\0' '\n' < "/proc/$1/environ" | sed -n 's/^SLURM_ARRAY_TASK_ID=//p'; }

round() { # name
    local name=$1 folder=$work/parts-$1 job merge pid part
    local begin=$SECONDS
    export STERADIAN=$program CHECKPOINT_EVERY=0.1s LP_NUM_THREADS=1
    job=$(sbatch --parsable --array=0-7 --time=30 --output="$work/out/$name-%a.txt" \
        deploy/slurm/render.sbatch "$scene" "$folder" "${settings[@]}")
    merge=$(sbatch --parsable --dependency="afterany:$job" --time=5 \
        --output="$work/out/$name-merge.txt" deploy/slurm/merge.sbatch "$folder" "$work/$name.exr")
    if [ "$name" = killed ]; then
        disturb "$folder"
    fi
    wait_for 'end of the jobs' is_done "$merge"
    [ -e "$work/$name.exr" ] || fail "$name: no picture"
    cmp "$work/whole.exr" "$work/$name.exr" || fail "$name: the pictures differ"
    say "$name: equal bytes, $((SECONDS - begin)) s"
}

# A task with a checkpoint is asked to stop; then all of node n2 is killed while it renders.
disturb() { # folder
    local folder=$1 pid part node daemon
    checkpointed() { # node; sets pid and part
        pid=$(render_on "$1" | head -n 1)
        [ -n "$pid" ] && part=$(part_of "$pid") && [ -n "$part" ] &&
            [ -e "$folder/part-$part.checkpoint" ]
    }
    wait_for 'checkpoint on n1' checkpointed n1
    # The process of the batch script, to which --signal=B:TERM goes.
    kill -TERM "$pid"
    say "part $part on n1: asked to stop"
    stopped=$part
    wait_for "end of part $stopped" is_gone "$pid"
    wait_for 'checkpoint on n2' checkpointed n2
    daemon=$(cat "$work/n2.pid")
    say "part $part on n2: killing it with its daemons, $daemon and others"
    killed=$part
    # The task's processes, their step daemon, and the node's daemon.
    local step
    step=$(ps -o ppid= -p "$pid" | tr -d ' ')
    kill -9 "$daemon" "$step" "$pid"
    wait_for 'loss of n2' node_is_down
    grep -h -o "Requeuing.*\|requeue.*" "$work/controller.log" | tail -n 3 >&2 || true
}
is_gone() { [ ! -e "/proc/$1" ] || [ "$(readlink "/proc/$1/exe")" != "$program" ]; }
node_is_down() { sinfo -h -n n2 -o %t | grep -q down; }

for name in "${rounds[@]}"; do
    round "$name"
    [ "$name" != killed ] && continue
    for part in "$stopped" "$killed"; do
        grep -q 'going on from' "$work/out/killed-$part.txt" ||
            fail "part $part did not go on from its checkpoint"
    done
    say "parts $stopped and $killed went on from their checkpoints"
done
