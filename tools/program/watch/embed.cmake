# SPDX-License-Identifier: MIT
# Turns the page's files into C++:  cmake -D FOLDER=watch/page -D OUTPUT=file.cpp -P embed.cmake
# Its scripts, in this order, become one.
set(scripts words.js charts.js loops.js page.js)
set(code "// Made by embed.cmake; not to be edited.\n#include \"program/watch/page_files.hpp\"\n
namespace seqloop::program {\nnamespace {\n\n")
foreach(part html style script)
  set(hex "")
  if(part STREQUAL html)
    file(READ "${FOLDER}/index.html" hex HEX)
  elseif(part STREQUAL style)
    file(READ "${FOLDER}/style.css" hex HEX)
  else()
    foreach(script ${scripts})
      file(READ "${FOLDER}/${script}" more HEX)
      string(APPEND hex "${more}")
    endforeach()
  endif()
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${hex}")
  string(REPEAT "." 112 some)
  string(REGEX REPLACE "(${some})" "\\1\n" bytes "${bytes}")
  string(APPEND code "const char ${part}[] = {\n${bytes}};\n")
endforeach()
string(APPEND code "
}  // namespace

PageFiles page_files() noexcept {
  return {{html, sizeof(html)}, {style, sizeof(style)}, {script, sizeof(script)}};
}

}  // namespace seqloop::program
")
file(WRITE "${OUTPUT}" "${code}")
