#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The packages of tools/package: lintian finds no error; apt installs them into a Debian of nothing
# but apt, where the program, the manual, Python and the library work; removed, they leave no trace;
# and a second clone of the commit makes the same bytes.
# Usage: package.sh SOURCE    as root, with network: 1 GB in TMPDIR
set -euo pipefail
source=$(realpath "$1")
[ "$(id -u)" = 0 ] || { echo "needs root: a bare Debian is made and entered"; [ -z "${SEQLOOP_REQUIRE_DATA:-}" ] && exit 77; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
must() { "$@" >"$work/log" 2>&1 || { echo "failed: $*"; tail -50 "$work/log"; exit 1; }; }

must "$source/tools/package" "$work/packages"
packages=("$work"/packages/*.deb)
[ "${#packages[@]}" = 4 ]
lintian --fail-on error --allow-root "${packages[@]}"

# A change that is not committed is in the packages, and not in a clone.
if [ -z "$(git -C "$source" status --porcelain)" ]; then
  git clone --quiet "$source" "$work/elsewhere"
  must "$work/elsewhere/tools/package" "$work/again"
  for package in "${packages[@]}"; do
    cmp "$package" "$work/again/$(basename "$package")"
  done
  echo "two builds: the same bytes"
  rm -rf "$work/elsewhere" "$work/again"
else
  echo "not compared with a second build: the tree holds what is not committed"
fi

# The library, unpacked, with this machine's compiler: by CMake and by pkg-config.
dpkg-deb --extract "$work"/packages/libseqloop-dev_*.deb "$work/dev"
cat >"$work/core.cpp" <<'END'
#include <cstdio>
#include <seqloop/detector.hpp>
int main() {
  const seqloop::MatcherConfig config{.use = seqloop::Use::close_loops};
  seqloop::PlaceMap map(config, {.places = 10, .descriptor_size = 2});
  seqloop::Detector detector(config, map);
  std::puts(seqloop::name(detector.step(std::vector<float>{1.0F, 0.0F}).gate).data());
}
END
mkdir "$work/user"
cat >"$work/user/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(user CXX)
find_package(seqloop REQUIRED COMPONENTS core OPTIONAL_COMPONENTS teleport)
add_executable(user ../core.cpp)
target_link_libraries(user PRIVATE seqloop::core)
if(seqloop_teleport_FOUND)
  message(FATAL_ERROR "teleport is not among what was built")
endif()
END
must cmake -G Ninja -S "$work/user" -B "$work/user/build" -DCMAKE_PREFIX_PATH="$work/dev/usr"
must cmake --build "$work/user/build"
[ "$("$work/user/build/user")" = warming_up ]
# Each component finds by itself what it links.
for component in core files linux ros bags opencv turbojpeg sqlite; do
  mkdir "$work/user-$component"
  cat >"$work/user-$component/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.25)
project(user CXX)
find_package(seqloop REQUIRED COMPONENTS $component)
add_executable(user ../core.cpp)
target_link_libraries(user PRIVATE seqloop::$component)
END
  must cmake -G Ninja -S "$work/user-$component" -B "$work/user-$component/build" -DCMAKE_PREFIX_PATH="$work/dev/usr"
done
PKG_CONFIG_PATH=$(dirname "$(find "$work/dev" -name seqloop.pc)")
export PKG_CONFIG_PATH
# shellcheck disable=SC2046 # one word a flag
must g++ -std=c++20 "$work/core.cpp" -o "$work/core" $(pkg-config --cflags --libs seqloop)
[ "$("$work/core")" = warming_up ]

# A Debian of nothing but apt, from this machine's package sources.
root=$work/root
mapfile -t sources < <(find /etc/apt/sources.list /etc/apt/sources.list.d -type f -size +0 2>/dev/null)
must mmdebstrap --mode=root --variant=apt --aptopt='Acquire::Languages "none"' bookworm "$root" "${sources[@]}"
cp /etc/resolv.conf "$root/etc/resolv.conf"
# What apt and dpkg remember of a package's visit is theirs.
trace() {
  (cd "$root" && find . -xdev ! -path './var/lib/dpkg/*' ! -path './var/lib/apt/*' ! -path './var/cache/*' \
    ! -path './var/log/*' ! -path './tmp/*' | LC_ALL=C sort)
}
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
must inside apt-get update
trace >"$work/before"
cp "${packages[@]}" "$root/tmp/"
must inside sh -c 'apt-get install -y --no-install-recommends /tmp/*.deb'

version=$(inside seqloop --version)
echo "in a bare Debian: $version"
[[ $(inside seqloop run --help) == *--source* ]]
for page in seqloop seqloop-run seqloop-match seqloop-camera; do
  [[ $(zcat "$root/usr/share/man/man1/$page.1.gz") == *'SH SYNOPSIS'* ]] || { echo "no manual page $page"; exit 1; }
done
[[ $(zcat "$root/usr/share/man/man1/seqloop-map.1.gz") == *$'\n  seqloop map check FILE\n  seqloop map recover'* ]] ||
  { echo "what seqloop map does is no table in its manual page"; exit 1; }
inside python3 - <<'END'
import numpy
import seqloop
random = numpy.random.default_rng(1)
lap = random.integers(0, 255, (40, 5, 8), numpy.uint8).repeat(8, 1).repeat(8, 2)
describer = seqloop.Describer()
drive = numpy.array([describer.describe(picture) for picture in [*lap, *lap]])
numpy.save("/tmp/drive.npy", drive)
matches = seqloop.match(None, drive, ds=10, exclude=15)
found = matches.query - matches.match == 40
print("from Python:", found.sum(), "loops found")
assert found.sum() >= 25
END
inside seqloop match --query /tmp/drive.npy --ds 10 --exclude 15 --out /tmp/loops.csv
awk -F, 'NR > 1 && $1 - $2 == 40 {right++} END {print "by the program: " right " loops found"; exit right < 25}' \
  "$root/tmp/loops.csv"

# Completion, by the program that was installed.
cat >"$root/tmp/complete.sh" <<'END'
. /usr/share/bash-completion/completions/seqloop
ask() { COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)); _seqloop; echo "${COMPREPLY[*]}"; }
[ "$(ask seqloop de)" = describe ] || { echo "verbs: $(ask seqloop de)"; exit 1; }
[ "$(ask seqloop run --realtime-l)" = --realtime-lock-memory ] || { echo "flags: $(ask seqloop run --realtime-l)"; exit 1; }
[ "$(ask seqloop match --standardise o)" = "on off" ] || { echo "values: $(ask seqloop match --standardise o)"; exit 1; }
[ -z "$(ask seqloop match --query o)" ] || { echo "where files are meant: $(ask seqloop match --query o)"; exit 1; }
END
inside bash /tmp/complete.sh

ours=(seqloop libseqloop-dev python3-seqloop seqloop-doc)
inside dpkg -L "${ours[@]}" | sed 's|^/|./|' | LC_ALL=C sort -u >"$work/listed"
trace >"$work/with"
# left WHEN: what is there at that time and was not before, of these packages' files, folders and names
left() {
  comm -13 "$work/before" "$work/$1" | grep -E 'seqloop' || true
  comm -13 "$work/before" "$work/$1" | comm -12 - "$work/listed"
}
[ "$(left with | wc -l)" -gt 100 ] || { echo "the search for what is left finds nothing of what is there"; exit 1; }
must inside apt-get purge -y --autoremove "${ours[@]}"
trace >"$work/after"
if [ -n "$(left after)" ]; then
  echo "left behind by the packages:"
  left after
  exit 1
fi
echo "removed without a trace"
