#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Runs the editor in a real window of a virtual display. Checks that it starts, survives a click, a drag and keys, uses
# nearly no processor time at rest, and quits with exit code 0.
#   usage: window_smoke.sh PROGRAM
# If Xvfb or xdotool is not installed, prints a line and ends with exit code 77 (skipped).
set -euo pipefail
program=$1
for tool in Xvfb xdotool; do
  command -v "$tool" >/dev/null || { echo "SKIPPED: $tool is not installed"; exit 77; }
done

work=$(mktemp -d)
server= editor=
finish() {
  [ -z "$editor" ] || kill "$editor" 2>/dev/null || true
  [ -z "$server" ] || kill "$server" 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT
fail() { echo "FAILED: $*"; sed 's/^/  editor: /' "$work/log"; exit 1; }

# Without a display, the editor must print one line and fail.
if env -u DISPLAY -u WAYLAND_DISPLAY "$program" 2>"$work/log"; then fail "it should refuse to start without a display"; fi
[ "$(wc -l <"$work/log")" = 1 ] || fail "one line should say that there is no display"

Xvfb -displayfd 3 -screen 0 1280x800x24 3>"$work/display" >/dev/null 2>&1 &
server=$!
for _ in $(seq 100); do [ -s "$work/display" ] && break; sleep 0.1; done
export DISPLAY=:$(cat "$work/display") HOME=$work XDG_CONFIG_HOME=$work XDG_STATE_HOME=$work XDG_CACHE_HOME=$work XDG_DATA_HOME=$work

"$program" >"$work/log" 2>&1 &
editor=$!
window=$(timeout 60 xdotool search --sync --onlyvisible --class limber | head -1) || fail "no window appears"
alive() { kill -0 "$editor" 2>/dev/null || fail "it ended by itself $1"; }

at() { xdotool mousemove --window "$window" "$1" "$2"; sleep 0.2; }
sleep 2
alive "at the start"
xdotool key --window "$window" Escape
at 140 54; xdotool click 1                              # tool header: X-ray or its neighbour
at 500 400; xdotool mousedown 2; at 600 430; xdotool mouseup 2  # turns the view
xdotool click 4                                        # wheel
xdotool key ctrl+alt+q; sleep 0.3                       # four views
xdotool key Num_Lock; xdotool key KP_1; xdotool key n; xdotool key n
sleep 0.5
alive "after a click, a drag and keys"

# Prints the editor's user and system time, hundredths of a second, to measure it at rest.
ticks() { awk '{print $14 + $15}' "/proc/$editor/stat"; }
for _ in $(seq 60); do
  before=$(ticks); sleep 1
  [ $(($(ticks) - before)) -le 1 ] && break
done
before=$(ticks); sleep 3
used=$(($(ticks) - before))
[ "$used" -le 3 ] || fail "at rest it uses the processor: $used hundredths of a second in 3 s"

xdotool key ctrl+q
for _ in $(seq 100); do kill -0 "$editor" 2>/dev/null || break; sleep 0.1; done
kill -0 "$editor" 2>/dev/null && fail "Ctrl+Q does not end it"
code=0
wait "$editor" || code=$?
editor=
[ "$code" = 0 ] || fail "exit code $code"
echo "the editor started, took a click, a drag and keys, rested ($used ticks in 3 s) and quit"
