#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Tests Limber's packages in fresh systems, step by step. Needs root, debootstrap, a network and, for all steps on
# two idle cores, about three quarters of an hour:
#   fresh_roots.sh FOLDER [STEP...]
# Each system is a Debian 12 root in FOLDER, made by debootstrap; the commit that is checked out here is cloned into it.
#   build     the clone's `./run package` installs what it needs and builds, in two roots; both make the same bytes
#   package   the Debian package is installed, the first posed picture drawn, the editor started from its menu entry
#   archive   the same with the archive, unpacked
#   python    `./run python` without a network; its wheel installed, and its tests run, in a root that has no compiler
# Roots are kept, so that they can be inspected, with nothing mounted in them. If a root exists already, its step stops.
set -euo pipefail
[ $# -ge 1 ] || { sed -n '3,11s/^# //p' "$0" >&2; exit 2; }
source=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
say() { printf '%s\n' "$*" >&2; }
fail() { say "FAILED: $*"; exit 1; }

# in_root ROOT COMMAND...: runs the command in the root, in its own mount namespace, so that only the command sees the
# mounted proc.
in_root() {
  local root=$folder/$1
  shift
  # shellcheck disable=SC2016
  unshare -m sh -c 'mount --make-rprivate / && mount -t proc proc "$0/proc" && exec chroot "$0" "$@"' "$root" \
    /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 bash -euc "$*"
}

# without_network ROOT COMMAND...: as in_root, but in a network namespace whose only interface, the loopback, is down.
without_network() { unshare -n bash -euc "$(declare -f in_root); folder=\$1; shift; in_root \"\$@\"" bash "$folder" "$@"; }

# new_root ROOT PACKAGE...: makes a root of a minimal Debian 12 with the PACKAGEs. Packages that were downloaded before
# come from FOLDER/cache.
new_root() {
  local root=$folder/$1
  shift
  [ ! -e "$root" ] || fail "$root is there already: remove it, or name another folder"
  mkdir -p "$folder/cache/apt"
  debootstrap --cache-dir="$folder/cache" --variant=minbase bookworm "$root" >"$root.log" 2>&1 || fail "see $root.log"
  cp /etc/apt/sources.list.d/*.sources "$root/etc/apt/sources.list.d/" 2>/dev/null || true
  cp /etc/apt/apt.conf.d/99* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
  cp /etc/hosts /etc/resolv.conf "$root/etc/"
  find "$folder/cache/apt" -name '*.deb' -exec cp -t "$root/var/cache/apt/archives" {} +
  echo 'force-unsafe-io' >"$root/etc/dpkg/dpkg.cfg.d/no-sync"
  in_root "${root##*/}" "apt-get update -q; DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $*" >>"$root.log" 2>&1
}
keep_packages() { find "$folder/$1/var/cache/apt/archives" -name '*.deb' -exec cp -n -t "$folder/cache/apt" {} +; }

clone_into() {
  git clone -q --bare "$source" "$folder/$1/root/limber.git"
  in_root "$1" "git clone -q /root/limber.git /root/limber"
}

# made PATTERN: prints the path of the package or archive that was built.
made() { find "$folder/one/root/limber/out/package" -name "$1"; }

build() {
  local root
  for root in one two; do
    new_root "$root" git ca-certificates
    clone_into "$root"
    say "Building in $folder/$root; see $root.log"
    SECONDS=0
    in_root "$root" "/root/limber/run package" >>"$folder/$root.log" 2>&1 || fail "see $folder/$root.log"
    say "./run package took $SECONDS s"
    keep_packages "$root"
  done
  (cd "$folder/one/root/limber/out/package" && sha256sum limber*) | tee "$folder/sums"
  (cd "$folder/two/root/limber/out/package" && sha256sum -c "$folder/sums") || fail "two roots made different bytes"
}

# pose ROOT LIMBER: makes a body and poses it by the program LIMBER.
# draw ROOT LIMBER: draws a picture of the posed body.
pose() {
  in_root "$1" "cd /root
    $2 --version
    $2 phantom arm --spacing 2 -o arm
    cd arm
    $2 weights volume.nrrd --rig rig.json --tissues tissues.json -o weights.nrrd
    $2 resample volume.nrrd --rig rig.json --tissues tissues.json --weights weights.nrrd --flex Forearm=90 -o bent.nrrd
    " >>"$folder/$1.log" 2>&1 || fail "see $folder/$1.log"
}
draw() {
  in_root "$1" "$2 render /root/arm/bent.nrrd --tissues /root/arm/tissues.json -o /root/arm/bent.png" >>"$folder/$1.log" 2>&1 ||
    fail "see $folder/$1.log"
}

# start_editor ROOT ENTRY: starts the editor from the menu entry ENTRY, with the body that pose() made.
start_editor() {
  in_root "$1" "apt-get install -y -q --no-install-recommends xvfb xdotool x11-utils imagemagick libglib2.0-bin" >>"$folder/$1.log" 2>&1
  cp "$source/tests/install/start_from_menu.sh" "$folder/$1/root"
  in_root "$1" "/root/start_from_menu.sh $2 /root/editor.png /root/arm/volume.nrrd" | tee "$folder/$1/root/editor.txt"
  grep -q "ended by Ctrl" "$folder/$1/root/editor.txt" || fail "the editor was not started"
  say "Look at $folder/$1/root/arm/bent.png and $folder/$1/root/editor.png"
}

package() {
  new_root package ca-certificates
  cp "$(made 'limber_*.deb')" "$folder/package/root"
  SECONDS=0
  in_root package "apt-get install -y -q /root/limber_*.deb" >>"$folder/package.log" 2>&1
  local installed=$SECONDS
  pose package limber
  draw package limber
  say "Installed in $installed s, first posed picture after $SECONDS s"
  [ "$SECONDS" -le 60 ] || fail "more than 60 s"
  start_editor package /usr/share/applications/limber.desktop
}

# Commands need nothing of the system but the C library; the picture and the window need its graphics driver.
archive() {
  new_root archive ca-certificates
  cp "$(made 'limber-*.tar.gz')" "$folder/archive/root"
  SECONDS=0
  in_root archive "cd /root && tar xzf limber-*.tar.gz && mv limber-*/ unpacked"
  pose archive /root/unpacked/bin/limber
  local posed=$SECONDS
  in_root archive "apt-get install -y -q --no-install-recommends libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri" >>"$folder/archive.log" 2>&1
  SECONDS=$posed
  draw archive /root/unpacked/bin/limber
  say "First posed picture after $SECONDS s"
  [ "$SECONDS" -le 60 ] || fail "more than 60 s"
  in_root archive "/root/unpacked/add-to-menu"
  start_editor archive /root/.local/share/applications/limber.desktop
}

# The packages that hold the libraries of the wheel's module and programs are those that the package of the program names.
python() {
  say "Building the Python module in $folder/two without a network; see $folder/two.log"
  SECONDS=0
  without_network two "/root/limber/run python" >>"$folder/two.log" 2>&1 || fail "see $folder/two.log"
  say "./run python took $SECONDS s"

  new_root python python3-venv python3-numpy python3-nibabel
  cp "$(made 'limber_*.deb')" "$folder"/two/root/limber/build/python/dist/limber-*.whl "$folder/python/root"
  mkdir "$folder/python/root/limber"
  git -C "$source" archive HEAD assets tests/python | tar -x -C "$folder/python/root/limber"
  in_root python "apt-get install -y -q --no-install-recommends /root/limber_*.deb" >>"$folder/python.log" 2>&1
  without_network python "python3 -m venv --system-site-packages /root/environment
    /root/environment/bin/python -m pip install --no-index /root/limber-*.whl
    cd /root/limber/tests/python
    LIMBER_PROGRAM=/usr/bin/limber /root/environment/bin/python -B -m unittest" >>"$folder/python.log" 2>&1 || fail "see $folder/python.log"
  tail -n 4 "$folder/python.log"
}

[ $# -gt 0 ] || set -- build package archive python
for step in "$@"; do
  case $step in
    build | package | archive | python) "$step" ;;
    *) fail "no step is called $step" ;;
  esac
done
