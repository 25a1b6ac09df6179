# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by scripts/test and scripts/run: Debian packages, configure, build. Every step does nothing when it is already done.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# missing_packages SCOPE...: the packages of packages.txt for these scopes that are not installed, one per line.
missing_packages() {
    local name scope status
    while read -r name scope; do
        [[ -z $name || $name == \#* || " $* " != *" $scope "* ]] && continue
        status=$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null || true)
        [[ $status == installed ]] || echo "$name"
    done <"$root/scripts/packages.txt"
}

# as_root COMMAND...: runs it as root; fails where that is impossible.
as_root() {
    if [[ $(id -u) == 0 ]]; then
        "$@"
    elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; then
        sudo "$@"
    else
        return 1
    fi
}

# ensure_packages SCOPE...: installs what is missing, or lists it and exits with 2.
ensure_packages() {
    local missing
    if ! command -v dpkg-query >/dev/null; then
        echo "not a Debian system: install the equivalents of scripts/packages.txt yourself" >&2
        return
    fi
    mapfile -t missing < <(missing_packages "$@")
    ((${#missing[@]})) || return 0
    echo "installing: ${missing[*]}" >&2
    if ! { as_root apt-get update -qq &&
        as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"; } >&2; then
        mapfile -t missing < <(missing_packages "$@")
        ((${#missing[@]})) || return 0
        printf 'missing Debian packages that cannot be installed from here:\n' >&2
        printf '  %s\n' "${missing[@]}" >&2
        exit 2
    fi
}

# build_preset PRESET: configures only when there is no build yet or the presets changed (the build itself follows every
# CMakeLists.txt), then builds what changed.
build_preset() {
    local ninja_file=$root/build/$1/build.ninja
    cd "$root"
    if [[ ! -e $ninja_file || CMakePresets.json -nt $ninja_file ]]; then cmake --preset "$1"; fi
    cmake --build --preset "$1"
}
