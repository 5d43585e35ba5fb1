#!/bin/sh
# Makes a report of 20 pictures, and clicks through it in headless Chromium.
# Needs Node.js and Chromium (Debian: apt-get install chromium nodejs npm); installs playwright-core
# from npm below out/.
#
#     tools/test_report.sh PROGRAM
set -eu

program=$1
work=out/report-test
for tool in node npm "${CHROMIUM:-chromium}"; do
    if ! command -v "$tool" > /dev/null; then
        echo "test_report: $tool is missing: apt-get install chromium nodejs npm" >&2
        exit 1
    fi
done
rm -rf "$work"
mkdir -p "$work/actual" "$work/expected" "$work/screenshots"

# Same and other seeds, other settings, layers, what is missing, what cannot be compared.
render() { # file, scene, flags
    file=$1
    scene=$2
    shift 2
    "$program" render -q "scenes/$scene.gltf" -o "$work/$file" "$@"
}
for name in cornell-box cornell-spheres cornell-spheres-diffuse veach-mis environment statue; do
    render "expected/$name.exr" "$name/$name" --resolution 96x96 --spp 32 --seed 1
    render "actual/$name.exr" "$name/$name" --resolution 96x96 --spp 8 --seed 2
    render "expected/$name-dim.exr" "$name/$name" --resolution 96x96 --spp 8 --seed 1
    render "actual/$name-dim.exr" "$name/$name" --resolution 96x96 --spp 8 --seed 2 --max-bounces 1
    render "expected/$name.png" "$name/$name" --resolution 96x96 --spp 8
    render "actual/$name.png" "$name/$name" --resolution 96x96 --spp 8 --seed 1
done
cp "$work/expected/statue.png" "$work/actual/statue.png"
cp "$work/actual/statue.png" "$work/actual/new.png"
render "expected/size.exr" cornell-box/cornell-box --resolution 32x32 --spp 4
render "actual/size.exr" cornell-box/cornell-box --resolution 40x32 --spp 4

status=0
"$program" compare "$work/actual" "$work/expected" --report "$work" --json "$work/report.json" -q || status=$?
if [ "$status" -ne 2 ]; then
    echo "test_report: compare ended with $status, where sizes differ it must be 2" >&2
    exit 1
fi
[ -d out/node/node_modules/playwright-core ] || npm install --silent --prefix out/node playwright-core
cp tools/test_report.mjs out/node/test_report.mjs
node out/node/test_report.mjs "$work/report.html" "$work/screenshots"
