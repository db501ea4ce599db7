#!/usr/bin/env bash
# Compares the waves of several implementations of OpenGL, wave by wave.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/renderers.sh [--waves N] [--iterations N] [--with NAME=SETTINGS ...] [-o FILE]

Traces scenes on this machine's first renderer, and the same scenes on other renderers: OpenGL ES and OSMesa
of the same driver, zink, and softpipe (fewer waves). Writes a Markdown table: the number of bit-identical
waves, the greatest distance between waves after one iteration, and the number of waves that end elsewhere
after all iterations. For comparison, the table also has the number of waves that end elsewhere on the
first renderer when the source is moved by 1 micrometre.

  --waves N              waves per scene (default 65536)
  --iterations N         iterations (default 8)
  --with NAME=SETTINGS   an additional implementation; SETTINGS are VARIABLE=VALUE words and options of
                         echomarch, such as "ANGLE=LD_LIBRARY_PATH=/opt/angle --gl gles"
  -o FILE                where to write (default: print it)

  ECHOMARCH=PATH         the program to run; nothing is then installed or built
TEXT
}

# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

take_measuring_options "" "--waves --iterations --with" "$@"
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ -z "$program" ]]; then
    provide_packages "command:python3 python3 compares the waves" \
        "icd:lvp mesa-vulkan-drivers Vulkan in software, for another OpenGL (zink)"
    build_program
fi
export PYTHONPATH=scripts PYTHONDONTWRITEBYTECODE=1
run python3 -m report.renderers --echomarch "$program" "${options[@]}"
