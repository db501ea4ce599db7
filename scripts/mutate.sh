#!/usr/bin/env bash
# Mutation testing: changes the code one statement at a time and runs the tests. A change that
# survives is covered by no test. Run this script by hand; a shader file takes minutes to hours.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/mutate.sh glsl [--every N] [FILE...]
       scripts/mutate.sh rust [ARGUMENT...]

  glsl   changes the shaders (all of glsl/, or the named files) by scripts/mutate/glsl.rules, and
         runs the tests of shaders, surfaces and frames for each change; --every N tries only every
         N-th change
  rust   runs cargo-mutants over scene, shader, tracer and audio, with these additional arguments

Surviving changes are written to target/mutate/survivors.txt (glsl) or target/mutate/mutants.out (rust).

examples:
  scripts/mutate.sh glsl glsl/shape/cylinder.glsl
  scripts/mutate.sh glsl --every 20
  scripts/mutate.sh rust --shard 0/50
END
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

readonly WORK="$PWD/target/mutate"
# Time limit in seconds, above the time of the slowest tests on two busy cores.
readonly LONGEST_S=1200

# Installs the mutating program in a separate Python environment.
provide_universalmutator() {
    local environment="$WORK/python"
    if [[ ! -x "$environment/bin/mutate" ]]; then
        python3 -m venv "$environment"
        "$environment/bin/pip" install --quiet universalmutator==1.14.1
    fi
    readonly MUTATE="$environment/bin/mutate"
}

# Builds the tests that read the shaders at run time; sets UNITS, SURFACES and TRACER.
build_tests() {
    local built
    built="$(RUSTFLAGS="--cfg glsl_at_run_time" CARGO_TARGET_DIR="$WORK/build" \
        cargo test --locked --no-run -p echomarch --all-features --lib --test surfaces --test tracer 2>&1 | tee /dev/stderr)"
    UNITS="$WORK/build/$(grep -oE 'debug/deps/echomarch-[0-9a-f]+' <<<"$built")"
    SURFACES="$WORK/build/$(grep -oE 'debug/deps/surfaces-[0-9a-f]+' <<<"$built")"
    TRACER="$WORK/build/$(grep -oE 'debug/deps/tracer-[0-9a-f]+' <<<"$built")"
}

# Whether all tests pass with the shaders in ECHOMARCH_GLSL. The tests that detect the most changes run first. Tests
# that compare the shaders' text with stored copies are excluded, because they would fail at every change.
tests_pass() {
    local limited=(timeout "$LONGEST_S")
    "${limited[@]}" "$UNITS" tracer::tests::gpu_against_cpu &&
        "${limited[@]}" "$UNITS" tracer::tests::arrivals &&
        "${limited[@]}" "$UNITS" shader::tests:: tracer::tests::field_waves \
            tracer::tests::loop_budget &&
        "${limited[@]}" "$SURFACES" &&
        "${limited[@]}" "$TRACER"
}

# Tries the changes of one file ($1). Only every $2-th change is tried, counted over all files.
try_file() {
    local file="$1" every="$2" mutant folder
    folder="$WORK/mutants/${file//\//_}"
    mkdir -p "$folder"
    "$MUTATE" "$file" none "$PWD/scripts/mutate/glsl.rules" --only "$PWD/scripts/mutate/glsl.rules" \
        --noCheck --mutantDir "$folder" >/dev/null
    for mutant in "$folder"/*; do
        count=$((count + 1))
        ((count % every == 0)) || continue
        try_mutant "$file" "$mutant"
    done
    cp "$file" "$ECHOMARCH_GLSL/${file#glsl/}"
}

try_mutant() {
    local file="$1" mutant="$2" change
    cp "$mutant" "$ECHOMARCH_GLSL/${file#glsl/}"
    change="$(diff "$file" "$mutant" | tail -n +2 || true)"
    made=$((made + 1))
    if tests_pass >"$WORK/last.log" 2>&1; then
        survived=$((survived + 1))
        printf '%s\n%s\n\n' "$file" "$change" | tee -a "$WORK/survivors.txt"
    fi
    say "$file: $made changes, $survived survive"
}

mutate_glsl() {
    local every=1 file
    local -a files=()
    while (($#)); do
        case "$1" in
        --every)
            every="$2"
            shift
            ;;
        *) files+=("$1") ;;
        esac
        shift
    done
    ((${#files[@]})) || mapfile -t files < <(git ls-files 'glsl/*.glsl' 'glsl/*.frag' ':!glsl/view')
    mkdir -p "$WORK"
    : >"$WORK/survivors.txt"
    provide_universalmutator
    build_tests
    export ECHOMARCH_GLSL="$WORK/glsl"
    rm -rf "$ECHOMARCH_GLSL" "$WORK/mutants"
    cp -r glsl "$ECHOMARCH_GLSL"
    tests_pass >"$WORK/last.log" 2>&1 || {
        complain "the tests fail without a change: see $WORK/last.log"
        return 1
    }
    made=0 survived=0 count=0
    for file in "${files[@]}"; do
        try_file "$file" "$every"
    done
    say "$made changes, $survived survive: $WORK/survivors.txt"
}

mutate_rust() {
    need_cargo mutants
    mkdir -p "$WORK"
    run cargo mutants --output "$WORK" -p echomarch --all-features \
        -f 'src/scene/**' -f 'src/shader/**' -f 'src/tracer/**' -f 'src/audio/**' "$@"
}

case "${1:-}" in
glsl) shift && mutate_glsl "$@" ;;
rust) shift && mutate_rust "$@" ;;
-h | --help) usage ;;
*)
    usage >&2
    exit 2
    ;;
esac
