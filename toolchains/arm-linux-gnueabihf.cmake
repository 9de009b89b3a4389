# SPDX-License-Identifier: MIT
# 32-bit ARM boards with Debian's armhf or Raspberry Pi OS: Raspberry Pi 2 and later. The compiler's
# own settings are the least that Debian asks of a processor (ARMv7-A, VFPv3); NEON is used where the
# board has it, because the kernels in src/kernels are chosen when the program runs.
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CMAKE_LIBRARY_ARCHITECTURE arm-linux-gnueabihf)
set(seqloop_sysroot_name armhf)
set(seqloop_emulator qemu-arm-static)
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
