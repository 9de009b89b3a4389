#!/bin/sh
# SPDX-License-Identifier: MIT
# The tools take a folder as it is named where they are called. Nothing is built: what they call
# first is stood in for, and notes what they made of the name. A flag is no folder.
# Usage: given_folders.sh SOURCE
set -eu
work=$(realpath "$(mktemp -d)")
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/checkout/tools/experiments" "$work/bin" "$work/here"
for tool in demo docs package cross tidy test accuracy benchmarks experiments/run; do
  cp "$1/tools/$tool" "$work/checkout/tools/$tool"
done
printf '#!/bin/sh\nexit 9\n' >"$work/bin/cmake"
chmod +x "$work/bin/cmake"
cp "$work/bin/cmake" "$work/checkout/tools/install-packages"
cd "$work/here"
for call in 'sh demo out' 'bash docs out' 'bash package out' 'bash cross aarch64 out' 'sh tidy out'; do
  # shellcheck disable=SC2086 # a word each
  set -- $call
  shell=$1 tool=$2
  shift 2
  if PATH=$work/bin:$PATH $shell -x "../checkout/tools/$tool" "$@" >"$work/said" 2>&1 ||
    ! grep -q "=$work/here/out\$" "$work/said"; then
    cat "$work/said"
    echo "tools/$tool $*, called in $work/here, does not take $work/here/out"
    exit 1
  fi
done
for call in 'sh demo --help' 'bash docs -h' 'bash package --help' 'bash cross --help' 'bash cross aarch64 --help' \
  'sh tidy --help' 'bash test --help' 'bash test unit' 'bash test -L' 'bash accuracy --help' \
  'bash benchmarks' 'bash benchmarks --help' 'sh experiments/run --help'; do
  # shellcheck disable=SC2086 # a word each
  set -- $call
  shell=$1 tool=$2
  shift 2
  code=0
  PATH=$work/bin:$PATH $shell "../checkout/tools/$tool" "$@" >"$work/said" 2>&1 || code=$?
  if [ "$code" != 2 ] || ! grep -q "^usage: .*$tool" "$work/said"; then
    cat "$work/said"
    echo "tools/$tool $* does not say how it is used"
    exit 1
  fi
done
# What a tool wants of a folder that is not as it should be is told at once.
code=0
bash ../checkout/tools/accuracy nowhere >"$work/said" 2>&1 || code=$?
if [ "$code" != 2 ] || [ "$(grep -c '^accuracy: .* is not there; ' "$work/said")" != 5 ]; then
  cat "$work/said"
  echo "tools/accuracy nowhere does not name the program and the four drives that are missing"
  exit 1
fi
mkdir drives
touch drives/mine.csv
code=0
sh ../checkout/tools/demo drives >"$work/said" 2>&1 || code=$?
if [ "$code" != 2 ] || ! grep -q "^demo: $work/here/drives holds something else" "$work/said"; then
  cat "$work/said"
  echo "tools/demo drives writes into a folder that holds something else"
  exit 1
fi
