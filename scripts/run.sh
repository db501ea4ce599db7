#!/usr/bin/env bash
# Builds the program and runs it once, to write tables, a sound and pictures.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/run.sh [FOLDER]

Installs missing Debian packages, builds echomarch, and writes into FOLDER
(default out):
  figures.csv, .json, .svg   the thesis' four tables, with the results of this machine beside them
  open-field.wav             a source that passes from left to right
  corner.png, obstacles.png, open-pillars.png
                             three scenes, each from its listener's view
  corner-paths.png, obstacles-paths.png
                             the scenes from above, with the paths of some waves
TEXT
}

case "${1:-}" in
-h | --help)
    usage
    exit 0
    ;;
-*)
    usage >&2
    exit 2
    ;;
esac
if (($# > 1)); then
    usage >&2
    exit 2
fi

# FOLDER is relative to the caller's folder.
mkdir -p "${1:-out}"
out="$(cd "${1:-out}" && pwd)"
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

# shellcheck disable=SC2119 # Only the packages that are always needed.
provide_packages
need_cargo build
run cargo build --release --locked
program="${CARGO_TARGET_DIR:-target}/release/echomarch"

run "$program" info
run "$program" figures --runs 3 -o "$out"
run "$program" render open-field -o "$out/open-field.wav"
for scene in corner obstacles open-pillars; do
    run "$program" view "$scene" -o "$out/$scene.png"
done
run "$program" slice corner -o "$out/corner-paths.png" --paths 150 --iterations 5
# Few waves reach the listener in obstacles, so this picture needs more paths and iterations.
run "$program" slice obstacles -o "$out/obstacles-paths.png" --paths 600 --iterations 16

say
say "written to $out:"
for file in "$out"/*.{csv,json,svg,wav,png}; do
    say "  $file"
done
