#!/usr/bin/env bash
# Measures Echomarch and other programs on the same waves in the same scenes, on one core.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/peers.sh [--rounds N] [--scenes "A B …"] [--quick] [--add] [-o FILE]

Builds these programs, and runs them in each round one after the other on the same core:
  closed form in C++, sphere tracing in C++ (AVX2, eight waves at a time; scripts/peers/)
  Embree 3 (Debian's libembree-dev), by packets of 16
  pyroomacoustics 0.10.1 (PyPI)
  echomarch, profiles hybrid and march, whole frames
The scenes are A (an empty room), B (two more walls and three pillars), B16, B64, B256 and B1024 (16
to 1024 thin pillars). Results are written as Markdown. Programs that cannot be installed are left out.

  --rounds N       number of rounds; results are medians over them (default 5)
  --scenes NAMES   only these scenes
  --quick          few waves and two rounds, for a trial; the figures are not reliable
  --add            keep the rounds measured before, and add new rounds
  -o FILE          where to write (default docs/benchmarks/peers-RENDERER.md)

  ECHOMARCH=PATH   the program to measure, instead of building it
  CXX=PATH         the compiler (default g++)

The built programs and the results of each round (rounds.jsonl) are in target/peers.
TEXT
}

# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

take_measuring_options "--quick --add" "--rounds --scenes" "$@"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly WORK="$PWD/target/peers"
readonly COMPILER="${CXX:-g++}"
readonly PYROOM=pyroomacoustics==0.10.1

# Installs the missing packages that the peers need.
provide_peers() {
    provide_packages \
        "command:g++ g++ compiles the peers" \
        "command:time time measures memory" \
        "command:python3 python3 runs the rounds" \
        "file:/usr/include/embree3/rtcore.h libembree-dev Embree, a peer"
}

# Builds a peer in C++: $1 is its name, then follow its libraries. A failure does not stop the other peers.
build_peer() {
    local name="$1" flags=(-std=c++17 -O3 -mavx2 -mfma)
    shift
    rm -f "$WORK/$name"
    run "$COMPILER" "${flags[@]}" -o "$WORK/$name" "scripts/peers/$name.cpp" "$@" ||
        complain "$name cannot be built; continuing without it"
}

# pyroomacoustics, in its own Python environment.
provide_pyroomacoustics() {
    local environment="$WORK/python"
    [[ -e "$environment/has-$PYROOM" ]] && return
    if python3 -m venv "$environment" && "$environment/bin/pip" install --quiet "$PYROOM"; then
        touch "$environment/has-$PYROOM"
    else
        complain "$PYROOM cannot be installed; continuing without it"
    fi
}

mkdir -p "$WORK"
provide_peers
build_peer closed_form
build_peer sphere_tracing
build_peer embree -lembree3
provide_pyroomacoustics
[[ -n "$program" ]] || build_program
export PYTHONPATH=scripts PYTHONDONTWRITEBYTECODE=1
run python3 -m peers.measure --work "$WORK" --echomarch "$program" "${options[@]}"
