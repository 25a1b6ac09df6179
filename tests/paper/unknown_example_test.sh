#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: unknown_example_test.sh PYTHON RUN.PY: a misspelt figure is refused with the nearest one's name.
set -euo pipefail
expect() {
    local said code=0
    said=$("$1" "$2" --only "$3" 2>&1) || code=$?
    [[ $code == 2 && $said == *"unknown example $3$4"* ]] || { echo "exit code $code: $said"; exit 1; }
}
expect "$@" figur16 '; did you mean figure_16?'
expect "$@" rings '; did you mean hanging_rings?'
expect "$@" teapot ' (--list prints them)'
