#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs two builds of geometry_bits and fails where their output differs.
# usage: same_bits_test.sh programs A B
#        same_bits_test.sh compiler A COMPILER CMAKE BUILD_DIR   B is built by COMPILER at -O2; skipped where it is absent
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
first=$2 second=$3

if [[ $1 == compiler ]]; then
    compiler=$3 cmake=$4 build=$5
    if ! command -v "$compiler" >/dev/null; then
        echo "skipped: $compiler is not installed"
        exit 77
    fi
    "$cmake" -S "$root" -B "$build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
        -DFLOTILLA_BUILD_BENCH=OFF >/dev/null
    "$cmake" --build "$build" --target geometry_bits_O2
    second=$build/tests/determinism/geometry_bits_O2
fi
output=$("$first")
printf '%s\n' "$output"
diff <(printf '%s\n' "$output") <("$second")
