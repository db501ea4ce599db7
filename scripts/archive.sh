#!/usr/bin/env bash
# Builds the program, its manuals and its completions, and packs them.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/archive.sh [-o DIR]

Builds the program and packs it with manuals, completions, licences and scenes as DIR/echomarch-VERSION-TARGET.tar.gz
(default DIR: target). The manuals and completions are also in target/release/share, for the Debian package.

The program is linked with the C library and the sound library of this system, because OpenGL is loaded at run time,
which a static program cannot do. INSTALL.md in the archive states what it needs.
END
}

out=target
while (($#)); do
    case "$1" in
    -h | --help)
        usage
        exit 0
        ;;
    -o)
        out="${2:?"-o needs a folder"}"
        shift
        ;;
    *)
        usage >&2
        exit 2
        ;;
    esac
    shift
done
mkdir -p "$out"
out="$(cd "$out" && pwd)"

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

BUILT="${CARGO_TARGET_DIR:-target}/release"
readonly SHARE="$BUILT/share"

# The newest version of glibc that the program needs.
glibc() {
    grep -aoE 'GLIBC_2\.[0-9]+' "$1" | sed 's/GLIBC_//' | sort -Vu | tail -n 1
}

need_cargo build
run cargo build --release --locked -p echomarch-cli
program="$BUILT/echomarch"
[[ -e "$program" ]] || program="$BUILT/echomarch.exe"
rm -rf "$SHARE"
mkdir -p "$SHARE"/{man/man1,bash-completion/completions,fish/vendor_completions.d,zsh/vendor-completions}
"$program" man -o "$SHARE/man/man1"
"$program" completions bash >"$SHARE/bash-completion/completions/echomarch"
"$program" completions fish >"$SHARE/fish/vendor_completions.d/echomarch.fish"
"$program" completions zsh >"$SHARE/zsh/vendor-completions/_echomarch"

version="$("$program" --version)"
target="$(rustc -vV | sed -n 's/^host: //p')"
name="echomarch-${version#echomarch }-$target"
stage="$(mktemp -d)"
trap 'rm -rf -- "$stage"' EXIT
mkdir -p "$stage/$name/bin" "$stage/$name/examples"
cp "$program" "$stage/$name/bin"
cp -R "$SHARE" LICENSE-MIT LICENSE-APACHE CHANGELOG.md "$stage/$name"
cp -R examples/scenes "$stage/$name/examples"
if [[ "$target" == *-linux-gnu ]]; then
    sed "s/GLIBC/$(glibc "$program")/" packaging/INSTALL.md >"$stage/$name/INSTALL.md"
else
    sed '/^## On Linux$/,$d' packaging/INSTALL.md >"$stage/$name/INSTALL.md"
fi
pack "$stage" "$name" "$out/$name.tar.gz"
say "$out/$name.tar.gz"
