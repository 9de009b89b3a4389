#!/bin/sh
# SPDX-License-Identifier: MIT
# A project that takes this one in (add_subdirectory, FetchContent) and names no type of build has it optimised, and
# installs a package that says where its libraries are. Nothing is built.
# Usage: subproject.sh SOURCE CXX
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.25)
project(user CXX)
set(SEQLOOP_OPENCV OFF)
add_subdirectory($1 seqloop)
END
# as TYPE: libraries are where there are files for them
as() {
  rm -rf "$work/build"
  cmake -G Ninja -S "$work" -B "$work/build" -DCMAKE_CXX_COMPILER="$2" -DCMAKE_BUILD_TYPE="$1" \
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
  grep '"command".*src/detector.cpp' "$work/build/compile_commands.json" | grep -e ' -O3' | grep -q -e ' -DNDEBUG' ||
    { echo "not optimised, as '$1'"; exit 1; }
  # What the package's targets read is chosen by the type that the whole is installed as.
  find "$work/build" -path '*Export*' -name "seqloopTargets-$3.cmake" | grep . >/dev/null ||
    { echo "as '$1' the package has no libraries:"; find "$work/build" -name 'seqloopTargets*'; exit 1; }
}
as Release "$2" release
as "" "$2" noconfig
