#!/usr/bin/env bash
# Lists the public items of the library, and compares the list with docs/public-api.txt. The list comes from
# rustdoc's pages: each item, its fields, variants and methods, and its traits. cargo public-api is not used, because
# it needs nightly Rust, and the tests run with stable Rust.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/public-api.sh [--update]

  --update  rewrites docs/public-api.txt

Builds the library's documentation without features and with all features, and fails on any warning.
END
}

update=false
case "${1:-}" in
"") ;;
--update) update=true ;;
-h | --help)
    usage
    exit 0
    ;;
*)
    usage >&2
    exit 2
    ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

readonly LISTED="docs/public-api.txt"
readonly PAGES="${CARGO_TARGET_DIR:-target}/doc/echomarch"
export LC_ALL=C

# Lists the parts of one item from the anchors of its page ($1), under its path ($2).
list_parts() {
    awk -v path="$2" '
        BEGIN { RS = "<"; own = path; sub(/.*::/, "", own) }
        !match($0, /id="[^"]*"/) { next }
        { id = substr($0, RSTART + 4, RLENGTH - 5) }
        id ~ /^(synthetic|blanket)-implementations$/ || id == "implementors" { exit }
        id == "trait-implementations" { traits = 1 }
        traits && id ~ /^impl-/ {
            if (id !~ "-for-" own "(%3C.*)?(-[0-9]+)?$") next
            sub(/^impl-/, "", id)
            sub(/-for-.*/, "", id)
            gsub(/%3C/, "<", id)
            gsub(/%3E/, ">", id)
            if (id != "StructuralPartialEq") print path ": " id
        }
        !traits && match(id, /^(tymethod|method|structfield|variant|associatedconstant|associatedtype)\./) {
            name = substr(id, RLENGTH + 1)
            sub(/-[0-9]+$/, "", name)
            sub(/\.field\./, "::", name)
            if (name !~ /\.fields$/) print path "::" name
        }' "$1"
}

# All public items in rustdoc's pages, one per line, with their parts.
list_items() {
    local page file name path
    grep -o '<li><a href="[^"]*\.html">' "$PAGES/all.html" | cut -d'"' -f2 | while read -r page; do
        file="${page##*/}"
        name="${file#*.}"
        path="${page%"$file"}"
        path="${path//\//::}${name%.html}"
        printf '%s (%s)\n' "$path" "${file%%.*}"
        list_parts "$PAGES/$page" "$path"
    done | sort -u
}

document() {
    run env RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps -p echomarch "$@"
}

document
alone="$(list_items)"
document --all-features
all="$(list_items)"

found="$(mktemp)"
trap 'rm -f "$found"' EXIT
{
    say "What the library makes public: items, their parts, their traits; see scripts/public-api.sh."
    say
    say "# Without features: $(grep -c ' (' <<<"$alone") items"
    say
    say "$alone"
    say
    say "# More with all features: $(comm -13 <(say "$alone") <(say "$all") | grep -c ' (') items"
    say
    comm -13 <(say "$alone") <(say "$all")
} >"$found"

if $update; then
    cp "$found" "$LISTED"
    say "wrote $LISTED"
elif ! diff -u "$LISTED" "$found" >&2; then
    complain "the public items of the library differ from $LISTED: if this is intended, run"
    complain "scripts/public-api.sh --update, and describe the change for callers in CHANGELOG.md"
    exit 1
fi
