#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# In whole numbers, the same descriptors give the same match list, to the last byte, whatever
# processor and kernels compare them: here, and cross-built in an emulator.
# Usage: same_answers.sh SEQLOOP CHOSEN BUILDS SHARED
#   SEQLOOP, CHOSEN  the program, and seqloop-chosen-kernels
#   BUILDS           folder with aarch64/, armhf/ and sysroot/, as the presets and tools/sysroot make
#   SHARED           folder of real data; exit code 77 where it is missing
# With SEQLOOP_REQUIRE_DATA set, a missing folder fails.
set -euo pipefail
seqloop=$1 chosen=$2 builds=$3 shared=$4
missing() {
  echo "not there: $1"
  [ -z "${SEQLOOP_REQUIRE_DATA:-}" ] || exit 1
}
drives=$shared/data/gardens_point
[ -d "$drives" ] || { missing "$drives"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

for drive in day_left night_right; do
  "$seqloop" describe --source "$drives/$drive" --out $drive.npy 2>/dev/null
done

# What is matched: an option list a line.
cat >options <<'EOF'
--method o-seqcnnslam --reference day_left.npy --query night_right.npy --ds 20
--method seqcnnslam --reference day_left.npy --query night_right.npy --ds 20 --enhance on
--method a-seqcnnslam --reference day_left.npy --query night_right.npy --ds 20 --relocalise off
--method o-seqcnnslam --reference day_left.npy --query night_right.npy --ds 20 --arithmetic sketch
--method o-seqcnnslam --query day_left.npy --ds 40 --exclude 10
EOF
# match_all NAME COMMAND...: all lists after each other, in NAME.csv
match_all() {
  local name=$1 job
  shift
  while read -r job; do
    # shellcheck disable=SC2086 # options
    "$@" match $job --out list.csv 2>errors </dev/null || { cat errors; exit 1; }
    cat list.csv >>"$name.csv"
  done <options
  echo "$(sha256sum <"$name.csv") $name: $(wc -l <"$name.csv") lines"
}
same() {
  match_all "$@"
  cmp native.csv "$1.csv" || { echo "was all of this built from the same sources?"; exit 1; }
}

match_all native "$seqloop"
[ "$(wc -l <native.csv)" -gt 500 ]
kernels=$("$seqloop" bench --only column --n 16 --d 64 --rounds 1 --json 2>/dev/null |
  grep -o '"seqloop-int8-[a-z0-9_]*"' | sort -u | sed 's/"seqloop-int8-\(.*\)"/\1/')
[ "$(wc -w <<<"$kernels")" -ge 2 ] || echo "only one kind of kernels runs here"
for name in $kernels; do SEQLOOP_KERNELS=$name same "$name" "$chosen"; done

# The first processor has dot products of bytes, the second one has none.
for target in "aarch64 max" "aarch64 cortex-a72" "armhf max"; do
  read -r arch processor <<<"$target"
  program=$builds/$arch/tools/seqloop
  emulator=qemu-${arch/armhf/arm}-static
  if [ ! -x "$program" ] || ! command -v "$emulator" >/dev/null; then
    missing "$program or $emulator (preset $arch)"
    continue
  fi
  same "$arch-$processor" "$emulator" -cpu "$processor" -L "$builds/sysroot/$arch" "$program"
done
