#!/bin/sh
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
echo "the core needs neither OpenCV nor threads nor files"
