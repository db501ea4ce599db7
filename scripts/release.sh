#!/usr/bin/env bash
# Builds everything that a release consists of, up to the point of upload, and tests it.
set -euo pipefail

usage() {
    cat <<'END'
usage: scripts/release.sh [--tag TAG] [--no-verify] OUT

Builds the release in the folder OUT, which must be new or empty: the packages for crates.io, the program as an archive
and as a Debian package, the Python wheel, the page, the site, the release notes, and SHA256SUMS. Then it runs
scripts/release-test.sh. Nothing is uploaded. docs/release.md lists the files.

  --tag TAG    fails unless TAG names the version of the packages, and CHANGELOG.md has a section for it
  --no-verify  does not compile the packages for crates.io

  cargo deb makes the Debian package (cargo install --locked cargo-deb). podman or docker builds the container; without
  them it is left out. cargo semver-checks compares the library with the last tag, if both exist.
END
}

tag=""
verify=true
out=""
while (($#)); do
    case "$1" in
    -h | --help)
        usage
        exit 0
        ;;
    --tag)
        tag="${2:?"--tag needs a tag"}"
        shift
        ;;
    --no-verify) verify=false ;;
    -*)
        usage >&2
        exit 2
        ;;
    *) out="$(realpath -m "$1")" ;;
    esac
    shift
done
if [[ -z "$out" ]]; then
    usage >&2
    exit 2
fi

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh

readonly -a PUBLISHED=(echomarch echomarch-lab echomarch-walk echomarch-window echomarch-cli)
built="$(realpath -m "${CARGO_TARGET_DIR:-target}")"
readonly BUILT="$built/release"
version="$(cargo metadata --locked --no-deps --format-version 1 |
    python3 -c 'import json, sys; print(next(p["version"] for p in json.load(sys.stdin)["packages"] if p["name"] == "echomarch-cli"))')"

if [[ -e "$out" && -n "$(ls -A "$out")" ]]; then
    complain "$out is not empty: name a new or an empty folder"
    exit 2
fi
mkdir -p "$out"

# The section of CHANGELOG.md about this version; the unreleased one if there is none yet.
release_notes() {
    local heading="## [$version]"
    grep -qF "$heading" CHANGELOG.md || heading="## [Unreleased]"
    awk -v heading="$heading" '
        index($0, "## [") == 1 { inside = index($0, heading) == 1 }
        inside' CHANGELOG.md
}

check_versions() {
    local package
    for package in "${PUBLISHED[@]:0:4}"; do
        if ! grep -qE "^$package = .*version = \"$version\"" Cargo.toml; then
            complain "Cargo.toml: [workspace.dependencies] does not name $package with the version $version"
            return 1
        fi
    done
    if [[ -n "$tag" && "$tag" != "v$version" ]]; then
        complain "the tag is $tag, but the packages have the version $version"
        return 1
    fi
    if [[ -n "$tag" ]] && ! grep -qF "## [$version]" CHANGELOG.md; then
        complain "CHANGELOG.md has no section [$version]: rename [Unreleased]"
        return 1
    fi
    release_notes >"$out/release-notes.md"
    if [[ ! -s "$out/release-notes.md" ]]; then
        complain "CHANGELOG.md has neither a section [$version] nor [Unreleased]"
        return 1
    fi
}

# Compares the interface of the library with the last tag.
check_interface() {
    local last
    last="$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null || true)"
    if [[ -z "$last" || "$last" == "${tag:-none}" ]]; then
        say "the interface is not compared: there is no earlier tag"
    elif cargo semver-checks --version >/dev/null 2>&1; then
        run cargo semver-checks --package echomarch --baseline-rev "$last"
    else
        complain "the interface is not compared with $last: cargo install --locked cargo-semver-checks"
    fi
}

make_crates() {
    local package made folder
    local -a options=(--locked --allow-dirty)
    for package in "${PUBLISHED[@]}"; do
        options+=(-p "$package")
    done
    "$verify" || options+=(--no-verify)
    # A folder of its own: cargo keeps the packages of a folder from run to run, and would verify those of an earlier run.
    mkdir -p "$built"
    folder="$(mktemp -d "$built/publish.XXXXXX")"
    # shellcheck disable=SC2064
    trap "rm -rf '$folder'" EXIT
    run cargo publish --dry-run --target-dir "$folder" "${options[@]}"
    mkdir -p "$out/crates"
    for package in "${PUBLISHED[@]}"; do
        # Cargo's versions leave the packages in different folders below this one.
        made="$(find "$folder/package" -name "$package-$version.crate" -print -quit)"
        if [[ -z "$made" ]]; then
            complain "cargo publish has left no $package-$version.crate below $folder/package"
            return 1
        fi
        cp "$made" "$out/crates"
    done
    rm -rf "$folder"
}

make_debian_package() {
    if ! cargo deb --version >/dev/null 2>&1; then
        complain "the Debian package is left out: $(how_to_install_cargo deb)"
        return 1
    fi
    run cargo deb --no-build --locked -p echomarch-cli -o "$out/"
}

make_page_and_site() {
    rm -rf target/release-site
    mkdir -p target/release-site
    run scripts/browser.sh -o "$PWD/target/page"
    cp -R target/page "target/release-site/echomarch-page-$version"
    pack target/release-site "echomarch-page-$version" "$out/echomarch-page-$version.tar.gz"
    ECHOMARCH="$BUILT/echomarch" run scripts/site.sh --page target/page \
        -o "$PWD/target/release-site/echomarch-site-$version"
    pack target/release-site "echomarch-site-$version" "$out/echomarch-site-$version.tar.gz"
    rm -rf target/release-site
}

# Builds the container from the Debian package, to test it. It is not a file of the release.
try_container() {
    local builder
    for builder in podman docker; do
        if command -v "$builder" >/dev/null && "$builder" info >/dev/null 2>&1; then
            run "$builder" build -f packaging/Containerfile -t "echomarch:$version" "$out"
            return
        fi
    done
    say "the container is not built: neither podman nor docker runs here"
}

need_cargo build
check_versions
check_interface
run scripts/archive.sh -o "$out"
make_debian_package
run scripts/wheel.sh -o "$out"
make_page_and_site
make_crates
cp packaging/Containerfile "$out"
try_container
(cd "$out" && find . -type f ! -name SHA256SUMS -printf '%P\n' | LC_ALL=C sort | xargs -d '\n' sha256sum >SHA256SUMS)
run scripts/release-test.sh "$out"
say
say "$out:"
(cd "$out" && du -ah --apparent-size . | sort -k2)
say
say "the release is complete; upload: docs/release.md"
