#!/usr/bin/env bash
# Measures one graphics card, or a software renderer, and writes all results into one Markdown file.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/gpu-report.sh [--bandwidth GB/S] [--arithmetic GOPS] [-o FILE] [OPTION ...]

Measures the first renderer that echomarch finds, and writes a report for docs/benchmarks/:
the renderer (info), the hard cases (verify), the thesis' tables (figures), the share of memory
bandwidth and of arithmetic that each part of a frame uses, and time and memory against waves,
iterations and surfaces, also as a picture (.svg). The report takes minutes on a graphics card, and
half an hour on a software renderer.

  --bandwidth GB/S   the card's memory bandwidth, from its data sheet
  --arithmetic GOPS  the card's 32-bit additions and multiplications, from its data sheet, in billions
                     per second; a fused multiply-add counts as two
  --growth           only time and memory against waves, iterations and surfaces
  --sweeps NAMES     only these sweeps: waves, iterations, surfaces, separated by commas
  --profiles NAMES   only these profiles (default hybrid,march,thesis)
  --one-core         run on one core: for software renderers
  --quick            few waves and surfaces, for a trial; the figures are not reliable
  -o FILE            the output file (default docs/benchmarks/report-RENDERER.md)

  ECHOMARCH=PATH     the program to measure; the script then installs and builds nothing
TEXT
}

# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

take_measuring_options "--quick --growth --one-core" "--bandwidth --arithmetic --sweeps --profiles" "$@"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ -z "$program" ]]; then
    provide_packages \
        "command:python3 python3 writes the report" \
        "command:time time measures memory" \
        "command:glslangValidator glslang-tools counts the operations of shaders" \
        "command:spirv-opt spirv-tools counts the operations of shaders"
    build_program
fi
export PYTHONPATH=scripts PYTHONDONTWRITEBYTECODE=1
run python3 -m report.gpu --echomarch "$program" "${options[@]}"
