# SPDX-License-Identifier: MIT
# Writes the commit that is being built into a header, and leaves the header alone when that has
# not changed.
# Usage: cmake -D SOURCE=... -D HEADER=... -P commit.cmake
set(commit "unknown")
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --abbrev=10
    WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE described ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(described)
    set(commit ${described})
  endif()
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define SEQLOOP_COMMIT \"${commit}\"\n")
