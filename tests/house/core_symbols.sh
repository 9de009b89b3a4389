#!/bin/sh
# SPDX-License-Identifier: MIT
# The core must not need OpenCV or threads, whatever its CMake target says.
# Usage: core_symbols.sh NM LIBCORE LIBOPENCV   (the second library proves that the check can fail)
set -eu
foreign() { "$1" --undefined-only --demangle "$2" | grep -E 'cv::|pthread_|std::thread|fopen|::(i|o)?fstream'; }
if ! foreign "$1" "$3" >/dev/null; then
  echo "the check finds nothing even in $3"
  exit 1
fi
if foreign "$1" "$2"; then
  echo "$2 needs these from outside"
  exit 1
fi
# What is compiled for one kind of processor must not offer functions that the linker could take for
# all, such as the C++ library's inline ones.
shared() {
  "$1" --print-file-name --defined-only --demangle "$2" |
    grep -E ':(sse4|avx[^:]*|neon[^:]*)\.cpp\.o:.* [WVu] ' | grep -v 'hwy::N_'
}
if shared "$1" "$2"; then
  echo "$2 may run these on processors that they were not compiled for"
  exit 1
fi
echo "the core needs neither OpenCV nor threads nor files"
