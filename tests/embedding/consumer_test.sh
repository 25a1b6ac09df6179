#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds and runs the consumer against flotilla and fails where any part of that does.
# usage: consumer_test.sh installed CMAKE COMPILER BUILD_DIR [LINK_FLAGS]  the package that BUILD_DIR installs
#        consumer_test.sh shared    CMAKE COMPILER                         installed from a build with BUILD_SHARED_LIBS=ON
#        consumer_test.sh embedded  CMAKE COMPILER                         added with add_subdirectory
set -euo pipefail
mode=$1 cmake=$2 compiler=$3 build=${4:-} link_flags=${5:-}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build_consumer() {
    "$cmake" -S "$here/consumer" -B "$work/consumer" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
        -DCMAKE_EXE_LINKER_FLAGS="$link_flags" "$@"
    "$cmake" --build "$work/consumer"
    "$work/consumer/consumer"
}

# The same program by other compilers and with other flags: the same bits.
compare_flavours() {
    local clang flavour reference
    clang=$(command -v clang++ || true)
    reference=$("$work/consumer/consumer" | grep hash)
    [ "$(wc -l <<<"$reference")" = 2 ] || { echo "no hashes: $reference"; return 1; }
    [ -n "$clang" ] || echo "no clang++ here: its program is left out"
    for flavour in "-O0" "-O3 -march=native" "-O1 -fsanitize=address,undefined" ${clang:+"clang -O2"}; do
        rm -rf "$work/flavour"
        "$cmake" -S "$here/consumer" -B "$work/flavour" -G Ninja -DCMAKE_PREFIX_PATH="$work/installed" \
            -DCMAKE_CXX_COMPILER="$([[ $flavour == clang* ]] && echo "$clang" || echo "$compiler")" \
            -DCMAKE_EXE_LINKER_FLAGS="$link_flags" -DCMAKE_CXX_FLAGS="${flavour#clang }" >/dev/null
        "$cmake" --build "$work/flavour" >/dev/null
        [ "$("$work/flavour/consumer" | grep hash)" = "$reference" ] || { echo "other hashes: $flavour"; return 1; }
        echo "same hashes: $flavour"
    done
}

# NOTICE.txt names every library that the command needs at run time.
check_notice() {
    local notice=$work/installed/share/doc/flotilla/NOTICE.txt library
    for library in $(readelf -d "$work/installed/bin/flotilla" | sed -n 's/.*NEEDED.*\[\(lib[a-z]*+*\).*/\1/p'); do
        [ "$library" = libflotilla ] || grep -qE "[( ]${library//+/[+]}[0-9]*[),]" "$notice" ||
            { echo "NOTICE.txt does not name $library"; return 1; }
    done
}

# A program linked with one minor version of 0.x must not start with another.
check_soname() {
    local version soname
    version=$(find "$work/installed" -name flotillaConfigVersion.cmake -exec \
        sed -n 's/^set(PACKAGE_VERSION "\(.*\)")$/\1/p' {} +)
    soname=$(readelf -d "$(find "$work/installed" -name libflotilla.so)" | sed -n 's/.*SONAME.*\[\(.*\)\].*/\1/p')
    [ "$soname" = "libflotilla.so.${version%.*}" ] || { echo "soname $soname of version $version"; return 1; }
}

# The examples of scripts/examples/cpp: they end with 0 only where what they show is true.
build_examples() {
    "$cmake" -S "$root/scripts/examples/cpp" -B "$work/examples" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
        -DCMAKE_EXE_LINKER_FLAGS="$link_flags" -DCMAKE_PREFIX_PATH="$work/installed"
    "$cmake" --build "$work/examples"
    "$work/examples/chain" 4
    "$work/examples/bin_filling" 6 "$work/bin" | tee "$work/poses"
    [ "$(wc -l <"$work/poses")" = 8 ] && [ -s "$work/bin/end.png" ]
}

install_and_use() {
    "$cmake" --install "$1" --prefix "$work/installed"
    check_notice
    build_consumer -DCMAKE_PREFIX_PATH="$work/installed"
    "$work/installed/bin/flotilla" --help
}

case $mode in
installed)
    install_and_use "$build"
    build_examples
    [ -n "$link_flags" ] || compare_flavours
    ;;
shared)
    "$cmake" -S "$root" -B "$work/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
        -DBUILD_SHARED_LIBS=ON -DFLOTILLA_BUILD_TESTS=OFF -DFLOTILLA_BUILD_BENCH=OFF
    "$cmake" --build "$work/build"
    install_and_use "$work/build"
    check_soname
    ;;
embedded) build_consumer -DFLOTILLA_SOURCE="$root" -DCMAKE_BUILD_TYPE=Release -DFLOTILLA_BUILD_CLI=OFF ;;
*) exit 2 ;;
esac
