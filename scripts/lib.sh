# Functions shared by the scripts in this folder. Source this file from bash.
# shellcheck shell=bash

# The requirement, the Debian package that provides it, and its purpose.
#   requirement           package           purpose
readonly -a NEEDED=(
    "command:cc           gcc               links Rust programs"
    "start:crt1.o         libc6-dev         the C library to link against"
    "libEGL.so.1          libegl1           finds the graphics devices without a window"
    "libEGL_mesa.so.0     libegl-mesa0      Mesa's EGL, for the renderer below"
    "dri:swrast           libgl1-mesa-dri   the drivers, including the software renderer llvmpipe"
    "libOSMesa.so.8       libosmesa6        OpenGL in memory, without EGL (--gl osmesa)"
    "libasound.so.2       libasound2        sound cards"
    "file:/usr/include/alsa/asoundlib.h libasound2-dev links with the sound cards' library"
    "command:pkg-config   pkg-config        finds the sound cards' library"
    "command:python3      python3           checks imports, and writes reports"
    "libX11.so.6          libx11-6          the window (echomarch demo): the display"
    "libX11-xcb.so.1      libx11-xcb1       the window: the display, through XCB"
    "libXcursor.so.1      libxcursor1       the window: the mouse cursor"
    "libXi.so.6           libxi6            the window: the mouse's movement"
    "libxkbcommon-x11.so.0 libxkbcommon-x11-0 the window: the keyboard"
)

# Needed only by the tests: a sound server that plays to a file, a browser, a virtual display, and simulated key
# presses.
# shellcheck disable=SC2034 # Used by test.sh.
readonly -a NEEDED_TO_TEST=(
    "command:pulseaudio   pulseaudio        a sound server that needs no sound card"
    "command:parec        pulseaudio-utils  records the sound server's output"
    "command:chromium     chromium          fills in the localisation form"
    "command:chromedriver chromium-driver   controls Chromium"
    "command:Xvfb         xvfb              a virtual display, for the window"
    "command:xdotool      xdotool           presses the window's keys"
    "command:sox          sox               reads written WAV files"
    "python:ensurepip     python3-venv      a clean environment for the Python package"
    "icd:lvp              mesa-vulkan-drivers Vulkan in software, for another OpenGL (zink)"
)

say() {
    printf '%s\n' "$*"
}

complain() {
    printf '%s\n' "$*" >&2
}

# Prints the usage ($1) if the first option is -h or --help, and rejects every other option.
take_no_options() {
    case "${2:-}" in
    "") ;;
    -h | --help)
        say "$1"
        exit 0
        ;;
    *)
        complain "$1"
        exit 2
        ;;
    esac
}

# Whether the loader finds the library $1.
has_library() {
    local cache
    # ldconfig lives in /sbin, which is not in every user's PATH.
    cache="$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null || true)"
    grep -qF "$1 " <<<"$cache"
}

# Whether Mesa's drivers are installed; the loader's cache does not list them.
has_dri_driver() {
    local file
    for file in /usr/lib/dri/"$1"_dri.so /usr/lib64/dri/"$1"_dri.so \
        /usr/lib/*/dri/"$1"_dri.so /usr/lib/libgallium*.so \
        /usr/lib64/libgallium*.so /usr/lib/*/libgallium*.so; do
        [[ -e "$file" ]] && return 0
    done
    return 1
}

# Whether Vulkan has the driver $1.
has_vulkan_driver() {
    local file
    for file in /usr/share/vulkan/icd.d/"$1"_icd*.json; do
        [[ -e "$file" ]] && return 0
    done
    return 1
}

# Whether the C library's start-up code is installed, so that programs can be linked.
has_start_code() {
    local file
    for file in /usr/lib/"$1" /usr/lib64/"$1" /usr/lib/*/"$1"; do
        [[ -e "$file" ]] && return 0
    done
    return 1
}

is_there() {
    case "$1" in
    command:*) command -v "${1#command:}" >/dev/null ;;
    file:*) [[ -e "${1#file:}" ]] ;;
    python:*) python3 -c "import ${1#python:}" 2>/dev/null ;;
    start:*) has_start_code "${1#start:}" ;;
    dri:*) has_dri_driver "${1#dri:}" ;;
    icd:*) has_vulkan_driver "${1#icd:}" ;;
    *) has_library "$1" ;;
    esac
}

# Installs packages with apt-get, as root or with sudo.
install_packages() {
    local -a as_root=()
    if [[ "$(id -u)" != 0 ]]; then
        if ! command -v sudo >/dev/null; then
            complain "Not root, and no sudo: please install: $*"
            return 1
        fi
        as_root=(sudo)
    fi
    "${as_root[@]}" apt-get update
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y --no-install-recommends "$@"
}

# Installs the missing packages that are needed to build, for OpenGL without a window, and for sound, and the packages
# of the given lines, which have the form of the list at the top.
provide_packages() {
    local -a needed=("${NEEDED[@]}" "$@") missing=()
    local entry library package purpose
    for entry in "${needed[@]}"; do
        read -r library package purpose <<<"$entry"
        if ! is_there "$library"; then
            say "missing: $package ($purpose)"
            missing+=("$package")
        fi
    done
    if ((${#missing[@]} == 0)); then
        say "Debian packages: all are installed"
        return 0
    fi
    if ! command -v apt-get >/dev/null; then
        complain "This is not Debian. If a step below fails, install the contents of these Debian packages,"
        complain "then run the script again: ${missing[*]}"
        return 0
    fi
    say "installing: ${missing[*]}"
    # A graphics card with its own driver works without some of these packages, so a failure is not fatal.
    install_packages "${missing[@]}" || complain "some packages are not installed; continuing without: ${missing[*]}"
}

# The command that installs a cargo subcommand.
how_to_install_cargo() {
    case "$1" in
        deb | deny | mutants) echo "cargo install --locked cargo-$1" ;;
        *) echo "rustup component add rustfmt clippy" ;;
    esac
}

# Fails unless cargo and the named cargo subcommands are installed.
need_cargo() {
    if ! command -v cargo >/dev/null; then
        complain "cargo is missing: install Rust 1.95 or later from https://rustup.rs"
        return 1
    fi
    local command
    for command in "$@"; do
        if ! cargo "$command" --help >/dev/null 2>&1; then
            complain "cargo $command is missing: $(how_to_install_cargo "$command")"
            return 1
        fi
    done
    cargo --version
}

# Packs the folder $2 of the folder $1 as the file $3. All files have the time of the last commit, so that equal contents
# give equal archives.
pack() {
    local moment
    moment="$(git log -1 --format=%ct 2>/dev/null || echo 0)"
    tar -C "$1" --sort=name --mtime="@$moment" --owner=0 --group=0 --numeric-owner -cf - "$2" | gzip -9n >"$3"
}

# Prints a command, then runs it.
run() {
    printf '\n$ %s\n' "$*"
    "$@"
}

# Whether $1 is one of the words in $2.
is_among() {
    [[ "$1" != *" "* && " $2 " == *" $1 "* ]]
}

# Parses the arguments of a measuring script: sets `options` to the options for its Python module, and `program` to the
# program in ECHOMARCH, if set. $1 and $2 list the options without and with a value, separated by spaces; -o FILE is
# always accepted. The remaining parameters are the arguments. Relative file names refer to the caller's folder.
take_measuring_options() {
    local flags="$1" valued="$2"
    shift 2
    options=()
    program="${ECHOMARCH:+$(realpath "$ECHOMARCH")}"
    while (($#)); do
        if [[ "$1" == -h || "$1" == --help ]]; then
            usage
            exit 0
        elif is_among "$1" "$flags"; then
            options+=("$1")
        elif is_among "$1" "$valued"; then
            options+=("$1" "${2:?"$1 needs a value"}")
            shift
        elif [[ "$1" == -o ]]; then
            options+=(-o "$(realpath -m "${2:?"-o needs a value"}")")
            shift
        else
            usage >&2
            exit 2
        fi
        shift
    done
}

# Builds the program to measure, without sound and window, and sets `program` to it.
# shellcheck disable=SC2034 # Used by the scripts.
build_program() {
    need_cargo build
    run cargo build --release --locked -p echomarch-cli --no-default-features
    program="$(realpath "${CARGO_TARGET_DIR:-target}")/release/echomarch"
}
