#!/usr/bin/env bash
# Measures Echomarch and other programs on the same waves in the same scenes, on one core.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/peers.sh [--marched] [--rounds N] [--scenes "A B …"] [--quick] [--add] [-o FILE]

Builds these programs, and runs them in each round one after the other on the same core:
  closed form in C++, sphere tracing in C++ (AVX2, eight waves at a time; scripts/peers/)
  Embree 3 (Debian's libembree-dev), by packets of 16
  pyroomacoustics 0.10.1 (PyPI)
  echomarch, profiles hybrid and march, whole frames
The scenes are A (an empty room), B (two more walls and three pillars), B16, B64, B256 and B1024 (16
to 1024 thin pillars). Results are written as Markdown. Programs that cannot be installed are left out.

With --marched it measures these programs in processor time instead (scripts/peers/marched/):
  a tracer of some 60 lines as a user would write it, in GLSL (with moderngl 5.12.0, PyPI)
  the same tracer in C++ (AVX2), and for cave a tracer specialised for its fields, in C++ (AVX2)
  echomarch, profiles hybrid and march, whole frames
The scenes are cave, gyroid, gyroid-gradient and ground. The report also contains the errors relative to exact waves.

  --marched        the scenes of marched fields
  --rounds N       number of rounds; results are medians over them (default 5)
  --scenes NAMES   only these scenes
  --quick          few waves and two rounds, for a trial; the figures are not reliable
  --add            keep the earlier rounds, and add new rounds
  -o FILE          where to write (default docs/benchmarks/peers-RENDERER.md, or
                   marched-peers-RENDERER.md)

  ECHOMARCH=PATH   the program to measure, instead of building it
  CXX=PATH         the compiler (default g++)

The built programs and the results of each round (rounds.jsonl, marched.jsonl) are in target/peers.
TEXT
}

# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

take_measuring_options "--marched --quick --add" "--rounds --scenes" "$@"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly WORK="$PWD/target/peers"
readonly COMPILER="${CXX:-g++}"
readonly PYROOM=pyroomacoustics==0.10.1
readonly MODERNGL=moderngl==5.12.0

# Installs the missing packages that all peers need, and the packages of the given lines.
provide_peers() {
    provide_packages \
        "command:g++ g++ compiles the peers" \
        "command:time time measures memory" \
        "command:python3 python3 runs the rounds" \
        "$@"
}

# Builds a peer in C++: $1 is its file in scripts/peers without .cpp, the remaining parameters are its libraries. A
# failure does not stop the other peers.
build_peer() {
    local name flags=(-std=c++17 -O3 -mavx2 -mfma)
    local source="scripts/peers/$1.cpp"
    name="$(basename "$1")"
    shift
    rm -f "$WORK/$name"
    run "$COMPILER" "${flags[@]}" -o "$WORK/$name" "$source" "$@" ||
        complain "$name cannot be built; continuing without it"
}

# Installs a Python package in the separate environment of the peers.
provide_python_package() {
    local package="$1" environment="$WORK/python"
    [[ -e "$environment/has-$package" ]] && return
    if python3 -m venv "$environment" && "$environment/bin/pip" install --quiet "$package"; then
        touch "$environment/has-$package"
    else
        complain "$package cannot be installed; continuing without it"
    fi
}

provide_peers_in_closed_form() {
    provide_peers "file:/usr/include/embree3/rtcore.h libembree-dev Embree, a peer"
    build_peer closed_form
    build_peer sphere_tracing
    build_peer embree -lembree3
    provide_python_package "$PYROOM"
}

provide_peers_that_march() {
    provide_peers "libGL.so.1 libgl1 OpenGL for the 60-line tracer"
    build_peer marched/reference -pthread
    build_peer marched/by_value
    build_peer marched/by_line
    provide_python_package "$MODERNGL"
}

mkdir -p "$WORK"
module=peers.measure
if is_among --marched "${options[*]}"; then
    module=peers.marched.measure
    provide_peers_that_march
else
    provide_peers_in_closed_form
fi
[[ -n "$program" ]] || build_program
export PYTHONPATH=scripts PYTHONDONTWRITEBYTECODE=1
run python3 -m "$module" --work "$WORK" --echomarch "$program" "${options[@]}"
