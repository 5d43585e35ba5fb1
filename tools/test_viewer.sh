#!/usr/bin/env bash
# The real window on a display of its own (Xvfb) and on whatever Vulkan device there is: opens it,
# compares what is on the screen with what `steradian render` writes, moves the camera, changes
# the view, saves, and quits. Installs Xvfb, xdotool and ImageMagick with apt where they are missing.
set -euo pipefail
cd "$(dirname "$0")/.."

packages='xvfb xdotool imagemagick libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0'
if ! command -v Xvfb xdotool import compare convert >/dev/null; then
    echo "test-viewer: installing $packages" >&2
    as_root=$([ "$(id -u)" -eq 0 ] || echo sudo)
    $as_root apt-get -q update >&2
    # shellcheck disable=SC2086
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends $packages >&2
fi

cargo build --quiet --bin steradian
driver=$(command -v xdotool)
program=$(realpath -m "${CARGO_TARGET_DIR:-target}")/debug/steradian
scene=$PWD/scenes/cornell-box/cornell-box.gltf
work=$(mktemp -d)
export XDG_CONFIG_HOME=$work/config
passed=0
viewer=

end() {
    status=$?
    [ -z "$viewer" ] || kill "$viewer" 2>/dev/null || true
    [ -z "${server:-}" ] || kill "$server" 2>/dev/null || true
    if [ "$status" -ne 0 ]; then
        echo "test-viewer: failed; pictures and messages are in $work" >&2
        cat "$work"/*.log >&2 || true
        echo "$passed passed, 1 failed"
    else
        rm -rf "$work"
        echo "$passed passed, 0 failed"
    fi
}
trap end EXIT

# No step of it takes long; without a window it would wait for ever.
xdotool() {
    timeout 60 "$driver" "$@"
}

ok() {
    passed=$((passed + 1))
    echo "ok: $1"
}

fail() {
    echo "test-viewer: $1" >&2
    exit 1
}

# wait_for LOG TEXT N: until LOG has N lines with TEXT.
wait_for() {
    for _ in $(seq 1800); do
        [ "$(grep -c -- "$2" "$1" || true)" -lt "$3" ] || return 0
        kill -0 "$viewer" 2>/dev/null || fail "the window closed before it said '$2'"
        sleep 0.1
    done
    fail "never said '$2' ($3 times)"
}

# open LOG ARGUMENTS...: a window, with the focus.
open() {
    log=$1
    shift
    "$program" view "$@" >"$work/out" 2>"$log" &
    viewer=$!
    wait_for "$log" 'window open' 1
    window=$(xdotool search --sync --pid "$viewer" --name Steradian | head -n 1)
    xdotool windowfocus --sync "$window"
}

# The part of the window that has the picture: the line below it tells times, which differ.
screen() {
    # What was asked for has been drawn; the server has it a frame later.
    sleep 0.5
    import -window "$window" -crop 960x740+0+0 +repage "$work/$1.png"
}

differ() {
    [ "$(compare -metric AE "$work/$1.png" "$work/$2.png" null: 2>&1 || true)" != 0 ]
}

# changes NAME: until the window shows another picture than the first; a kernel may have to be compiled.
changes() {
    for _ in $(seq 100); do
        screen "$1"
        ! differ whole "$1" || return 0
    done
    return 1
}

# comes_back NAME: until it shows the first one again.
comes_back() {
    for _ in $(seq 100); do
        screen "$1"
        differ whole "$1" || return 0
    done
    return 1
}

exec 3>"$work/display"
Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp >"$work/xvfb.log" 2>&1 &
server=$!
for _ in $(seq 100); do
    [ -s "$work/display" ] && break
    sleep 0.1
done
[ -s "$work/display" ] || fail 'Xvfb does not start'
DISPLAY=:$(cat "$work/display")
export DISPLAY
unset WAYLAND_DISPLAY

flags='--resolution 200x150 --spp 8'
# shellcheck disable=SC2086
"$program" render "$scene" -q $flags -o "$work/rendered.png"

# shellcheck disable=SC2086
open "$work/first.log" "$scene" $flags -o "$work/saved.png" --stats "$work/stats.json"
wait_for "$work/first.log" '^done: 8 spp' 1
ok 'opens and comes to its end'
screen whole
xdotool key s
wait_for "$work/first.log" '^saved' 1
cmp "$work/rendered.png" "$work/saved.png" || fail 'the saved picture is not that of render'
ok 'saves the bytes that render writes'

xdotool mousemove --window "$window" 400 400 mousedown 1
for _ in $(seq 8); do
    xdotool mousemove_relative -- 12 3
    sleep 0.05
done
xdotool mouseup 1
wait_for "$work/first.log" '^done: 8 spp' 2
screen orbited
differ whole orbited || fail 'dragging does not move the camera'
ok 'orbits'

xdotool key space
wait_for "$work/first.log" '^done: 8 spp' 3
comes_back back || fail 'the camera of the file does not come back'
ok 'comes back to the same picture'

xdotool key v
changes tree || fail 'the tree is not shown'
xdotool key v
xdotool key t
changes neutral || fail 'the tone curve does not change'
xdotool key t t t
comes_back plain || fail 'the tone curves do not come around'
xdotool key g
changes normals || fail 'the view does not change'
for _ in $(seq 11); do
    xdotool key g
done
comes_back light || fail 'the views do not come around'
ok 'shows the tree, tone curves and views'

xdotool key ctrl+q
status=0
wait "$viewer" || status=$?
viewer=
[ "$status" -eq 0 ] || fail "ended with $status"
ok 'quits with 0'

# The picture on the screen: the part of the window that the statistics name, at its own size.
edges=$(tr -d ' \n' <"$work/stats.json" | sed -n 's/.*"picture_edges":\[\([^]]*\)\].*/\1/p')
IFS=, read -r left top right bottom <<<"$(echo "$edges" | sed 's/\.0//g')"
convert "$work/whole.png" -crop "$((right - left))x$((bottom - top))+$left+$top" +repage \
    -sample 200x150! "$work/shown.png"
! differ shown rendered || fail 'the screen does not show the pixels of render'
ok 'shows the pixels that render writes'
grep -q '"input_to_picture": {' "$work/stats.json" || fail 'the statistics lack the waits'
grep -A 5 '"input_to_picture"' "$work/stats.json" | tr -d '\n'
echo
ok 'measures how long answers take'

# Without a scene, then with one that is not there; a signal ends it.
open "$work/second.log" "$work/missing.glb"
wait_for "$work/second.log" 'missing.glb' 1
kill -TERM "$viewer"
status=0
wait "$viewer" || status=$?
viewer=
[ "$status" -eq 143 ] || fail "ended with $status after SIGTERM"
ok 'stays open without a scene, and ends by a signal'
