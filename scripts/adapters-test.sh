#!/usr/bin/env bash
# Checks and tests the adapters for kira, rodio, Bevy, Godot and fidget, without a sound card, a window or an engine.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

take_no_options "usage: scripts/adapters-test.sh

Checks and tests the packages in adapters/, which have a lock file of their own. Compiled dependencies are kept in the
target folder of the other packages." "$@"

readonly -a WHERE=(--manifest-path adapters/Cargo.toml)
readonly -a HOW=(--locked --workspace --target-dir "${CARGO_TARGET_DIR:-target}")

run cargo fmt --all --check "${WHERE[@]}"
run cargo clippy "${WHERE[@]}" "${HOW[@]}" --all-targets -- -D warnings
run cargo test "${WHERE[@]}" "${HOW[@]}"
