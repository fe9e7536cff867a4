#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Computes a batch with GNU parallel, on this machine or on those of --sshlogin, then writes the tables:
#   parallel.sh BATCH.json OUT --jobs 8
#   parallel.sh BATCH.json OUT --sshlogin node1,node2 --workdir .
# Run the same again after any failure: finished cells are kept.
set -euo pipefail
batch=$1 out=$2 limber=${LIMBER:-limber}
shift 2
"$limber" batch "$batch" -o "$out" --plan | awk -F'\t' '$2 == "missing" { print $1 }' |
  parallel "$@" "$limber" batch "$batch" -o "$out" --threads 1 --cells {} || true
exec "$limber" batch "$batch" -o "$out"
