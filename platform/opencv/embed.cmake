# SPDX-License-Identifier: MIT
# Turns a file into C++:  cmake -D INPUT=file -D OUTPUT=file.cpp -P embed.cmake
file(READ "${INPUT}" bytes HEX)
if(bytes STREQUAL "")
  message(FATAL_ERROR "${INPUT} is empty")
endif()
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REPEAT "." 80 sixteen_bytes)
string(REGEX REPLACE "(${sixteen_bytes})" "\\1\n" bytes "${bytes}")
file(WRITE "${OUTPUT}" "// Made by embed.cmake; not to be edited.
#include \"opencv/detail/builtin_model.hpp\"

namespace seqloop::opencv {
namespace {

constexpr unsigned char model_file[] = {
${bytes}};

}  // namespace

std::span<const unsigned char> builtin_model() noexcept { return model_file; }

}  // namespace seqloop::opencv
")
