#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The same descriptors give the same match list, to the last byte, whatever processor and kernels
# compare them, in whole numbers and in floats: here, and cross-built in an emulator. A map that one
# processor has saved is the same to the others.
# Usage: same_answers.sh SEQLOOP SHARED kernels CHOSEN    CHOSEN: seqloop-chosen-kernels
#        same_answers.sh SEQLOOP SHARED boards BUILDS
#   SEQLOOP  the program
#   SHARED   folder of real data
#   BUILDS   folder with aarch64/, armhf/ and sysroot/, as the presets and tools/sysroot make
# Exit code 77 where what it needs is missing; with SEQLOOP_REQUIRE_DATA set, that fails.
set -euo pipefail
seqloop=$1 shared=$2 what=$3 other=$4
missing() {
  echo "not there: $1"
  [ -z "${SEQLOOP_REQUIRE_DATA:-}" ] || exit 1
  exit 77
}
drives=$shared/data/gardens_point
[ -d "$drives" ] || missing "$drives"
# The first processor has dot products of bytes, the second one has none.
boards=("aarch64 max" "aarch64 cortex-a72" "armhf max")
emulator_of() { echo "qemu-${1/armhf/arm}-static"; }
program_of() { echo "$other/$1/tools/seqloop"; }
if [ "$what" = boards ]; then
  for arch in aarch64 armhf; do
    [ -x "$(program_of $arch)" ] || missing "$(program_of $arch) (preset $arch)"
    command -v "$(emulator_of $arch)" >/dev/null || missing "$(emulator_of $arch)"
  done
fi
# on BOARD ARGUMENT...: the program, on one of the boards or `here`
on() {
  local arch processor
  read -r arch processor <<<"$1"
  shift
  if [ "$arch" = here ]; then
    "$seqloop" "$@"
  else
    "$(emulator_of "$arch")" -cpu "$processor" -L "$other/sysroot/$arch" "$(program_of "$arch")" "$@"
  fi
}
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
--method seqcnnslam --reference day_left.npy --query night_right.npy --ds 20 --paper
--method o-seqcnnslam --reference day_left.npy --query night_right.npy --ds 20 --arithmetic float
EOF
quietly() { "$@" 2>errors </dev/null || { cat errors; exit 1; }; }
# match_all NAME COMMAND...: all lists after each other, in NAME.csv
match_all() {
  local name=$1 job
  shift
  while read -r job; do
    # shellcheck disable=SC2086 # options
    "$@" match $job --out "$name.list" 2>"$name.errors" </dev/null || { cat "$name.errors"; exit 1; }
    cat "$name.list" >>"$name.csv"
  done <options
  echo "$(sha256sum <"$name.csv") $name: $(wc -l <"$name.csv") lines"
}
# Several may run side by side.
same() {
  match_all "$@"
  cmp native.csv "$1.csv" || { echo "was all of this built from the same sources?"; exit 1; }
}

match_all native "$seqloop"
[ "$(wc -l <native.csv)" -gt 500 ]
if [ "$what" = boards ]; then
  matching=()
  for board in "${boards[@]}"; do
    read -r arch processor <<<"$board"
    same "$arch-$processor" on "$board" &
    matching+=($!)
  done
  for board in "${matching[@]}"; do wait "$board"; done
  movers=(here "aarch64 max" "armhf max")
  for saver in "${movers[@]}"; do
    quietly on "$saver" match --query day_left.npy --map "$saver.seqloop" --out "$saver-day.csv"
    for reader in "${movers[@]}"; do
      quietly on "$reader" match --query night_right.npy --map "$saver.seqloop" --read-only \
        --out night.csv
      [ -e first.csv ] || cp night.csv first.csv
      cmp first.csv night.csv || { echo "saved by $saver, read by $reader"; exit 1; }
    done
  done
  echo "maps of ${#movers[@]} processors, read by each: $(grep -c ',1$' first.csv) accepted"
  [ "$(grep -c ',1$' first.csv)" -gt 150 ]
  exit
fi
kernels=$("$seqloop" bench --only column --n 16 --d 64 --rounds 1 --json 2>/dev/null |
  grep -o '"seqloop-int8-[a-z0-9_]*"' | sort -u | sed 's/"seqloop-int8-\(.*\)"/\1/')
[ "$(wc -w <<<"$kernels")" -ge 2 ] || echo "only one kind of kernels runs here"
for name in $kernels; do SEQLOOP_KERNELS=$name same "$name" "$other"; done
