#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Starts the editor as a desktop does, from its menu entry, in a window of a virtual display; saves a picture of the display
# and ends the editor by Ctrl+Q.
#   start_from_menu.sh ENTRY PICTURE.png [FILE]
# ENTRY is the path of a .desktop file, FILE what is opened with it. GLib's `gio launch` reads the entry.
set -euo pipefail
entry=$1 picture=$2
shift 2
for tool in Xvfb xdotool gio xprop import identify compare; do
  command -v "$tool" >/dev/null || { echo "SKIPPED: the editor is started from its menu entry: $tool is not installed"; exit 0; }
done

work=$(mktemp -d)
server=
finish() {
  [ -z "$server" ] || kill "$server" 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT
fail() { echo "FAILED: $*"; sed 's/^/  editor: /' "$work/log"; exit 1; }
: >"$work/log"

Xvfb -displayfd 3 -screen 0 1920x1080x24 3>"$work/display" >/dev/null 2>&1 &
server=$!
for _ in $(seq 100); do [ -s "$work/display" ] && break; sleep 0.1; done
export DISPLAY=:$(cat "$work/display")
export XDG_CONFIG_HOME=$work/config XDG_STATE_HOME=$work/state XDG_CACHE_HOME=$work/cache

start=$(date +%s%N)
gio launch "$entry" "$@" >"$work/log" 2>&1 || fail "gio launch refuses $entry"
window=$(timeout 60 xdotool search --sync --onlyvisible --class limber | head -1) || fail "no window appears"
echo "a window after $((($(date +%s%N) - start) / 1000000)) ms"

# Desktops find the menu entry, and thus the icon, of a window by this name.
expected=$(sed -n 's/^StartupWMClass=//p' "$entry")
found=$(xprop -id "$window" WM_CLASS | sed -n 's/.*, "\(.*\)"$/\1/p')
[ "$found" = "$expected" ] || fail "the window's class is $found, the entry says $expected"

# Saves the picture of the display when it has not changed for five seconds and has more than a few colours.
same=0 colours=0
import -window root "$picture"
for _ in $(seq 90); do
  sleep 1
  import -window root "$work/next.png"
  if compare -metric AE "$work/next.png" "$picture" null: 2>/dev/null; then same=$((same + 1)); else same=0; fi
  mv "$work/next.png" "$picture"
  colours=$(identify -format %k "$picture")
  if [ "$same" -ge 5 ] && [ "$colours" -gt 100 ]; then break; fi
done
[ "$colours" -gt 100 ] || fail "the display shows $colours colours only"

xdotool key --window "$window" Escape
sleep 0.5
xdotool key --window "$window" ctrl+q
for _ in $(seq 100); do
  xprop -id "$window" WM_CLASS >/dev/null 2>&1 || { echo "the editor started from $entry, and ended by Ctrl+Q"; exit 0; }
  sleep 0.1
done
fail "Ctrl+Q does not end it"
