#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Pastes what the README shows: its C++ program is built against the installed package and run, its scene is simulated and proved.
# src/BUILDING.md's lines for CMake build it too.
# Its rows of other engines are those of the measured page. The scene of src/io/README.md is valid, and a run takes its edits.
# usage: readme_test.sh CMAKE COMPILER BUILD_DIR [LINK_FLAGS]
set -euo pipefail
cmake=$1 compiler=$2 build=$3 link_flags=${4:-}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# blocks LANGUAGE TEXT [PAGE]: the code blocks of the README, or of another page, in this language that contain TEXT.
blocks() {
    awk -v language="$1" -v text="$2" '
        /^```/ { if (inside) { if (wanted && index(block, text)) printf "%s", block; inside = 0 }
                 else { inside = 1; wanted = $0 == "```" language; block = "" }; next }
        inside { block = block $0 "\n" }' "$root/${3:-README.md}"
}

awk -F' *[|] *' '
    FNR == NR { if (!($2 in measured)) measured[$2] = $3 " " $6 " " $7; next }
    /^\| (flotilla|Bullet|ODE)/ { gsub(",", "", $4); gsub(",", "", $5); rows++
                                  if (measured[$2] != $3 " " $4 " " $5) { print "not as measured: " $0; wrong = 1 } }
    END { exit wrong || rows < 5 }' "$root/bench/results/engines.md" "$root/README.md"

blocks sh 'cmake --install' src/BUILDING.md | sed "s|^cmake|\"$cmake\"|; s|build/release|\"$build\"|; s|DIR|\"$work/installed\"|" >"$work/install"
[[ -s $work/install ]] || { echo "src/BUILDING.md does not install"; exit 1; }
bash -euo pipefail "$work/install" >/dev/null

# build NAME: the README's program, with what standard input says in CMake's language.
build() {
    mkdir "$work/$1"
    blocks cpp "int main" >"$work/$1/main.cpp"
    {
        echo 'cmake_minimum_required(VERSION 3.25)'
        echo 'project(program LANGUAGES CXX)'
        echo 'add_executable(program main.cpp)'
        cat
    } >"$work/$1/CMakeLists.txt"
    grep -q 'target_link_libraries' "$work/$1/CMakeLists.txt"
    "$cmake" -S "$work/$1" -B "$work/$1/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
        -DCMAKE_EXE_LINKER_FLAGS="$link_flags" -DCMAKE_PREFIX_PATH="$work/installed"
    "$cmake" --build "$work/$1/build"
    "$work/$1/build/program" | tee "$work/says"
    grep -q 'the mug lies at' "$work/says"
}
blocks cmake target_link_libraries | build program
blocks cmake 'or add_subdirectory' src/BUILDING.md | build everything
blocks cmake 'COMPONENTS core' src/BUILDING.md | build core # as the README says, it needs no more

# Each block as it stands, in an empty folder; the first line of the one with the library's scene says where the command is.
cd "$work"
mkdir -p build
ln -s "$work/installed/bin" build/run
PATH=$work/installed/bin:$PATH
for text in 'cat > out/lid.json' 'scene household'; do
    commands=$(blocks sh "$text")
    [[ -n $commands ]] || { echo "the README has no block with: $text"; exit 1; }
    bash -euo pipefail -c "$commands"
done
[[ -s out/household/report.html && -s out/household.png && -s out/household.csv ]]

mkdir scenes meshes
cp "$root/bench/meshes/boat.obj" meshes/
blocks json '"flotilla_scene"' src/io/README.md >scenes/scene.json
flotilla check scenes/scene.json
cp "$root/tests/fuzz/corpus/obj/box.obj" out/ball.obj
blocks json '"flotilla_edits"' src/io/README.md >out/edits.json
flotilla run out/lid.json --steps 35 --edits out/edits.json --output out/edited --quiet
[[ $(grep -o '"step"' out/edited/edits.json | wc -l) == 4 ]]
