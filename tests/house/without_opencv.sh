#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What SEQLOOP_OPENCV=OFF promises: a C++ compiler and CMake are enough for the core, files and
# cameras; and the installed core answers the same on every processor, with kernels and without.
# Usage: without_opencv.sh SOURCE CXX        for this machine, where nothing else is to be found
#        without_opencv.sh SOURCE CXX arm    the same answers here, with kernels, as on ARM without
# Exit code 77 where Debian's cross compilers or qemu-user-static are missing; with
# SEQLOOP_REQUIRE_DATA set, that fails.
set -euo pipefail
source=$1 cxx=$2
# Here, inside the checkout, so that the compiler cache knows these sources again, in any clone.
work=$(mktemp -d "$PWD/without_opencv.XXXXXX")
trap 'rm -rf "$work"' EXIT
must() { "$@" >"$work/log" 2>&1 || { echo "failed: $*"; cat "$work/log"; exit 1; }; }

mkdir "$work/user" "$work/nothing"
cat >"$work/user/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.25)
project(loops CXX)
find_package(seqloop REQUIRED COMPONENTS ${wanted})
add_executable(loops main.cpp)
target_link_libraries(loops PRIVATE seqloop::core)
target_link_options(loops PRIVATE -static -Wl,--gc-sections)
EOF
# Two laps of a drive whose descriptors come from whole numbers alone.
cat >"$work/user/main.cpp" <<'EOF'
#include <cstdint>
#include <cstdio>
#include <seqloop/detector.hpp>
#include <seqloop/difference.hpp>
#include <vector>

int main() {
  constexpr std::size_t lap = 300;
  constexpr std::size_t size = 100;
  const seqloop::MatcherConfig config{.use = seqloop::Use::close_loops, .sequence_length = 20};
  seqloop::PlaceMap map(config, {.places = 2 * lap, .descriptor_size = size});
  seqloop::Detector detector(config, map);
  std::vector<float> descriptor(size);
  for (std::size_t frame = 0; frame < 2 * lap; ++frame) {
    std::uint32_t place = static_cast<std::uint32_t>(frame % lap) * 2654435761U + 1;
    std::uint32_t noise = static_cast<std::uint32_t>(frame) * 40503U + 7;
    for (float& value : descriptor) {
      place = place * 1664525U + 1013904223U;
      noise = noise * 1664525U + 1013904223U;
      value = static_cast<float>(place >> 20U) + static_cast<float>(noise >> 22U) - 2'560.0F;
    }
    (void)seqloop::normalise(descriptor);
    const seqloop::FrameReport report = detector.step(descriptor);
    if (!report.match) continue;
    std::printf("%llu %llu %llu %.9g %.9g\n", static_cast<unsigned long long>(*report.frame),
                static_cast<unsigned long long>(report.match->place),
                static_cast<unsigned long long>(report.match->head), double{report.match->score},
                double{report.match->uniqueness});
  }
}
EOF

# answers NAME EMULATOR CMAKE_ARGUMENT...: builds, installs and uses the core, and writes NAME.txt
answers() {
  local name=$1 emulator=$2
  shift 2
  # Every source by itself: with all that it includes.
  must cmake -G Ninja -S "$source" -B "$work/$name" -DCMAKE_BUILD_TYPE=Release -DSEQLOOP_OPENCV=OFF \
    -DCMAKE_CXX_FLAGS_RELEASE=-O1 -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON "$@"
  must cmake --build "$work/$name"
  must cmake --install "$work/$name" --prefix "$work/$name/installed"
  local user=(cmake -G Ninja -S "$work/user" -B "$work/$name/user" -DCMAKE_BUILD_TYPE=Release "$@"
    -Dseqloop_DIR="$(dirname "$(find "$work/$name/installed" -name seqloopConfig.cmake)")")
  must "${user[@]}" -Dwanted=core
  must cmake --build "$work/$name/user"
  $emulator "$work/$name/user/loops" >"$work/$name.txt"
  echo "$name: $(wc -l <"$work/$name.txt") answers"
  if "${user[@]}" -Dwanted=opencv >"$work/log" 2>&1 ||
    ! grep -q 'no opencv, only: core;' "$work/log"; then
    echo "find_package(seqloop COMPONENTS opencv) should say what is missing, but said:"
    cat "$work/log"
    exit 1
  fi
}

# Nothing is to be found outside the compiler.
nothing=(-DCMAKE_FIND_ROOT_PATH="$work/nothing")
for mode in INCLUDE LIBRARY PACKAGE; do nothing+=(-DCMAKE_FIND_ROOT_PATH_MODE_$mode=ONLY); done

if [ "${3:-}" != arm ]; then
  answers bare "" "${nothing[@]}" -DCMAKE_CXX_COMPILER="$cxx"
  grep -q 'SEQLOOP_HIGHWAY_HEADERS.*NOTFOUND' "$work/bare/CMakeCache.txt"
  [ "$(wc -l <"$work/bare.txt")" -ge 300 ]
  exit
fi
boards=("aarch64 aarch64-linux-gnu-g++ qemu-aarch64-static" "armv7l arm-linux-gnueabihf-g++ qemu-arm-static")
for board in "${boards[@]}"; do
  read -r processor compiler emulator <<<"$board"
  command -v "$compiler" "$emulator" >/dev/null && continue
  echo "not installed: $compiler or $emulator"
  [ -z "${SEQLOOP_REQUIRE_DATA:-}" ] || exit 1
  exit 77
done
answers here "" -DCMAKE_CXX_COMPILER="$cxx"
[ "$(wc -l <"$work/here.txt")" -ge 300 ]
for board in "${boards[@]}"; do
  read -r processor compiler emulator <<<"$board"
  answers "$processor" "$emulator" "${nothing[@]}" -DCMAKE_SYSTEM_NAME=Linux \
    -DCMAKE_SYSTEM_PROCESSOR="$processor" -DCMAKE_CXX_COMPILER="$compiler"
  grep -q 'SEQLOOP_HIGHWAY_HEADERS.*NOTFOUND' "$work/$processor/CMakeCache.txt"
  cmp "$work/here.txt" "$work/$processor.txt"
done
