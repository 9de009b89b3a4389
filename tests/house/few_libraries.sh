#!/bin/sh
# SPDX-License-Identifier: MIT
# The program starts without the libraries that only files of pictures need, reads such files by its
# module, built or installed, and says what is missing where that is gone.
# Usage: few_libraries.sh SOURCE BUILD
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
needs() { readelf --dynamic "$1" | grep -E 'NEEDED.*(imgcodecs|videoio)'; }
needs "$build/tools/seqloop-codecs.so" >/dev/null || { echo "the check finds nothing in the module"; exit 1; }
if needs "$build/tools/seqloop"; then
  echo "the program needs these at every start"
  exit 1
fi

mkdir "$work/drive"
for number in 1 2 3; do
  { printf 'P5 64 64 255\n'; head -c 4096 /dev/zero | tr '\0' "$number"; } >"$work/drive/$number.pgm"
done
describe() { "$1" describe --source "$work/drive" --out "$work/drive.npy"; }
DESTDIR=$work/root cmake --install "$build" --prefix /usr --component program >/dev/null
describe "$build/tools/seqloop"
describe "$work/root/usr/bin/seqloop"
mv "$work/root/usr/lib/seqloop/seqloop-codecs.so" "$work"
if describe "$work/root/usr/bin/seqloop" 2>"$work/error"; then
  echo "there is no module, but no error either"
  exit 1
fi
# A camera's recording needs the module no more than a camera does.
"$build/tools/street/seqloop-street" --out "$work/street" --frames 20 --drives loop --size 64x48 --format avi --quiet
"$work/root/usr/bin/seqloop" describe --source "$work/street/drive.avi" --out "$work/video.npy"
cat "$work/error"
grep -q 'seqloop-codecs.so.*install seqloop again' "$work/error"
echo nonsense >"$work/root/usr/lib/seqloop/seqloop-codecs.so"
! describe "$work/root/usr/bin/seqloop" 2>"$work/error"
cat "$work/error"
grep -q 'seqloop-codecs.so: cannot be loaded.*install seqloop again' "$work/error"
