#!/usr/bin/env bash
# Traces a measured room from its mesh, and compares the figures with the measured ones.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/validate.sh FOLDER [-o FOLDER] [--accuracy SHARE] [--time-limit SECONDS]

FOLDER has the mesh of a room (NAME.obj, NAME.glb or NAME.gltf), and NAME.json with the materials of the
mesh, the air, the places of sources and listeners, and the measured figures (docs/validation.md describes
it). The script traces all pairs, and writes comparison.csv, comparison.md and comparison.svg. Nothing is
fitted, and nothing is fetched.

  -o FOLDER             folder of the results (default out/validation)
  --accuracy SHARE      standard error of all figures of a pair (default 1%)
  --time-limit SECONDS  limit for each pair (default 60)

  ECHOMARCH=PATH        the program to run; the script then installs and builds nothing
TEXT
}

case "${1:-}" in
    "" | -h | --help)
        usage
        [[ -n "${1:-}" ]]
        exit
        ;;
esac
folder="$(realpath -- "$1")"
shift

# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

here="$PWD"
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program="${ECHOMARCH:-}"
if [[ -z "$program" ]]; then
    provide_packages "command:python3 python3 compares the figures"
    build_program
fi
program="$(realpath -- "$program")"
export PYTHONPATH="$PWD/scripts" PYTHONDONTWRITEBYTECODE=1
cd "$here"
exec python3 -m report.validate "$folder" --echomarch "$program" "$@"
