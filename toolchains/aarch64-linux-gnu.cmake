# SPDX-License-Identifier: MIT
# 64-bit ARM boards with Debian 12 or Raspberry Pi OS: Raspberry Pi 3 and later. A Jetson's Ubuntu has another OpenCV.
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(seqloop_sysroot_name aarch64)
set(seqloop_emulator qemu-aarch64-static)
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
