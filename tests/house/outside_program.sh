#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds and runs the program that the top README.md shows, against an installed copy, as a user would.
# Usage: outside_program.sh SOURCE BUILD DRIVE_MAKER EMULATOR CMAKE_ARGUMENT...
# EMULATOR starts what was built: env where nothing is needed for that.
set -eu
source=$1 build=$2 maker=$3 emulator=$4
shift 4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/installed" >/dev/null

# The first ```cmake and the first ```cpp block of the README.
block() { awk -v kind="$1" '$0 == "```" kind && !done {on = 1; next} $0 == "```" && on {on = 0; done = 1} on' "$source/README.md"; }
mkdir "$work/user"
block cmake >"$work/user/CMakeLists.txt"
block cpp >"$work/user/main.cpp"
[ -s "$work/user/main.cpp" ] && [ -s "$work/user/CMakeLists.txt" ]

cmake -G Ninja -S "$work/user" -B "$work/user/build" -DCMAKE_BUILD_TYPE=Release "$@" \
  -DCMAKE_PREFIX_PATH="$work/installed" >"$work/log" || { cat "$work/log"; exit 1; }
cmake --build "$work/user/build" >"$work/log" || { cat "$work/log"; exit 1; }

# Who brings descriptors of their own needs the core alone, and no OpenCV.
mkdir "$work/core"
sed 's/find_package(seqloop REQUIRED)/find_package(seqloop REQUIRED COMPONENTS core)/
     s/ seqloop::opencv//' "$work/user/CMakeLists.txt" >"$work/core/CMakeLists.txt"
cat >"$work/core/main.cpp" <<'EOF'
#include <seqloop/detector.hpp>
int main() {
  const seqloop::MatcherConfig config{.use = seqloop::Use::close_loops};
  seqloop::PlaceMap map(config, {.places = 10, .descriptor_size = 2});
  seqloop::Detector detector(config, map);
  return detector.step(std::vector<float>{1.0F, 0.0F}).gate == seqloop::Gate::warming_up ? 0 : 1;
}
EOF
cmake -G Ninja -S "$work/core" -B "$work/core/build" "$@" -DCMAKE_PREFIX_PATH="$work/installed" \
  -DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON >"$work/log" || { cat "$work/log"; exit 1; }
cmake --build "$work/core/build" >"$work/log" || { cat "$work/log"; exit 1; }
$emulator "$work/core/build/loops"

"$maker" --out "$work/drive" --frames 500 --seed 2 --drives loop --size 160x90 2>/dev/null
$emulator "$work/user/build/loops" "$work/drive/drive" >"$work/loops.txt"
tail -3 "$work/loops.txt"
[ "$(grep -c 'is place' "$work/loops.txt")" -ge 100 ] || { echo "hardly any loop found"; exit 1; }
$emulator "$work/installed/bin/seqloop" --version
