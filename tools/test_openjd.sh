#!/usr/bin/env bash
# The Open Job Description templates (deploy/openjd) by openjd-cli: they pass its check; a render in
# eight parts, joined, has the bytes of one that is not cut, and frames have those of one call.
#
#     tools/test_openjd.sh PROGRAM
#
# Needs `openjd` (pip install openjd-cli); OPENJD=PATH if it is not on the path.
set -euo pipefail
cd "$(dirname "$0")/.."

program=$(realpath "$1")
openjd=${OPENJD:-openjd}
template=deploy/openjd/steradian.yaml
scene=$PWD/scenes/cornell-box/cornell-box.gltf
if ! command -v "$openjd" > /dev/null; then
    echo 'test-openjd: openjd is missing: python3 -m pip install openjd-cli' >&2
    exit 1
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$openjd" --version >&2
"$openjd" check "$template"
"$openjd" check deploy/openjd/frames.yaml
"$program" render "$scene" -q --resolution 96x96 --spp 32 -o "$work/whole.exr"
parameters=(-p Program="$program" -p Scene="$scene" -p Output="$work/joined.exr"
    -p Parts="$work/parts" -p Samples=32 -p Resolution=96x96)
run() { # flags; the log is shown if it fails
    "$openjd" run "$template" "${parameters[@]}" "$@" > "$work/log" 2>&1 || {
        cat "$work/log" >&2
        return 1
    }
}
run --step Merge --run-dependencies
cmp "$work/whole.exr" "$work/joined.exr"
echo "test-openjd: equal bytes of $(ls "$work/parts" | wc -l) parts" >&2

# A part that is missing is refused.
rm "$work/joined.exr" "$work/parts/part-3.film"
if run --step Merge 2> "$work/refused"; then
    echo 'test-openjd: a picture without one of its parts' >&2
    exit 1
fi
grep -q 'these are missing: 3' "$work/refused"
# It alone is made again.
run --step Merge --run-dependencies
cmp "$work/whole.exr" "$work/joined.exr"
[ "$(grep -c 'there already' "$work/log")" -eq 7 ]
echo 'test-openjd: a missing part is refused, and made again alone' >&2

# Frames, a task each.
"$program" render "$scene" -q --frames 3,5 --resolution 64x64 --spp 4 -o "$work/####.exr"
"$openjd" run deploy/openjd/frames.yaml --step Render -p Program="$program" -p Scene="$scene" \
    -p Output="$work/frames/####.exr" -p Frames=3,5 -p Samples=4 -p Resolution=64x64 > "$work/log" 2>&1
grep -q 'openjd_progress: 100' "$work/log"
for frame in 0003 0005; do
    cmp "$work/$frame.exr" "$work/frames/$frame.exr"
done
[ "$(ls "$work/frames" | wc -l)" -eq 2 ]
echo 'test-openjd: equal bytes of two frames' >&2
