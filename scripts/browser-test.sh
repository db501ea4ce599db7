#!/usr/bin/env bash
# Builds apps/page and tests it in a headless browser, on Chromium's software renderer.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

take_no_options "usage: scripts/browser-test.sh" "$@"

page="$PWD/target/page-tested"
provide_packages "${NEEDED_TO_TEST[@]}"
# Removes an earlier build, so that only the current build is tested.
rm -rf "$page"
run scripts/browser.sh -o "$page" --check-size
# Only one browser runs at a time, because each browser renders on the processor. The features are those of
# scripts/test.sh, so that its build is reused.
export ECHOMARCH_PAGE="$page"
run cargo test --locked --workspace --all-features --test program page:: -- --ignored --nocapture --test-threads=1

say
say "the page was built and was tested in $(chromium --version 2>/dev/null)"
