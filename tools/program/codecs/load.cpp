// SPDX-License-Identifier: MIT
// OpenCV's readers of pictures and videos bring 220 libraries with them: more than nine tenths of
// the time that the program takes to start, for nothing where a camera's own pictures are looked
// at. So they are in a module, which is loaded once a file is to be read or written with them.
#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <string>

#include "program/codecs/module.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::opencv {
namespace {

namespace fs = std::filesystem;

/// From the program's folder: where it was built, and where it was installed.
constexpr std::array folders{".", SEQLOOP_MODULES_FROM_PROGRAM};

const FileCodecs& load() {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  std::string why;
  for (const char* folder : folders) {
    const fs::path file = (program / folder / SEQLOOP_MODULE).lexically_normal();
    if (!fs::exists(file, unknown)) continue;
    // Never closed: OpenCV's threads and caches outlive their use.
    void* const module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const found = module == nullptr ? nullptr : dlsym(module, "seqloop_file_codecs");
    if (found != nullptr) return *reinterpret_cast<decltype(&seqloop_file_codecs)>(found)();
    why = dlerror();
  }
  throw SetupError(Fault{SEQLOOP_MODULE,
                         why.empty()
                             ? "is not there, so no file of a picture or a video can be read"
                             : "cannot be loaded: " + why,
                         "put it beside the program, or install seqloop again"});
}

}  // namespace

const FileCodecs& file_codecs() {
  static const FileCodecs& codecs = load();
  return codecs;
}

}  // namespace seqloop::opencv
