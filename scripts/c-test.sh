#!/usr/bin/env bash
# Builds the C interface, compares its header with the code, and runs its tests in C with sanitizers.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/c-test.sh [--update]

Builds bindings/c, checks that bindings/c/include/echomarch.h is what cbindgen makes of the code, compiles
bindings/c/tests and bindings/c/examples, and runs the tests with the address, leak and undefined behaviour sanitizers.

  --update  only writes the header
TEXT
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

readonly PACKAGE=bindings/c
readonly HEADER="$PACKAGE/include/echomarch.h"
readonly TARGET="${CARGO_TARGET_DIR:-target}"
readonly WORK="$TARGET/c"
readonly -a WARNINGS=(-std=c11 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror)
# What Rust's standard library needs.
readonly -a LIBRARIES=(-lgcc_s -lutil -lrt -lpthread -lm -ldl)

# Prints the header of the code.
header() {
    cargo run --quiet --locked --target-dir "$TARGET" --manifest-path "$PACKAGE/header/Cargo.toml"
}

case "${1:-}" in
"") ;;
--update)
    made="$(header)"
    printf '%s\n' "$made" >"$HEADER"
    exit
    ;;
-h | --help)
    usage
    exit
    ;;
*)
    usage >&2
    exit 2
    ;;
esac

mkdir -p "$WORK"
header >"$WORK/echomarch.h"
if ! diff -u "$HEADER" "$WORK/echomarch.h"; then
    complain "$HEADER is not that of the code: run scripts/c-test.sh --update"
    exit 1
fi
run cargo build --locked -p echomarch-c
library="$TARGET/debug/libechomarch_c.a"
run cc "${WARNINGS[@]}" -g -fsanitize=address,undefined -fno-sanitize-recover -I"$PACKAGE/include" \
    "$PACKAGE/tests/interface.c" "$library" "${LIBRARIES[@]}" -o "$WORK/interface"
run env LSAN_OPTIONS="suppressions=$PACKAGE/tests/leaks.txt:print_suppressions=0" "$WORK/interface"
# The example as in its first lines, with the shared library.
run cc "${WARNINGS[@]}" -I"$PACKAGE/include" "$PACKAGE/examples/loop.c" -L"$TARGET/debug" -lechomarch_c -lm \
    -o "$WORK/loop"
run env LD_LIBRARY_PATH="$TARGET/debug" "$WORK/loop" 90
