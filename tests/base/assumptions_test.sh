#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Compiles the check of the arithmetic as the library must not be compiled: each is refused, by the compiler or when it runs.
# usage: assumptions_test.sh COMPILER
set -euo pipefail
compiler=$1
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/main.cpp" <<'END'
#include <iostream>
#include "base/assumptions.hpp"
int main() { std::cout << flotilla::arithmetic_fault() << '\n'; }
END

fail() {
    echo "$*"
    exit 1
}
build() { "$compiler" -std=c++20 -O2 "-I$root/src" "$@" "$folder/main.cpp" "$root/src/base/assumptions.cpp" -o "$folder/program" 2>"$folder/log"; }

build -ffp-contract=off || fail "the library's own flags are refused: $(cat "$folder/log")"
[[ -z $("$folder/program") ]] || fail "the library's own flags: $("$folder/program")"

for flag in -ffast-math -Ofast -ffinite-math-only; do
    build "$flag" && fail "$flag is taken"
    grep -q "cannot be built with -ffast-math" "$folder/log" || fail "$flag: $(cat "$folder/log")"
done

if [[ $(uname -m) == x86_64 ]] && grep -q '\bfma\b' /proc/cpuinfo; then
    build -mfma -ffp-contract=fast || fail "$(cat "$folder/log")"
    [[ $("$folder/program") == *"this build contracts"* ]] || fail "contraction is not seen: $("$folder/program")"
fi
if [[ $("$compiler" --version) != *clang* && $(uname -m) == x86_64 ]]; then
    build -mfpmath=387 && fail "x87 arithmetic is taken"
    grep -q "a double must be computed as a double" "$folder/log" || fail "x87: $(cat "$folder/log")"
fi
