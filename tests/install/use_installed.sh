#!/bin/bash
# Installs the program into a temporary folder, and checks the parts that a desktop, a shell and 3D Slicer use.
#   use_installed.sh CMAKE BUILD_FOLDER
set -euo pipefail
cmake=$1 build=$2
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cmake" --install "$build" --prefix "$folder" --component Unspecified >/dev/null
fail() { echo "$*"; exit 1; }

cd "$folder"
bin/limber --version | grep -qE '^[0-9]+\.[0-9]+\.[0-9]+' || fail "no version"
bin/limber phantom arm --spacing 6 -o arm >/dev/null
bin/limber info arm/volume.nrrd | grep -q 'NRRD' || fail "the installed reader does not read"

# The commands must also run on a cluster's nodes, on which no libraries for windows and graphics are installed.
for program in bin/limber lib/limber/limber_reader; do
  if ldd "$program" | grep -E 'libX|libxcb|libwayland|libGL'; then fail "$program needs a display's libraries"; fi
done

# Checks that bash completes the names of commands, options and files.
source share/bash-completion/completions/limber
completed() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _limber "$folder/bin/limber"; printf '%s\n' "${COMPREPLY[@]}"; }
completed limber resa | grep -qx resample || fail "a command is not completed"
completed limber resample --fle | grep -qx -- --flex || fail "an option is not completed"
completed limber info arm/vol | grep -qx arm/volume.nrrd || fail "a file is not completed"

# Checks the manual pages: there is one for each command, and three of them have no errors of markup.
for page in limber limber-resample limber-fit-rig; do
  grep -q '^\.SH DESCRIPTION' "share/man/man1/$page.1" || fail "no page $page"
  if command -v man >/dev/null; then
    LC_ALL=C man --warnings -E UTF-8 -l "share/man/man1/$page.1" >page.txt 2>warnings.txt
    [ ! -s warnings.txt ] || { cat warnings.txt; fail "the page $page is malformed"; }
  fi
done
[ "$(ls share/man/man1 | wc -l)" -eq "$(($(ls lib/limber/slicer | wc -l) + 1))" ] || fail "not a page a command"

# Checks that the modules of 3D Slicer describe themselves, also if they are started by a symbolic link.
ln -s lib/limber/slicer/limber-info linked
./linked --xml | grep -q '<executable>' || fail "a module of Slicer does not describe itself"
for module in lib/limber/slicer/limber-*; do
  [ "$("$module" --xml | head -c 5)" = '<?xml' ] || fail "$module does not describe itself"
done

# Checks that the programs among the examples are installed as executable files.
programs=$(cd "$here/../../assets" && find . -type f -perm -u+x -not -path './desktop/*')
[ -n "$programs" ] || fail "no program among the assets"
for program in $programs; do [ -x "share/limber/$program" ] || fail "share/limber/$program cannot be run"; done

# Checks the files for the desktop: menu entry, file type and icon.
if command -v desktop-file-validate >/dev/null; then desktop-file-validate share/applications/limber.desktop; fi
if command -v xmllint >/dev/null; then xmllint --noout share/mime/packages/limber.xml share/icons/hicolor/scalable/apps/limber.svg; fi

# Checks the menu entry of an unpacked archive. The folder's name has characters that a shell, sed or menu entries
# replace if they are not escaped.
mkdir home
archive="$folder/an \$unpacked & \"odd\" \`one\` | \\n"
mkdir "$archive"
cp -r bin lib share "$archive"
cp "$here/../../assets/desktop/add-to-menu" "$archive"
export HOME=$folder/home XDG_DATA_HOME=$folder/home/data
"$archive/add-to-menu" >/dev/null
entry=$XDG_DATA_HOME/applications/limber.desktop
if command -v desktop-file-validate >/dev/null; then desktop-file-validate "$entry"; fi
"$here/start_from_menu.sh" "$entry" "$folder/menu.png" "$folder/arm/volume.nrrd"
"$archive/add-to-menu" --remove >/dev/null
[ -z "$(find "$XDG_DATA_HOME" -name 'limber.*')" ] || fail "something stays in the menu"
mv "$archive" "$folder/100%"
if "$folder/100%/add-to-menu" 2>warnings.txt; then fail "a path that no entry can name is taken"; fi
[ "$(wc -l <warnings.txt)" = 1 ] || fail "one line should say why"

# Without the module that opens windows, the editor prints one line, and the commands still run.
rm lib/limber/limber_window.so
if bin/limber 2>warnings.txt; then fail "there is a window without its module"; fi
[ "$(wc -l <warnings.txt)" = 1 ] || fail "one line should say that windows cannot be opened"
bin/limber info arm/volume.nrrd >/dev/null || fail "commands need the module that opens windows"
echo "the installed program works"
