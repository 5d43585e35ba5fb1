#!/usr/bin/env bash
# Makes target/debian/steradian_*.deb; needs cargo-deb (cargo install cargo-deb).
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release --locked
pages=target/packaging
rm -rf "$pages" && mkdir -p "$pages/man" "$pages/completions"
target/release/steradian man "$pages/man"
target/release/steradian completions bash >"$pages/completions/steradian"
target/release/steradian completions zsh >"$pages/completions/_steradian"
target/release/steradian completions fish >"$pages/completions/steradian.fish"
cargo deb --no-build
dpkg-deb --contents target/debian/steradian_*.deb
