#!/usr/bin/env bash
# Measures one graphics card, or a software renderer, and writes it all into one Markdown file.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/gpu-report.sh [--bandwidth GB/S] [--arithmetic GOPS] [-o FILE] [OPTION ...]

Runs on the first renderer that echomarch finds and writes a report to add under docs/benchmarks/:
what it is (info), the hard cases (verify), the thesis' tables (figures), the share of memory
bandwidth and of arithmetic that each part of a frame has, and time and memory against waves,
iterations and surfaces, with a picture beside it (.svg). A graphics card takes minutes, a software
renderer half an hour.

  --bandwidth GB/S   of the card's memory, by its data sheet
  --arithmetic GOPS  its additions and multiplications of 32 bits, by its data sheet, in billions a
                     second; a fused multiply-add is two
  --growth           time and memory against waves, iterations and surfaces alone
  --sweeps NAMES     of those three these alone, separated by commas
  --profiles NAMES   these alone (default hybrid,march,thesis)
  --one-core         on one core: for software renderers
  --quick            few waves and surfaces, to try it: its figures mean little
  -o FILE            where to write (default docs/benchmarks/report-RENDERER.md)

  ECHOMARCH=PATH     this program, and nothing is installed or built
TEXT
}

options=()
while (($#)); do
    case "$1" in
    -h | --help)
        usage
        exit 0
        ;;
    --quick | --growth | --one-core) options+=("$1") ;;
    --bandwidth | --arithmetic | --sweeps | --profiles)
        options+=("$1" "${2:?"$1 needs a value"}")
        shift
        ;;
    -o)
        # The file is meant from where the script is called.
        options+=(-o "$(realpath -m "${2:?"-o needs a value"}")")
        shift
        ;;
    *)
        usage >&2
        exit 2
        ;;
    esac
    shift
done
program="${ECHOMARCH:+$(realpath "$ECHOMARCH")}"

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

if [[ -z "$program" ]]; then
    provide_packages \
        "command:python3 python3 writes the report" \
        "command:time time measures memory" \
        "command:glslangValidator glslang-tools counts the operations of shaders" \
        "command:spirv-opt spirv-tools counts the operations of shaders"
    need_cargo build
    # Neither sound nor window is measured.
    run cargo build --release --locked --no-default-features --features cli
    program="$(realpath "${CARGO_TARGET_DIR:-target}")/release/echomarch"
fi
export PYTHONPATH=scripts PYTHONDONTWRITEBYTECODE=1
run python3 -m report.gpu --echomarch "$program" "${options[@]}"
