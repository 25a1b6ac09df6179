#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the packages of a build and uses each where it is unpacked: the command runs and proves a run, a program is
# built by pkg-config's words.
# usage: packages_test.sh CPACK COMPILER BUILD_DIR
set -euo pipefail
cpack=$1 compiler=$2 build=$3
for tool in dpkg-deb dpkg-shlibdeps; do
    command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed (Debian package dpkg-dev)"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# use PREFIX: the command of an unpacked package.
use() {
    local command=$1/bin/flotilla
    "$command" scene stack --bodies 3 >"$work/stack.json"
    "$command" run "$work/stack.json" --steps 5 --threads 1 --output "$work/run" --overwrite --audit --quiet
    for file in LICENSE NOTICE.txt CITATION.cff; do [[ -s $1/share/doc/flotilla/$file ]] || { echo "no $file"; return 1; }; done
}

# link PREFIX NAME: a program built by what pkg-config says of flotilla or flotilla-core.
link() {
    local flags
    flags=$(PKG_CONFIG_PATH=$(dirname "$(find "$1" -name "$2.pc")") pkg-config --cflags --libs "$2")
    cat >"$work/main.cpp" <<'CODE'
#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>
int main() {
    flotilla::World world(flotilla::make_scene("stack", 3));
    return world.step().step == 1 ? 0 : 1;
}
CODE
    # shellcheck disable=SC2086 # words
    "$compiler" -std=c++20 "$work/main.cpp" $flags -o "$work/main"
    "$work/main"
    [[ $2 == flotilla ]] || ! ldd "$work/main" | grep -E 'hdf5|libpng|libz[.]' || { echo "the core alone needs these"; return 1; }
}

"$cpack" --config "$build/CPackConfig.cmake" -G "DEB;TGZ" -B "$work/packages" >"$work/log" || { cat "$work/log"; exit 1; }
deb=$(find "$work/packages" -maxdepth 1 -name '*.deb') tgz=$(find "$work/packages" -maxdepth 1 -name '*.tar.gz')
ls -s "$deb" "$tgz"

dpkg-deb -x "$deb" "$work/deb"
use "$work/deb/usr"
dpkg-deb -f "$deb" Depends | tee "$work/depends"
for library in libhdf5 libtbb libpng libgomp libc6; do
    grep -q "$library" "$work/depends" || { echo "the package does not depend on $library"; exit 1; }
done
[[ -z $(find "$work/deb" -path '*dist-packages*') ]] || { echo "the package holds the Python module"; exit 1; }

mkdir "$work/tgz"
tar -xf "$tgz" -C "$work/tgz" --strip-components=1
use "$work/tgz"
if command -v pkg-config >/dev/null; then
    for name in flotilla flotilla-core; do
        link "$work/deb/usr" $name
        link "$work/tgz" $name
    done
else
    echo "pkg-config is not installed: its file was not tried"
fi
