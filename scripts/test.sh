#!/usr/bin/env bash
# Runs all checks required before a change is accepted: format, lints, docs, tests, package. It needs OpenGL, but
# not a graphics card (llvmpipe will do).
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

take_no_options "usage: scripts/test.sh" "$@"

# The files that the package must contain, and those it must not.
check_package() {
    local list file
    list="$(cargo package --list --locked --allow-dirty)"
    for file in Cargo.toml Cargo.lock README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE \
        src/lib.rs src/main.rs glsl/iterate_thesis.glsl examples/headless.rs \
        examples/scenes/corner.ron docs/thesis.md docs/scene-format.md; do
        if ! grep -qxF "$file" <<<"$list"; then
            complain "the package lacks $file"
            return 1
        fi
    done
    if grep -E '^(\.ci|docs/benchmarks|out|target)/' <<<"$list"; then
        complain "the package must not hold these"
        return 1
    fi
    say "the package holds $(wc -l <<<"$list") files"
}

# Runs drawing tests on another implementation of OpenGL: $1 is the start of its renderer's name, $2 the
# variables that choose it, the rest the arguments of cargo test. Fails if another renderer answers.
test_on() {
    local renderer="$1" names
    local -a with
    read -ra with <<<"$2"
    shift 2
    names="$(env "${with[@]}" cargo test --locked --lib -- --nocapture gpu_context_describes_itself 2>&1)"
    if ! grep -qF "gl: $renderer" <<<"$names"; then
        complain "$names"
        complain "not tested on $renderer: another renderer draws with ${with[*]}"
        return 1
    fi
    say
    say "tests on another renderer, $(grep -F "gl: $renderer" <<<"$names")"
    if ! env "${with[@]}" cargo test --locked "$@" --list 2>/dev/null | grep ': test$' >/dev/null; then
        complain "there is no such test: cargo test $*"
        return 1
    fi
    run env "${with[@]}" cargo test --locked "$@"
}

# zink on lavapipe is OpenGL on top of Vulkan. Its tests run one after the other, and one of them without Mesa's
# thread for GL: docs/portability.md explains why. softpipe is slow and runs the smallest tests.
check_other_implementations() {
    local zink="LIBGL_ALWAYS_SOFTWARE=1 MESA_LOADER_DRIVER_OVERRIDE=zink"
    local softpipe="LIBGL_ALWAYS_SOFTWARE=1 GALLIUM_DRIVER=softpipe"
    local threaded=gpu_drops_leave_the_context_of_others_current
    test_on zink "$zink" --lib -- --test-threads=1 gpu:: kernel:: trace:: --skip "$threaded"
    test_on zink "$zink mesa_glthread=false" --lib -- "trace::tests::foreign_contexts::$threaded" --exact
    test_on softpipe "$softpipe" --lib -- gpu:: kernel::tests::driver_functions
}

provide_packages "${NEEDED_TO_TEST[@]}"
need_cargo fmt clippy

run cargo fmt --check
run cargo clippy --locked --all-targets -- -D warnings
run cargo clippy --locked --no-default-features --lib -- -D warnings
for features in picture walkthrough experiment parquet cli demo audio; do
    run cargo clippy --locked --no-default-features --features "$features" -- -D warnings
done
run python3 scripts/common/import_circles.py
run scripts/public-api.sh
run cargo test --locked
check_other_implementations
run scripts/browser-test.sh
run check_package
run cargo package --locked --allow-dirty --no-verify

say
say "all checks passed"
