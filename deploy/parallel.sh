#!/usr/bin/env bash
# A render in parts by GNU parallel, on this machine or by ssh on several that see the same folders:
#
#     deploy/parallel.sh SCENE FOLDER PICTURE PARTS [FLAGS of render...]
#     SERVERS=4/alpha,4/beta deploy/parallel.sh scene.glb parts picture.exr 16 --spp 1024
#
# JOBS: how many at a time (1). What fails is tried three times, and goes on from its checkpoint.
set -eu
if [ $# -lt 4 ]; then
    sed -n '2,7s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
scene=$1 folder=$2 picture=$3 count=$4
shift 4
program=${STERADIAN:-steradian}
mkdir -p "$folder"
where=()
[ -z "${SERVERS:-}" ] || where=(--sshlogin "$SERVERS" --workdir .)
parallel --jobs "${JOBS:-1}" --retries 3 --joblog "$folder/log" --quote "${where[@]}" \
    "$program" render "$scene" -q --shard "{}/$count" -o "$folder/part-{}.film" --skip-existing \
    --checkpoint "$folder/part-{}.checkpoint" --resume "$@" ::: $(seq 0 $((count - 1)))
"$program" merge "$folder"/part-*.film -o "$picture"
