# SPDX-License-Identifier: MIT
# The program built for ARM boards, of 64 bits and of 32, by this arm64 machine's kernel. Each runs with
# the libraries that its board has: SEQLOOP_aarch64 and SEQLOOP_armhf are the programs,
# SYSROOT_aarch64 and SYSROOT_armhf the boards' files. FEEDER is of 64 bits; PICTURES as in loopback.sh.
#
# What depends on the processor is here: what passes between program and kernel (other numbers and
# structures for 32 bits, and a layer in the kernel that translates them), and what is computed from
# pictures. Who holds a device, how it is found again, and signals are the same code everywhere;
# rates say nothing of a board; single formats are unit tests. Starting the program takes these
# processors many seconds.
here=$(dirname "$0")
failed=0

# launcher BOARD TRIPLET NAME PROGRAM: prints the path of what starts the program
launcher() {
  local sysroot=SYSROOT_$1 start=$WORK/$1/$3 lib
  sysroot=${!sysroot}
  lib=$sysroot/usr/lib/$2
  mkdir -p "$WORK/$1"
  cat >"$start" <<END
#!/bin/sh
exec $sysroot/lib/ld-linux-$1.so.* \
  --library-path $sysroot/lib/$2:$lib:$lib/blas:$lib/lapack:$lib/pulseaudio:$sysroot/usr/lib $4 "\$@"
END
  chmod +x "$start"
  echo "$start"
}

# board NAME TRIPLET CASE...
board() {
  local program=SEQLOOP_$1
  echo "== $1"
  SEQLOOP=$(launcher "$1" "$2" seqloop "${!program}")
  export SEQLOOP
  shift 2
  CASES="$*" bash "$here/cameras.sh" || failed=1
  bash "$here/memory.sh" || failed=1
}

FEEDER=$(launcher aarch64 aarch64-linux-gnu v4l2-feeder "$FEEDER")
export FEEDER
board armhf arm-linux-gnueabihf lists_the_camera reads_a_multiplanar_camera \
  does_not_believe_stamps_from_the_future survives_a_disconnect plays_mjpg
board aarch64 aarch64-linux-gnu lists_the_camera counts_on_when_the_sequence_number_wraps \
  names_a_damaged_frame survives_a_disconnect finds_the_camera_again plays_mjpg names_corrupt_frames
exit $failed
