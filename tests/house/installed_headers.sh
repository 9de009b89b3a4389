#!/bin/sh
# SPDX-License-Identifier: MIT
# What `cmake --install` offers to users: the headers that installed_headers.txt lists, and in
# detail/ what these include. Each of the listed ones compiles on its own.
# Usage: installed_headers.sh SOURCE BUILD CXX
set -eu
source=$1 build=$2 cxx=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work" >/dev/null
cd "$work/include"
find . -type f | sed 's|^\./||' | grep -v '/detail/' | LC_ALL=C sort >"$work/found"
diff "$source/tests/house/installed_headers.txt" "$work/found" || {
  echo "the public headers (>) are not those of tests/house/installed_headers.txt (<)"
  exit 1
}
while read -r header; do
  echo "#include <$header>"
done <"$work/found" >"$work/all.cpp"
"$cxx" -std=c++20 -fsyntax-only -I . "$work/all.cpp"
