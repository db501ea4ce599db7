#!/usr/bin/env bash
# Builds the wheel of the Python package.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/wheel.sh [--plain] [-o DIR]

Builds the wheel of the Python package echomarch (bindings/python) into DIR. On Linux the wheel is linked with zig
(PyPI: ziglang) against an old C library, so that it runs on old systems, and checked with auditwheel. The tools
come from PyPI, into target/python/tools.

  --plain  link with the system's C library, and do not check the wheel; for tests on this machine
  -o DIR   folder of the wheel (default target/wheels)

  PYTHON=PATH  the Python that runs the tools (default python3)
TEXT
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

readonly TOOLS="$PWD/target/python/tools"
# The oldest C library with which the standard library of Rust and std's threads link: manylinux2014.
readonly MANYLINUX=manylinux2014
readonly MATURIN=maturin==1.16.0
readonly ZIG=ziglang==0.17.1
readonly AUDITWHEEL=auditwheel==6.8.2

plain=false
folder=target/wheels
while (($# > 0)); do
    case "$1" in
    --plain) plain=true ;;
    -o)
        folder="${2:?-o needs a folder}"
        shift
        ;;
    -h | --help)
        usage
        exit 0
        ;;
    *)
        usage >&2
        exit 2
        ;;
    esac
    shift
done

# The folder of a virtual environment's programs.
programs_of() {
    if [[ -d "$1/Scripts" ]]; then
        say "$1/Scripts"
    else
        say "$1/bin"
    fi
}

[[ -d "$TOOLS" ]] || run "${PYTHON:-python3}" -m venv "$TOOLS"
PATH="$(programs_of "$TOOLS"):$PATH"
mkdir -p "$folder"

if "$plain" || [[ "$(uname -s)" != Linux ]]; then
    run python -m pip install --quiet --disable-pip-version-check "$MATURIN"
    run maturin build --release --locked --manifest-path bindings/python/Cargo.toml --out "$folder" \
        --compatibility "$([[ "$(uname -s)" == Linux ]] && say linux || say pypi)"
    exit
fi
run python -m pip install --quiet --disable-pip-version-check "$MATURIN" "$ZIG" "$AUDITWHEEL"
run maturin build --release --locked --zig --manifest-path bindings/python/Cargo.toml --out "$folder" \
    --compatibility "$MANYLINUX"
for wheel in "$folder"/echomarch-*"$MANYLINUX"*.whl "$folder"/echomarch-*manylinux_2_17*.whl; do
    [[ -e "$wheel" ]] || continue
    report="$(auditwheel show "$wheel")"
    say "$report"
    if ! grep -qF manylinux_2_17 <<<"$report"; then
        complain "$wheel needs a newer system than $MANYLINUX"
        exit 1
    fi
done
