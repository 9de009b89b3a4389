#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The package that tools/cross makes runs where nothing is but the packages that it names, and what
# these depend on.
# Usage: board_package.sh ARCH    aarch64 or armhf
set -euo pipefail
cd "$(dirname "$0")/../.."
arch=$1
emulator=qemu-${arch/armhf/arm}-static
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tools/cross "$arch" "$work/board"
package=$(echo "$work"/board/seqloop_*.deb)
dpkg-deb --field "$package"
grep -q "apt install ./$(basename "$package")" "$work/board/INSTALL.txt"

# The board: a root of exactly these packages.
read -ra packages < <(dpkg-deb --field "$package" Depends | sed 's/([^)]*)//g; s/,//g')
root=$PWD/build/sysroot/board-$arch
tools/sysroot "$arch" "$root" "${packages[@]}"
dpkg-deb --extract "$package" "$work/unpacked"
# What the page of packages tells to copy.
for example in seqloop.service 70-seqloop-camera.rules; do
  cmp "tools/packaging/$example" "$work/unpacked/usr/share/doc/seqloop/examples/$example"
done
seqloop() { (cd "$work" && "$emulator" -L "$root" "$work/unpacked/usr/bin/seqloop" "$@"); }

seqloop --version
# Two passes of 40 pictures of noise.
/usr/bin/env python3 - "$work/drive" <<'EOF'
import pathlib, random, sys
folder = pathlib.Path(sys.argv[1])
folder.mkdir()
for number in range(80):
    random.seed(number % 40)
    pixels = bytes(random.randrange(256) for _ in range(8 * 5))
    rows = [bytes(pixels[y // 8 * 8 + x // 8] for x in range(64)) for y in range(40)]
    (folder / f"{number:03}.pgm").write_bytes(b"P5 64 40 255\n" + b"".join(rows))
EOF
seqloop describe --source drive --out drive.npy
seqloop match --method o-seqcnnslam --query drive.npy --ds 10 --exclude 15 --out loops.csv
# query,match,…: most frames of the second pass are 40 places later than their match.
awk -F, 'NR > 1 && $1 - $2 == 40 {right++} END {print right " loops found"; exit right < 25}' "$work/loops.csv"

# Without one of its libraries it names what is missing.
libraries=$(cd "$root" && echo usr/lib/*-linux-gnu*)
mkdir -p "$work/poor/lib" "$work/poor/$libraries"
ln -s "$root"/lib/* "$work/poor/lib/"
ln -s "$root/$libraries"/* "$work/poor/$libraries/"
rm "$work/poor/$libraries"/libfmt.so.*
root=$work/poor
if seqloop --version 2>"$work/error"; then
  echo "it runs without libfmt, so what else was found on this machine?"
  exit 1
fi
grep 'libfmt.so.9: cannot open' "$work/error"
