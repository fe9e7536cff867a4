#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# check_shared_names.sh NM LIBRARY...: checks that no name is shared by more than 8 functions, since such a name says
# nothing. Counts free functions that other sources can call, but no members (of types, whose names begin with a
# capital) or operators.
set -euo pipefail
nm=$1
shift
"$nm" -C -A --defined-only "$@" 2>/dev/null | awk '
  $2 == "T" {
    name = $0
    sub(/^[^ ]+ T /, "", name)
    whole = name
    if (name !~ /^limber::/ || name ~ /operator/) next
    sub(/[(<[].*/, "", name)
    if (name ~ /::[A-Z][A-Za-z0-9]*::/) next
    sub(/.*::/, "", name)
    if (!(whole in seen)) {
      seen[whole] = 1
      functions[name] = functions[name] "\n  " whole
      ++count[name]
      ++all
    }
  }
  END {
    for (name in count)
      if (count[name] > 8) {
        printf "%s: %d functions:%s\n", name, count[name], functions[name]
        bad = 1
      }
    if (all < 1000) {
      print "only " all + 0 " functions were found: is NM the one of the compiler?"
      bad = 1
    }
    exit bad
  }'
