#!/usr/bin/env bash
# Runs the window for a long time with random key presses and mouse moves, on its own display and sound server,
# and prints the window's report: GL errors, late sound, memory, frame times.
set -euo pipefail

usage() {
    echo "usage: scripts/soak.sh [SECONDS (600)] [SEED (1)] [OPTION OF echomarch demo ...]"
}

case "${1:-}" in
-h | --help)
    usage
    exit 0
    ;;
esac
seconds="${1:-600}"
seed="${2:-1}"
shift $(($# < 2 ? $# : 2))
if ! [[ "$seconds" =~ ^[1-9][0-9]*$ && "$seed" =~ ^[0-9]+$ ]]; then
    usage >&2
    exit 2
fi

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
source scripts/lib.sh
for program in Xvfb xdotool pulseaudio pactl; do
    if ! is_there "command:$program"; then
        complain "$program is missing: scripts/test.sh installs all packages that the tests need"
        exit 1
    fi
done

cargo build --release --locked --quiet
program="$(realpath "${CARGO_TARGET_DIR:-target}")/release/echomarch"

folder="$(mktemp -d)"
children=()
clean_up() {
    ((${#children[@]} == 0)) || kill "${children[@]}" 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$folder"
}
trap clean_up EXIT

# A virtual display.
Xvfb -noreset -displayfd 3 -screen 0 1280x800x24 3>"$folder/display" 2>/dev/null &
children+=($!)
# A sound server without a sound card.
export HOME="$folder" XDG_RUNTIME_DIR="$folder" PULSE_SERVER="unix:$folder/native"
unset DBUS_SESSION_BUS_ADDRESS
pulseaudio -n --daemonize=no --exit-idle-time=-1 --use-pid-file=no --realtime=no \
    --high-priority=no -L "module-native-protocol-unix auth-anonymous=1 socket=$folder/native" \
    -L "module-null-sink rate=48000 channels=2 format=float32le norewinds=1" 2>/dev/null &
children+=($!)
for ((wait = 0; wait < 200; wait++)); do
    [[ -s "$folder/display" ]] && pactl info >/dev/null 2>&1 && break
    sleep 0.1
done
DISPLAY=":$(<"$folder/display")"
export DISPLAY

# Folder for saved files, removed at the end.
cd "$folder"
"$program" demo --json --seconds "$seconds" --sound noise "$@" >report.json &
demo=$!
children+=("$demo")
for ((wait = 0; wait < 600; wait++)); do
    window="$(xdotool search --name '^Echomarch$' 2>/dev/null | head -n 1)" || true
    [[ -n "$window" ]] && break
    sleep 0.1
done
xdotool windowfocus --sync "$window"

# Keys that are held, keys that are pressed once, clicks and moves; not Ctrl+Q.
held=(w a s d q e Left Right Up Down)
once=(1 2 3 4 5 6 7 8 f p n l m t h F1 Tab BackSpace Escape F5 bracketleft bracketright comma period
    minus equal)
RANDOM="$seed"
while kill -0 "$demo" 2>/dev/null; do
    case $((RANDOM % 8)) in
    0 | 1 | 2)
        key="${held[RANDOM % ${#held[@]}]}"
        xdotool keydown "$key" sleep "0.$((RANDOM % 9 + 1))" keyup "$key" || true
        ;;
    3 | 4) xdotool key "${once[RANDOM % ${#once[@]}]}" || true ;;
    5 | 6) xdotool mousemove_relative -- $((RANDOM % 201 - 100)) $((RANDOM % 121 - 60)) || true ;;
    7) xdotool mousemove $((300 + RANDOM % 360)) $((100 + RANDOM % 340)) click 1 || true ;;
    esac
    sleep 0.1
done
if ! wait "$demo"; then
    complain "the window ended with an error"
    exit 1
fi

# The pans are omitted: they make up most of the report and are not needed.
sed '/^  "pans": \[/,/^  \]/c\  "pans": []' report.json
