#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What tools/sysroot refuses, and how it says so: what, why, what to do. Nothing is fetched.
# Usage: sysroot.sh SOURCE
set -euo pipefail
tool=$1/tools/sysroot
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
# refused WORDS COMMAND...
refused() {
  local words=$1
  shift
  if "$@" >out 2>&1 || ! grep -q "$words" out || grep -q Traceback out; then
    echo "$* should fail, and say: $words"
    cat out
    exit 1
  fi
}
refused 'Usage: sysroot ARCH DIR' "$tool"
refused 'Usage: sysroot ARCH DIR' "$tool" armhf
refused 'mips is no architecture known here: aarch64 or armhf' "$tool" mips "$work/root"
mkdir mine
touch mine/letter
refused 'mine holds something else: name a folder that is not there yet' "$tool" armhf mine
[ -e mine/letter ]
refused 'name a folder that can be written to' "$tool" armhf mine/letter/root
mkdir empty
refused 'apt-get is not installed: this needs .* Debian 12' env PATH="$work/empty" "$(python3 -c 'import sys; print(sys.executable)')" "$tool" armhf root
[ ! -e root ]
