#!/bin/bash
# Runs each fuzz target: tools/fuzz.sh [SECONDS] [TARGET...]. Needs a C++ compiler.
#
# The flags are those of `cargo fuzz -s none`, so that the stable compiler will do: the code is
# safe Rust, and panics, hangs and memory are what can go wrong. New inputs are kept in
# fuzz/target/corpus; what fails is written to fuzz/artifacts. With MERGE=1 nothing is searched:
# the committed corpus becomes the smallest one with the coverage of both.
set -euo pipefail
cd "$(dirname "$0")/../fuzz"

seconds=${1:-60}
shift || true
targets=("${@:-}")
[ -n "${targets[0]}" ] || targets=(gltf accessors images environments)

# The explicit target keeps build scripts and macros out of the instrumentation.
host=$(rustc -vV | sed -n 's/^host: //p')
export RUSTFLAGS="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing -Ccodegen-units=1"
cargo build --release --target "$host"

mkdir -p artifacts
for target in "${targets[@]}"; do
    program=target/$host/release/$target
    found=target/corpus/$target
    mkdir -p "$found" "corpus/$target"
    if [ "${MERGE:-0}" = 1 ]; then
        smaller=$(mktemp -d)
        "$program" -merge=1 -max_len=4096 -artifact_prefix="artifacts/$target-" \
            "$smaller" "corpus/$target" "$found"
        rm -f "corpus/$target"/*
        cp "$smaller"/* "corpus/$target"
        rm -r "$smaller"
        continue
    fi
    echo "$target: $seconds s"
    "$program" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024 -max_len=8192 \
        -print_final_stats=1 -artifact_prefix="artifacts/$target-" "$found" "corpus/$target" \
        2> "artifacts/$target.log" || { tail -50 "artifacts/$target.log"; exit 1; }
    grep -E 'number_of_executed|peak_rss' "artifacts/$target.log"
done
