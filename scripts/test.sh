#!/usr/bin/env bash
# Runs all checks required before a change is accepted: format, lints, docs, tests, package. The checks need
# OpenGL, but no graphics card: llvmpipe suffices.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/test.sh [--fast]

Checks format, lints, documentation and package, and runs all tests, some of them also on other implementations
of OpenGL and in a browser. Missing Debian packages are installed.

  --fast  only format, lints, unit tests and one integration program of the library, without the slowest
          tests, and without other OpenGL, a display, a sound server or a browser; nothing is installed
END
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

# Lints and tests use the same features, so that each package is compiled only once for lints and once for tests.
readonly -a EVERYTHING=(--locked --workspace --all-features)

# Parts of the names of tests that --fast skips: statistics over many draws, and waves through large scenes. Each
# of these tests takes more than three seconds on an idle core, and together they take most of the time.
readonly -a SLOW=(
    a_known_room_has_its_figures
    closed_form_and_image_sources_agree_wave_for_wave
    closed_forms_meet_what_a_march_meets
    corner_hits_agree_with_an_independent_count
    each_reflection_takes_what_its_material_takes
    edges_and_parallel_planes_take_few_steps
    errors_are_honest
    figures_are_those_of_image_sources
    figures_of_single_batches_are_biased
    lines_are_free_as_far_as_bounds_say
    lines_parallel_to_faces_meet_what_they_should
    passes_of_any_length_give_the_same_bits
    phase_is_kept_for_an_hour
    scattered_shapes_are_all_met
    shaders_and_cpu_agree_on_random_trees
    shaders_and_cpu_agree_on_values_and_gradients
    the_energy_of_a_live_room_is_that_of_sabine
    the_seed_chooses_the_binaural_noise
    the_thesis_sees_the_same_with_cells_and_without
    two_errors_hold_the_truth_in_95_of_100_draws
    waves_in_a_room_with_each_field_end_as_in_the_reference
    waves_that_graze_a_torus_are_not_given_up
)

# Checks that the library's package contains the required files, and no files of excluded folders.
check_package() {
    local list file
    list="$(cargo package --list --locked --allow-dirty -p echomarch)"
    for file in Cargo.toml Cargo.lock README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE \
        src/lib.rs glsl/iterate_thesis.glsl examples/headless.rs tests/surfaces/main.rs benches/library.rs \
        examples/scenes/corner.ron docs/thesis.md docs/scene-format.md; do
        if ! grep -qxF "$file" <<<"$list"; then
            complain "the package lacks $file"
            return 1
        fi
    done
    if grep -E '^(\.ci|\.github|adapters|apps|bindings|docs/benchmarks|out|scripts|target)/' <<<"$list"; then
        complain "the package must not contain these files"
        return 1
    fi
    say "the package contains $(wc -l <<<"$list") files"
}

# Runs unit tests on another implementation of OpenGL. $1 is the start of its renderer's name, $2 the variables that
# select it; the remaining parameters are the arguments of the tests. Fails if a different renderer is used.
test_on() {
    local renderer="$1" names
    local -a with units=(cargo test "${EVERYTHING[@]}" --lib --)
    read -ra with <<<"$2"
    shift 2
    names="$(env "${with[@]}" "${units[@]}" --nocapture gpu_context_describes_itself 2>&1)"
    if ! grep -qF "gl: $renderer" <<<"$names"; then
        complain "$names"
        complain "not tested on $renderer: a different renderer is used with ${with[*]}"
        return 1
    fi
    say
    say "tests on another renderer, $(grep -F "gl: $renderer" <<<"$names")"
    if ! env "${with[@]}" "${units[@]}" "$@" --list 2>/dev/null | grep ': test$' >/dev/null; then
        complain "there is no such test: ${units[*]} $*"
        return 1
    fi
    run env "${with[@]}" "${units[@]}" "$@"
}

# zink on lavapipe is OpenGL on top of Vulkan. Its tests run one after the other and without Mesa's driver thread, and
# one test also runs without Mesa's GL thread; docs/portability.md explains the reasons. softpipe is slow, so only the
# smallest tests run there.
check_other_implementations() {
    local zink="LIBGL_ALWAYS_SOFTWARE=1 MESA_LOADER_DRIVER_OVERRIDE=zink GALLIUM_THREAD=0"
    local softpipe="LIBGL_ALWAYS_SOFTWARE=1 GALLIUM_DRIVER=softpipe"
    local threaded=gpu_drops_leave_the_context_of_others_current
    test_on zink "$zink" --test-threads=1 gl:: shader:: tracer:: --skip "$threaded"
    test_on zink "$zink mesa_glthread=false" "tracer::tests::foreign_contexts::$threaded" --exact
    test_on softpipe "$softpipe" gl:: shader::tests::driver_functions
}

# Lints each package with each of its features alone, and without any feature. cargo hack is not used, because in the
# root it also builds the other default members, which turn on features that the library alone would lack.
check_features() {
    local combinations package features
    combinations="$(cargo metadata --locked --no-deps --format-version 1 | python3 scripts/common/features.py)"
    while read -r package features; do
        run cargo clippy --locked -p "$package" --no-default-features --features "$features" -- -D warnings </dev/null
    done <<<"$combinations"
}

# Checks that the oldest Rust version stated in Cargo.toml compiles everything, unless it already ran the tests.
check_oldest_rust() {
    local oldest
    oldest="$(sed -n 's/^rust-version = "\(.*\)"$/\1/p' Cargo.toml)"
    if [[ "$(rustc --version)" == "rustc $oldest."* ]]; then
        say "Rust $oldest, the oldest supported version, compiled everything above"
    elif command -v rustup >/dev/null; then
        run rustup toolchain install --profile minimal "$oldest"
        run cargo "+$oldest" check --target-dir target/oldest-rust "${EVERYTHING[@]}"
    else
        complain "Rust $oldest, the oldest supported version, was not tested: there is no rustup to install it"
    fi
}

# Checks licences and duplicates of the dependencies (deny.toml). Advisories are downloaded and change independently of
# this repository, so .github/workflows/ci.yml checks them.
check_crates() {
    if cargo deny --version >/dev/null 2>&1; then
        run cargo deny --workspace --all-features check bans licenses sources
    else
        complain "licences and duplicates of crates were not checked: $(how_to_install_cargo deny)"
    fi
}

# Checks that the lock files of the workspaces beside the main one are up to date, before anything slow runs.
check_lock_files() {
    local manifest
    for manifest in adapters/Cargo.toml apps/page/Cargo.toml bindings/c/header/Cargo.toml fuzz/Cargo.toml; do
        if ! cargo update --quiet --workspace --locked --manifest-path "$manifest"; then
            complain "$manifest: its Cargo.lock is out of date; run cargo update --workspace there"
            return 1
        fi
    done
}

check_code() {
    check_lock_files
    run cargo fmt --all --check
    run cargo fmt --all --check --manifest-path apps/page/Cargo.toml
    run cargo fmt --all --check --manifest-path bindings/c/header/Cargo.toml
    run cargo clippy "${EVERYTHING[@]}" --all-targets -- -D warnings
    run python3 scripts/common/import_circles.py
}

check_fast() {
    need_cargo fmt clippy
    check_code
    run cargo test "${EVERYTHING[@]}" --lib --test surfaces -- "${SLOW[@]/#/--skip=}"
}

check_all() {
    provide_packages "${NEEDED_TO_TEST[@]}"
    need_cargo fmt clippy
    check_code
    check_features
    run scripts/public-api.sh
    run cargo test "${EVERYTHING[@]}"
    check_other_implementations
    run scripts/browser-test.sh
    run scripts/python-test.sh
    run scripts/c-test.sh
    run scripts/adapters-test.sh
    check_oldest_rust
    check_crates
    check_package
    run cargo package --locked --allow-dirty --no-verify -p echomarch
}

case "${1:-}" in
"") check_all ;;
--fast) check_fast ;;
-h | --help)
    usage
    exit 0
    ;;
*)
    usage >&2
    exit 2
    ;;
esac

say
say "all checks passed"
