#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds and runs the consumer against flotilla and fails where any part of that does.
# usage: consumer_test.sh installed CMAKE COMPILER BUILD_DIR [LINK_FLAGS]  the package that BUILD_DIR installs
#        consumer_test.sh shared    CMAKE COMPILER                         installed from a build with BUILD_SHARED_LIBS=ON
#        consumer_test.sh embedded  CMAKE COMPILER                         added with add_subdirectory
#        consumer_test.sh core      CMAKE COMPILER                         likewise, the core alone
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

# A program that links the core alone runs, and neither it nor the core's library needs what only the rest does.
build_core_consumer() {
    local not_needed='libhdf5|libpng|libz[.]|libsz' file
    "$cmake" -S "$here/core_consumer" -B "$work/core_consumer" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
        -DCMAKE_EXE_LINKER_FLAGS="$link_flags" "$@"
    "$cmake" --build "$work/core_consumer"
    "$work/core_consumer/core_consumer"
    "$work/core_consumer/whole_core"
    for file in "$work/core_consumer/core_consumer" "$work/core_consumer/whole_core"; do ldd "$file"; done >"$work/libraries"
    grep -q libtbb "$work/libraries" || { echo "what ldd says is not understood"; return 1; }
    ! grep -E "$not_needed" "$work/libraries" || { echo "programs with the core alone need these"; return 1; }
    file=$(find "$work" -name 'libflotilla_core.a' -o -name 'libflotilla_core.so' | head -1)
    nm -C "$([[ $file == *.so ]] && echo -D || echo -u)" "$file" >"$work/symbols"
    grep -q 'tbb::' "$work/symbols" || { echo "what nm says of $file is not understood"; return 1; }
    ! grep -E ' U (H5[A-Z]|png_|(in|de)flate|gz[a-z]+$|crc32|compress)' "$work/symbols" || { echo "$file calls these"; return 1; }
}

# src/BUILDING.md says which headers belong to which library.
check_headers() {
    local library
    for library in flotilla_core flotilla; do
        sed -n "/target_sources($library PUBLIC/,/)/s/.*flotilla\/\([a-z_]*\)[.]hpp.*/\1/p" "$root/include/CMakeLists.txt" >"$work/there"
        grep "^| .flotilla::.*\`lib$library[.]" "$root/src/BUILDING.md" | cut -d'|' -f4 | grep -o '[a-z_]*' >"$work/said"
        [ -s "$work/there" ] && diff "$work/there" "$work/said" || { echo "src/BUILDING.md names other headers of $library"; return 1; }
    done
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
    local version soname library
    version=$(find "$work/installed" -name flotillaConfigVersion.cmake -exec \
        sed -n 's/^set(PACKAGE_VERSION "\(.*\)")$/\1/p' {} +)
    for library in libflotilla libflotilla_core; do
        soname=$(readelf -d "$(find "$work/installed" -name $library.so)" | sed -n 's/.*SONAME.*\[\(.*\)\].*/\1/p')
        [ "$soname" = "$library.so.${version%.*}" ] || { echo "soname $soname of version $version"; return 1; }
    done
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
    build_core_consumer -DCMAKE_PREFIX_PATH="$work/installed"
    "$work/installed/bin/flotilla" --help
}

case $mode in
installed)
    install_and_use "$build"
    build_examples
    check_headers
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
core)
    build_core_consumer -DFLOTILLA_SOURCE="$root" -DCMAKE_BUILD_TYPE=Release
    [ ! -e "$(find "$work" -name 'libflotilla.*' | head -1)" ] || { echo "more than the core was built"; exit 1; }
    ;;
*) exit 2 ;;
esac
