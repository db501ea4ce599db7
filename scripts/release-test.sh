#!/usr/bin/env bash
# Installs each part of a release from its folder, and uses it.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/release-test.sh [--install] OUT

Tests the folder OUT of scripts/release.sh: checksums, the archive, the Debian package, the wheel in a new virtual
environment, the page, the site and its tutorials, and the packages for crates.io. Everything is unpacked in a temporary
folder.

  --install   also installs the Debian package with apt-get and removes it; for a container that is thrown away

  PYTHON=PATH the Python of the virtual environment (default python3)
END
}

install=false
folder=""
while (($#)); do
    case "$1" in
    -h | --help)
        usage
        exit 0
        ;;
    --install) install=true ;;
    -*)
        usage >&2
        exit 2
        ;;
    *) folder="$1" ;;
    esac
    shift
done
if [[ ! -d "$folder" ]]; then
    usage >&2
    exit 2
fi
OUT="$(realpath "$folder")"
readonly OUT

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

scratch="$(mktemp -d)"
trap 'rm -rf -- "$scratch"' EXIT

fail() {
    complain "$*"
    exit 1
}

# The only file of the release that matches $1.
only() {
    local -a found=("$OUT"/$1)
    [[ ${#found[@]} == 1 && -f "${found[0]}" ]] || fail "$OUT must have one file $1"
    say "${found[0]}"
}

# The program $1 has the version and traces; its manuals and completions in $2 can be used.
check_program() {
    local program="$1" share="$2"
    [[ "$("$program" --version)" == "echomarch $version" ]] || fail "$program is not version $version"
    "$program" trace corner --waves 4096 --json >"$scratch/trace.json"
    python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$scratch/trace.json"
    bash -euc "source '$share/bash-completion/completions/echomarch'; complete -p echomarch" >/dev/null
    [[ -s "$share/fish/vendor_completions.d/echomarch.fish" ]] || fail "the completions of fish are missing"
    grep -q '^#compdef echomarch' "$share/zsh/vendor-completions/_echomarch" || fail "the completions of zsh are missing"
    local page
    for page in echomarch echomarch-trace echomarch-impulse; do
        gzip -cdf "$share/man/man1/$page.1"* | grep -q '^\.TH' || fail "the manual $page is missing"
    done
}

check_archive() {
    local archive name
    archive="$(only "echomarch-$version-*.tar.gz")"
    name="$(basename "$archive" .tar.gz)"
    tar -xzf "$archive" -C "$scratch"
    check_program "$scratch/$name/bin/echomarch" "$scratch/$name/share"
    local file
    for file in LICENSE-MIT LICENSE-APACHE INSTALL.md CHANGELOG.md examples/scenes/corner.ron; do
        [[ -s "$scratch/$name/$file" ]] || fail "$archive lacks $file"
    done
    "$scratch/$name/bin/echomarch" impulse "$scratch/$name/examples/scenes/hall.ron" --source violin \
        --listener "row 3" --waves 1024 --seconds 0.5 --quiet >/dev/null
    # The tutorials use this program.
    program="$scratch/$name/bin"
    # cargo binstall computes the names of the archive and of the program in it.
    cargo metadata --locked --no-deps --format-version 1 | python3 scripts/release/binstall_names.py "${name#"echomarch-$version-"}" \
        >"$scratch/binstall"
    grep -qxF "$name.tar.gz" "$scratch/binstall" || fail "cargo binstall expects $(head -n 1 "$scratch/binstall")"
    grep -qxF "$name/bin/echomarch" "$scratch/binstall" || fail "cargo binstall expects $(tail -n 1 "$scratch/binstall")"
    say "archive: runs, with manuals, completions and licences"
}

check_debian_package() {
    local package root="$scratch/deb"
    package="$(only 'echomarch_*.deb')"
    [[ "$(dpkg-deb -f "$package" Version)" == "$version"* ]] || fail "$package is not version $version"
    dpkg -x "$package" "$root"
    check_program "$root/usr/bin/echomarch" "$root/usr/share"
    [[ -s "$root/usr/share/doc/echomarch/copyright" ]] || fail "$package has no copyright"
    say "Debian package: runs; depends on $(dpkg-deb -f "$package" Depends)"
    if "$install"; then
        run apt-get install -y --no-install-recommends "$package"
        (cd / && run echomarch trace corner --waves 1024)
        run apt-get remove -y echomarch
    fi
}

check_wheel() {
    local wheel
    wheel="$(only 'echomarch-*.whl')"
    "${PYTHON:-python3}" -m venv "$scratch/venv"
    python="$scratch/venv/bin/python"
    if ! "$python" -m pip install --quiet --disable-pip-version-check "$wheel"; then
        fail "the wheel or NumPy cannot be installed"
    fi
    (
        cd "$scratch"
        scene="$program/../examples/scenes/two-rooms.ron"
        "$program/echomarch" impulse "$scene" --source 1 --listener 1 --waves 8192 --quiet --json >program.json
        "$python" - "$version" "$scene" <<'PYTHON'
import json, sys
import echomarch as em
scene = em.Scene(sys.argv[2])
pair = json.load(open("program.json"))["pairs"][0]
names = next(iter(scene.sources)), next(iter(scene.listeners))
r = em.response(scene, source=names[0], listener=names[1], waves=8192)
assert em.__version__ == sys.argv[1], em.__version__
for figure, name in (("g", "g_db"), ("edt", "edt_s")):
    assert None not in pair[name], f"the program gives no {name}"
    assert list(r.figures[figure]) == pair[name], f"the wheel and the program give different {name}"
PYTHON
    )
    say "wheel: installed in a new environment, gives the figures of the program"
}

check_page_and_site() {
    tar -xzf "$(only "echomarch-page-$version.tar.gz")" -C "$scratch"
    tar -xzf "$(only "echomarch-site-$version.tar.gz")" -C "$scratch"
    local page="$scratch/echomarch-page-$version" site="$scratch/echomarch-site-$version" file
    for file in index.html page.js style.css ears.js mix.js worklet.js pkg/echomarch_browser.js; do
        [[ -s "$page/$file" && -s "$site/page/$file" ]] || fail "the page lacks $file"
    done
    [[ "$(head -c 4 "$page/pkg/echomarch_browser_bg.wasm" | od -An -tx1)" == " 00 61 73 6d" ]] || fail "no wasm"
    for file in index python python-api program listen docs/shadertoy docs/scene-format; do
        [[ -s "$site/$file.html" ]] || fail "the site lacks $file.html"
    done
    local sound
    for sound in pillar closing-door whispering-gallery cave; do
        python3 scripts/release/check_sound.py "$site/sounds/$sound.wav"
    done
    run python3 scripts/site/check_links.py "$site"
}

check_tutorials() {
    # A tutorial plots.
    if ! "$python" -m pip install --quiet --disable-pip-version-check "$(only 'echomarch-*.whl')[plot]"; then
        fail "matplotlib cannot be installed"
    fi
    PATH="$program:$PATH" run python3 scripts/site/run_commands.py --in "$scratch/tutorials" --python "$python" \
        docs/site/python.md docs/site/program.md
}

check_crates() {
    local crate name
    for name in echomarch echomarch-lab echomarch-walk echomarch-window echomarch-cli; do
        crate="$OUT/crates/$name-$version.crate"
        tar -tzf "$crate" >"$scratch/files"
        for file in Cargo.toml README.md; do
            grep -qxF "$name-$version/$file" "$scratch/files" || fail "$crate lacks $file"
        done
    done
    say "crates: five packages of version $version"
}

version="$(basename "$OUT"/crates/echomarch-cli-*.crate .crate)"
version="${version#echomarch-cli-}"
(cd "$OUT" && sha256sum --quiet --check SHA256SUMS)
listed="$(wc -l <"$OUT/SHA256SUMS")"
present="$(find "$OUT" -type f ! -name SHA256SUMS | wc -l)"
[[ "$listed" == "$present" ]] || fail "SHA256SUMS lists $listed of $present files"
say "checksums: $listed files"
check_archive
check_debian_package
check_wheel
check_page_and_site
check_tutorials
check_crates
say "the release works"
