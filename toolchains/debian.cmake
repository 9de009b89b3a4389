# SPDX-License-Identifier: MIT
# What both toolchains share: Debian's cross compiler, a folder with the board's files (made by
# tools/sysroot), and an emulator, with which ctest runs what was built.
set(CMAKE_SYSTEM_NAME Linux)
set(SEQLOOP_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../build/sysroot/${seqloop_sysroot_name}
  CACHE PATH "The board's files, as tools/sysroot makes them")
get_filename_component(SEQLOOP_SYSROOT "${SEQLOOP_SYSROOT}" ABSOLUTE)
if(NOT EXISTS ${SEQLOOP_SYSROOT}/packages.txt)
  message(FATAL_ERROR "There is no sysroot at ${SEQLOOP_SYSROOT}.\n"
    "Make it with: tools/sysroot ${seqloop_sysroot_name} ${SEQLOOP_SYSROOT}")
endif()
# Trial compilations read this file too, and know nothing but what is named here.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SEQLOOP_SYSROOT)

set(CMAKE_C_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-gcc)
set(CMAKE_CXX_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-g++)
set(CMAKE_SYSROOT ${SEQLOOP_SYSROOT})
# What was built for the board lies where CMAKE_PREFIX_PATH says.
set(CMAKE_FIND_ROOT_PATH ${SEQLOOP_SYSROOT} ${CMAKE_PREFIX_PATH})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# pkg-config too: what the board has, by where it lies here.
set(ENV{PKG_CONFIG_LIBDIR} ${SEQLOOP_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/pkgconfig)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${SEQLOOP_SYSROOT})

find_program(SEQLOOP_EMULATOR ${seqloop_emulator})
if(SEQLOOP_EMULATOR)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${SEQLOOP_EMULATOR};-L;${SEQLOOP_SYSROOT}")
endif()
