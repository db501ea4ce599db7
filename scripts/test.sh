#!/usr/bin/env bash
# Checks everything that is checked before a change is taken: format, lints, docs,
# tests, package. No graphics card is needed; OpenGL is (llvmpipe will do).
set -euo pipefail

case "${1:-}" in
"") ;;
-h | --help)
    echo "usage: scripts/test.sh"
    exit 0
    ;;
*)
    echo "usage: scripts/test.sh" >&2
    exit 2
    ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

# Everything that the package has to hold, and what it must not.
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

provide_packages "${NEEDED_TO_TEST[@]}"
need_cargo fmt clippy

run cargo fmt --check
run cargo clippy --locked --all-targets -- -D warnings
run cargo clippy --locked --no-default-features --lib -- -D warnings
for features in picture experiment parquet cli demo audio; do
    run cargo clippy --locked --no-default-features --features "$features" -- -D warnings
done
run scripts/public-api.sh
run cargo test --locked
run check_package
run cargo package --locked --allow-dirty --no-verify

say
say "all checks passed"
