#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Plants headers that do not compile alone in a copy of the sources and expects the header check to refuse them.
# usage: header_check_test.sh CMAKE COMPILER
set -euo pipefail
cmake=$1 compiler=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT

cp -r "$root"/{CMakeLists.txt,LICENSE,include,src,scripts,tests,bench} "$copy"
cat >"$copy/src/base/planted.hpp" <<'TEXT'
#pragma once
inline std::vector<int> planted() { return {}; }
TEXT
cp "$copy/src/base/planted.hpp" "$copy/include/flotilla/planted.hpp"
sed -i 's|FILES$|& flotilla/planted.hpp|' "$copy/include/CMakeLists.txt"
"$cmake" -S "$copy" -B "$copy/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DFLOTILLA_BUILD_BENCH=OFF >/dev/null

# expect STATUS TARGET: building one object ends so.
expect() {
    local status=0 output
    output=$("$cmake" --build "$copy/build" --target "$2" 2>&1) || status=1
    if ((status != $1)); then
        printf 'expected exit code %s of %s:\n%s\n' "$1" "$2" "$output"
        exit 1
    fi
    if ((status == 1)) && ! grep -q 'planted.hpp:2:.*error' <<<"$output"; then
        printf 'failed for another reason:\n%s\n' "$output"
        exit 1
    fi
}
objects=tests/CMakeFiles/flotilla_header_check.dir/__/header_check
expect 0 "$objects/base_vec3_hpp.cpp.o"
expect 1 "$objects/base_planted_hpp.cpp.o"
expect 1 flotilla_verify_interface_header_sets
