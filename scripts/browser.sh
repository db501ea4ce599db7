#!/usr/bin/env bash
# Builds apps/page, the page for walking through a scene and hearing it, as static files for any web server.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/browser.sh [-o DIR] [--serve [PORT]] [--check-size | --update-size]

Builds the page in DIR (default target/page), which must be new, empty, or made by this script. --serve then
serves the page at http://localhost:PORT/ (default 8000) with python3 until interrupted.

  --check-size   fails if the size in docs/browser.md differs from this build by more than 5 %
  --update-size  updates the size in docs/browser.md

If the installed Rust lacks the target wasm32-unknown-unknown, rustup adds it. If that is not possible,
Debian's compiler for browsers is unpacked in target/tools and used only for the page.
END
}

out=""
port=""
size=""
while (($#)); do
    case "$1" in
    -h | --help)
        usage
        exit 0
        ;;
    -o)
        out="$(realpath -m "${2:?"-o needs a value"}")"
        shift
        ;;
    --check-size | --update-size)
        size="${1#--}"
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

readonly WASM=wasm32-unknown-unknown
readonly MANIFEST=apps/page/Cargo.toml
# The build folder is separate from the program's, because the features and possibly the compiler differ.
readonly BUILT=target/browser
readonly DEBIAN=target/tools/rustc-web
readonly DEBIAN_PACKAGES=(rustc-web libstd-rust-web-dev rust-web-src)
# A file in the output folder that lists the files written by this script, one per line.
readonly MARKER=.echomarch-page
# The document that states the size of the wasm.
readonly DOCUMENT=docs/browser.md
# The largest relative difference between the stated size and the build. The sizes are stated in tenths of a
# megabyte, and a change of a few kilobytes must not fail the tests.
readonly SLACK=0.05
out="${out:-$PWD/target/page}"

# Unfinished files are removed at every end of the script, including errors and interrupts.
temporary=()
clean_up() {
    ((${#temporary[@]} == 0)) || rm -rf -- "${temporary[@]}"
}
trap clean_up EXIT

# Rejects an output folder that contains other files.
check_out() {
    [[ -e "$out" ]] || return 0
    if [[ ! -d "$out" ]]; then
        complain "$out is a file: name a folder with -o"
        exit 2
    fi
    if [[ ! -f "$out/$MARKER" && -n "$(ls -A "$out")" ]]; then
        complain "$out contains files that this script has not made: name a new or an empty folder with -o"
        exit 2
    fi
}

# Whether the installed compiler has a standard library for browsers.
has_wasm() {
    [[ -d "$(rustc --print target-libdir --target "$WASM" 2>/dev/null)" ]]
}

# Unpacks, without installing, Debian's compiler for browsers and its libraries.
unpack_debian() {
    if [[ -x "$DEBIAN/usr/bin/rustc" && -d "$DEBIAN/usr/lib/rustlib/src/rust/library" ]]; then
        return 0
    fi
    if ! command -v apt-get >/dev/null || ! command -v dpkg >/dev/null; then
        complain "no standard library for $WASM: run rustup target add $WASM"
        return 1
    fi
    local folder unpacked package packages
    folder="$(mktemp -d)"
    mkdir -p "$(dirname "$DEBIAN")"
    unpacked="$(mktemp -d "$DEBIAN.XXXXXX")"
    temporary+=("$folder" "$unpacked")
    # Names of library packages contain versions, so the packages that the newest compiler depends on are used.
    packages="$(apt-cache depends --recurse --no-recommends --no-suggests --no-conflicts --no-breaks \
        --no-replaces --no-enhances "${DEBIAN_PACKAGES[@]}" |
        grep -E '^(rustc-web|rust-web-src|libstd-rust-web.*|libllvm[0-9]+|libz3-4)$' | sort -u)"
    # shellcheck disable=SC2086 # A list of names.
    (cd "$folder" && run apt-get download $packages)
    for package in "$folder"/*.deb; do
        run dpkg -x "$package" "$unpacked"
    done
    # The folder gets this name only when the compiler is complete.
    rm -rf "$DEBIAN"
    mv "$unpacked" "$DEBIAN"
}

# The folder of Debian's compiler with the libraries of this machine's architecture.
debian_libraries() {
    local library
    for library in "$DEBIAN"/usr/lib/*-linux-gnu*/libLLVM*.so*; do
        if [[ -e "$library" ]]; then
            realpath "$(dirname "$library")"
            return 0
        fi
    done
    complain "Debian's compiler for browsers in $DEBIAN has no libLLVM: remove the folder and run again"
    return 1
}

# Sets `cargo_wasm` to the command that builds for browsers.
choose_compiler() {
    cargo_wasm=(cargo)
    if has_wasm; then
        return 0
    fi
    if command -v rustup >/dev/null && run rustup target add "$WASM" && has_wasm; then
        return 0
    fi
    say "the installed Rust has no standard library for $WASM, and rustup cannot add it: using Debian's compiler"
    provide_packages "command:wasm-ld lld links programs for browsers"
    unpack_debian
    local root="$PWD/$DEBIAN/usr" libraries
    libraries="$(debian_libraries)"
    cargo_wasm=(env "LD_LIBRARY_PATH=$libraries" "RUSTC=$root/bin/rustc"
        # Also builds the standard library from source. Stable compilers do this only with this variable.
        RUSTC_BOOTSTRAP=1 CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=wasm-ld
        cargo -Zbuild-std=std,panic_abort)
}

# Replaces the files of an earlier run by the page, its wasm and the JavaScript that loads the wasm.
assemble() {
    local parts file
    mkdir -p "$out"
    parts="$(mktemp -d)"
    temporary+=("$parts")
    cp apps/page/page/* "$parts"
    run cargo run --release --locked --quiet --manifest-path "$MANIFEST" --target-dir "$BUILT" -p bindgen -- \
        "$BUILT/$WASM/release/echomarch_browser.wasm" "$parts/pkg"
    (cd "$parts" && find . -type f ! -name "$MARKER" -printf '%P\n' | sort >"$MARKER")
    if [[ -f "$out/$MARKER" ]]; then
        while IFS= read -r file; do
            rm -f -- "$out/$file"
        done <"$out/$MARKER"
    fi
    cp -R "$parts/." "$out"
    chmod 755 "$out"
}

check_out
if [[ -n "$port" ]] && ! command -v python3 >/dev/null; then
    complain "--serve needs python3: install it, or serve $out with another web server"
    exit 2
fi
need_cargo build
choose_compiler
run "${cargo_wasm[@]}" build --release --locked --manifest-path "$MANIFEST" --target "$WASM" \
    --target-dir "$BUILT"
assemble

# The sentence in docs/browser.md for the sizes of the wasm ($1) and of its gzip file ($2), in bytes.
size_in_words() {
    awk -v whole="$1" -v small="$2" \
        'BEGIN { printf "The wasm has %.1f MB, %.1f MB with `gzip -9`", whole / 1e6, small / 1e6 }'
}

# Whether docs/browser.md states the sizes of the wasm ($1) and of its gzip file ($2), in bytes, to within SLACK.
states_size() {
    sed -nE 's/.*The wasm has ([0-9.]+) MB, ([0-9.]+) MB with `gzip -9`.*/\1 \2/p' "$DOCUMENT" |
        awk -v whole="$1" -v small="$2" -v slack="$SLACK" '
            function near(stated, bytes) { return (stated * 1e6 - bytes) ^ 2 <= (slack * bytes) ^ 2 }
            { found = near($1, whole) && near($2, small) }
            END { exit !found }'
}

# Compares the size in docs/browser.md with the build, or updates it.
settle_size() {
    if [[ "$size" != update-size ]] && states_size "$1" "$2"; then
        return 0
    fi
    local told
    told="$(size_in_words "$1" "$2")"
    case "$size" in
    update-size) sed -i -E "s/The wasm has [0-9.,]+ MB, [0-9.,]+ MB with \`gzip -9\`/$told/" "$DOCUMENT" ;;
    check-size)
        complain "$DOCUMENT does not state the size of this build to within 5 % ($told): run" \
            "scripts/browser.sh --update-size"
        return 1
        ;;
    *) say "$DOCUMENT does not state the size of this build to within 5 %: run scripts/browser.sh --update-size" ;;
    esac
}

wasm="$out/pkg/echomarch_browser_bg.wasm"
bytes="$(stat -c %s "$wasm")"
packed="$(gzip -9 -c "$wasm" | wc -c)"
say
say "$out: $bytes bytes of wasm, $packed with gzip"
settle_size "$bytes" "$packed"
if [[ -n "$port" ]]; then
    say "http://localhost:$port/"
    clean_up
    exec python3 -m http.server --directory "$out" --bind 127.0.0.1 "$port"
fi
say "to open the page: scripts/browser.sh --serve"
