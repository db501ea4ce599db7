#!/usr/bin/env bash
# Builds the site: the documents, the page for walking, and sounds.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/site.sh [-o DIR] [--page DIR] [--serve [PORT]]

Builds the site from docs/ in DIR (default target/site/html), with Sphinx in a virtual environment in
target/site/tools (packages from PyPI). The sounds are rendered by the program. All links within the site are
checked. --serve then serves it at http://localhost:PORT/ (default 8000) until interrupted.

  --page DIR      the page for walking, made by scripts/browser.sh before (default: it is built)

  ECHOMARCH=PATH  the program that renders the sounds (default: built by cargo)
  PYTHON=PATH     the Python that runs Sphinx (default python3)
END
}

out=""
page=""
port=""
while (($#)); do
    case "$1" in
    -h | --help)
        usage
        exit 0
        ;;
    -o)
        out="$(realpath -m "${2:?"-o needs a folder"}")"
        shift
        ;;
    --page)
        page="$(realpath "${2:?"--page needs a folder"}")"
        shift
        ;;
    --serve)
        port=8000
        if [[ "${2:-}" =~ ^[0-9]+$ ]]; then
            port="$2"
            shift
        fi
        ;;
    *)
        usage >&2
        exit 2
        ;;
    esac
    shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

readonly WORK="$PWD/target/site"
readonly SOURCE="$WORK/source"
readonly EXTRA="$WORK/extra"
readonly -a TOOLS=(sphinx==9.0.4 myst-parser==5.2.0 furo==2025.12.19)
out="${out:-$WORK/html}"

# The folder for which Sphinx runs has the layout of the repository, with the pages of docs/site at its root.
stage() {
    local name
    rm -rf "$SOURCE"
    mkdir -p "$SOURCE"
    for name in * .github; do
        case "$name" in
        target | docs | *.md) ;;
        # Sphinx reads documents in these folders, and does not follow links to them.
        adapters | bindings) tar --exclude=target -cf - "$name" | tar -xf - -C "$SOURCE" ;;
        *) ln -s "$PWD/$name" "$SOURCE/$name" ;;
        esac
    done
    cp ./*.md "$SOURCE"
    cp -R docs "$SOURCE/docs"
    rm -rf "$SOURCE/docs/site"
    cp -R docs/site/. "$SOURCE"
    ln -s "$EXTRA" "$SOURCE/extra"
}

# Renders the sounds of docs/site/listen.md by its own commands.
render_sounds() {
    local program="${ECHOMARCH:-}" programs
    if [[ -z "$program" ]]; then
        run cargo build --release --locked
        program="$(realpath "${CARGO_TARGET_DIR:-target}")/release/echomarch"
    fi
    program="$(realpath "$program")"
    programs="$WORK/bin"
    rm -rf "$programs" "$EXTRA/sounds"
    mkdir -p "$programs" "$EXTRA/sounds"
    ln -s "$program" "$programs/echomarch"
    ln -sfn "$PWD/examples" "$WORK/commands/examples"
    ln -sfn "$EXTRA/sounds" "$WORK/commands/sounds"
    PATH="$programs:$PATH" run python3 scripts/site/run_commands.py --in "$WORK/commands" docs/site/listen.md
}

mkdir -p "$WORK/commands" "$EXTRA"
[[ -d "$WORK/tools" ]] || run "${PYTHON:-python3}" -m venv "$WORK/tools"
if ! "$WORK/tools/bin/python" -m pip install --quiet --disable-pip-version-check "${TOOLS[@]}"; then
    complain "the site needs Sphinx, and pip cannot fetch it: ${TOOLS[*]}"
    exit 1
fi
if [[ -z "$page" ]]; then
    page="$PWD/target/page"
    run scripts/browser.sh -o "$page"
fi
rm -rf "$EXTRA/page"
cp -R "$page" "$EXTRA/page"
render_sounds
stage
rm -rf "$out"
run "$WORK/tools/bin/python" -m sphinx -q -W --keep-going -b html "$SOURCE" "$out"
rm -rf "$out/.doctrees" "$out/.buildinfo"
run python3 scripts/site/check_links.py "$out"
if [[ -n "$port" ]]; then
    say "http://localhost:$port/"
    exec python3 -m http.server --directory "$out" --bind 127.0.0.1 "$port"
fi
say "$out: $(du -sh "$out" | cut -f1)"
