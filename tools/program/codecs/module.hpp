// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/opencv/file_codecs.hpp"

/// What the module hands over. It lies beside the program where that was built, and in a folder of
/// its own where it was installed.
extern "C" const seqloop::opencv::FileCodecs* seqloop_file_codecs();
