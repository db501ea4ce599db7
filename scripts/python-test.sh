#!/usr/bin/env bash
# Builds the wheel of the Python package, installs it into a clean environment, and runs its tests there.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/python-test.sh [PYTEST OPTIONS …]

Builds the wheel (scripts/wheel.sh --plain), installs it into a new virtual environment in target/python/tests, and
runs bindings/python/tests with the program as reference. pip installs the packages of
bindings/python/tests/requirements.txt. Without access to a package index, it says so and tests nothing.

  PYTHON=PATH               the Python to test with, 3.9 or later (default python3)
  ECHOMARCH=PATH            the program (default: built by cargo)
  ECHOMARCH_WHEEL=PATH      the wheel, instead of building it
  ECHOMARCH_RESPONSES=N     number of responses in the test of memory (default 60)
TEXT
}

if [[ "${1:-}" == -h || "${1:-}" == --help ]]; then
    usage
    exit 0
fi

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

readonly WORK="$PWD/target/python"
readonly REQUIREMENTS=bindings/python/tests/requirements.txt

# The wheel under test.
wheel() {
    if [[ -n "${ECHOMARCH_WHEEL:-}" ]]; then
        realpath "$ECHOMARCH_WHEEL"
        return
    fi
    rm -rf "$WORK/wheel"
    scripts/wheel.sh --plain -o "$WORK/wheel" >&2
    ls "$WORK"/wheel/echomarch-*.whl
}

# Whether pip can fetch packages.
reaches_pypi() {
    "${PYTHON:-python3}" -m pip download --quiet --disable-pip-version-check --no-deps --dest "$WORK/probe" pytest
}

if ! reaches_pypi; then
    complain "the Python package is not tested: pip cannot fetch packages"
    exit
fi

if [[ -z "${ECHOMARCH:-}" ]]; then
    run cargo build --locked -p echomarch-cli --all-features
    ECHOMARCH="$(realpath "${CARGO_TARGET_DIR:-target}")/debug/echomarch"
fi
export ECHOMARCH
package="$(wheel)"
rm -rf "$WORK/tests"
run "${PYTHON:-python3}" -m venv "$WORK/tests"
python="$WORK/tests/bin/python"
# pip keeps downloaded packages in its cache.
run "$python" -m pip install --quiet --disable-pip-version-check -r "$REQUIREMENTS"
run "$python" -m pip install --quiet --disable-pip-version-check "$package"
cd bindings/python
run "$python" -m pytest -q -p no:cacheprovider "$@"
