#!/bin/sh
# Installs the library into a temporary folder, builds a program outside the source tree with it, and checks that this
# program and the command line write the same posed volume.
#   use_installed.sh CMAKE BUILD_FOLDER LIMBER CXX
set -eu
cmake=$1 build=$2 limber=$3 compiler=$4
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cmake" --install "$build" --prefix "$folder/prefix" --component library >/dev/null
"$cmake" -S "$here" -B "$folder/bend" -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release >"$folder/log" 2>&1 ||
  { cat "$folder/log"; exit 1; }
"$cmake" --build "$folder/bend" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
cd "$folder"
"$limber" phantom arm --spacing 4 -o arm >/dev/null
bend/bend arm/volume.nrrd arm/tissues.json arm/rig.json Forearm 60 library.nrrd
"$limber" weights arm/volume.nrrd --tissues arm/tissues.json --rig arm/rig.json -o weights.nrrd >/dev/null
"$limber" resample arm/volume.nrrd --tissues arm/tissues.json --rig arm/rig.json --weights weights.nrrd --flex Forearm=60 \
  --method dqs --seams none -o command.nrrd >/dev/null
cmp library.nrrd command.nrrd
echo "the library and the command line make the same bytes"
