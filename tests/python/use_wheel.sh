#!/bin/sh
# Makes a wheel without a network, installs it into a new virtual environment, and runs the tests in this environment.
#   use_wheel.sh PYTHON BUILD_FOLDER LIMBER
set -eu
python=$1 build=$2 limber=$3
here=$(cd "$(dirname "$0")" && pwd)
for part in pip venv wheel setuptools; do
  "$python" -c "import $part" 2>/dev/null || { echo "SKIPPED: a wheel is made and installed: python3-$part is not installed"; exit 0; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$build/python" "$folder/source"
"$python" -m pip wheel -q --no-build-isolation --no-index --no-deps "$folder/source" -w "$folder/wheels"
"$python" -m venv --system-site-packages "$folder/environment"
"$folder/environment/bin/python" -m pip install -q --no-index --no-deps "$folder"/wheels/limber-*.whl
cd "$here"
where=$("$folder/environment/bin/python" -c 'import limber; print(limber.__file__)')
case $where in "$folder"/environment/*) ;; *) echo "not the installed package: $where"; exit 1 ;; esac
LIMBER_PROGRAM=$limber "$folder/environment/bin/python" -B -m unittest test_volumes test_bodies.Bodies
echo "$(basename "$folder"/wheels/limber-*.whl) is installed and works"
