#!/bin/bash
# Installs the program into a folder of its own and uses what a desktop, a shell and 3D Slicer use of it.
#   use_installed.sh CMAKE BUILD_FOLDER
set -euo pipefail
cmake=$1 build=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cmake" --install "$build" --prefix "$folder" --component Unspecified >/dev/null
fail() { echo "$*"; exit 1; }

cd "$folder"
bin/limber --version | grep -qE '^[0-9]+\.[0-9]+\.[0-9]+' || fail "no version"
bin/limber phantom arm --spacing 6 -o arm >/dev/null
bin/limber info arm/volume.nrrd | grep -q 'NRRD' || fail "the installed reader does not read"

# The shell's completion.
source share/bash-completion/completions/limber
completed() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _limber "$folder/bin/limber"; printf '%s\n' "${COMPREPLY[@]}"; }
completed limber resa | grep -qx resample || fail "a command is not completed"
completed limber resample --fle | grep -qx -- --flex || fail "an option is not completed"
completed limber info arm/vol | grep -qx arm/volume.nrrd || fail "a file is not completed"

# Pages of the manual, one a command, which say what --help says.
for page in limber limber-resample limber-fit-rig; do
  grep -q '^\.SH DESCRIPTION' "share/man/man1/$page.1" || fail "no page $page"
  if command -v man >/dev/null; then
    LC_ALL=C man --warnings -E UTF-8 -l "share/man/man1/$page.1" >page.txt 2>warnings.txt
    [ ! -s warnings.txt ] || { cat warnings.txt; fail "the page $page is malformed"; }
  fi
done
[ "$(ls share/man/man1 | wc -l)" -eq "$(($(ls lib/limber/slicer | wc -l) + 1))" ] || fail "not a page a command"

# Modules of 3D Slicer, also behind a link.
ln -s lib/limber/slicer/limber-info linked
./linked --xml | grep -q '<executable>' || fail "a module of Slicer does not describe itself"
for module in lib/limber/slicer/limber-*; do
  [ "$("$module" --xml | head -c 5)" = '<?xml' ] || fail "$module does not describe itself"
done

# The desktop's files.
if command -v desktop-file-validate >/dev/null; then desktop-file-validate share/applications/limber.desktop; fi
if command -v xmllint >/dev/null; then xmllint --noout share/mime/packages/limber.xml share/icons/hicolor/scalable/apps/limber.svg; fi
echo "the installed program works"
