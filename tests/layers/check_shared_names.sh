#!/usr/bin/env bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# check_shared_names.sh NM LIBRARY...: no name stands for functions of more than 8 sources, else it says nothing. Counted
# are free functions that other sources can call; members (of types, which begin with a capital) and operators are not.
set -euo pipefail
nm=$1
shift
"$nm" -C -A --defined-only "$@" 2>/dev/null | awk '
  $2 == "T" {
    split($1, place, ":")
    source = place[2]
    name = $0
    sub(/^[^ ]+ T /, "", name)
    if (name !~ /^limber::/ || name ~ /operator/) next
    sub(/[(<[].*/, "", name)
    if (name ~ /::[A-Z][A-Za-z0-9]*::/) next
    sub(/.*::/, "", name)
    if (!((name, source) in seen)) {
      seen[name, source] = 1
      sources[name] = sources[name] " " source
      ++count[name]
      ++all
    }
  }
  END {
    for (name in count)
      if (count[name] > 8) {
        printf "%s: %d sources:%s\n", name, count[name], sources[name]
        bad = 1
      }
    if (all < 1000) {
      print "only " all + 0 " functions were found: is NM the one of the compiler?"
      bad = 1
    }
    exit bad
  }'
