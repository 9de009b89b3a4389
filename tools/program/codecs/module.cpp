// SPDX-License-Identifier: MIT
// The module: OpenCV's table of codecs, and a name to find it by.
#include "program/codecs/module.hpp"

extern "C" const seqloop::opencv::FileCodecs* seqloop_file_codecs() {
  return &seqloop::opencv::file_codecs();
}
