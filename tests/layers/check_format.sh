#!/bin/sh
# Fails if clang-format 14 would change a source file. Skipped with other versions, which format differently.
#   check_format.sh CLANG_FORMAT
set -eu
cd "$(dirname "$0")/../.."
"$1" --version | grep -q 'version 14' || { echo "SKIPPED: $("$1" --version)"; exit 77; }
find core render editor tests \( -name '*.h' -o -name '*.cpp' \) -print0 | xargs -0 -P 2 -n 50 "$1" --dry-run --Werror
