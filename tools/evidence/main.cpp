// SPDX-License-Identifier: MIT
// Writes the evidence for the likeliest row of each frame of a drive, as a CSV file to standard
// output. Default settings; without a reference the drive closes loops.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "program/drives/match_drive.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/files/npy_file.hpp"

namespace {

using seqloop::files::Matrix;

void write(const Matrix& query, std::optional<Matrix> reference) {
  seqloop::MatcherConfig config;
  config.use = reference ? seqloop::Use::localise : seqloop::Use::close_loops;
  seqloop::PlaceMap map = seqloop::program::map_for(config, std::move(reference), query);
  seqloop::Detector detector(config, map);
  std::puts("frame,place,odds,known,lead,contrast,in_step,age,margin,doubt,unlike");
  for (std::size_t i = 0; i < query.rows; ++i) {
    const seqloop::FrameReport report = detector.step(query.row(i));
    if (!report.now) continue;
    const seqloop::Evidence& e = *detector.evidence();
    std::printf("%zu,%llu,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", i,
                0ULL + report.now->place, e.odds, e.known, e.lead, e.contrast, e.in_step, e.age,
                e.margin, e.doubt, e.unlike);
  }
}

}  // namespace

int main(int count, char** words) {
  const std::span<char*> all(words, static_cast<std::size_t>(count));
  const bool asks_for_help = count == 2 && std::string_view(all[1]) == "--help";
  if ((count != 2 && count != 3) || asks_for_help) {
    std::fputs("usage: seqloop-evidence QUERY.npy [REFERENCE.npy]\n",
               asks_for_help ? stdout : stderr);
    return asks_for_help ? 0 : 2;
  }
  try {
    std::optional<Matrix> reference;
    if (count == 3) reference = seqloop::files::read_npy(all[2]);
    write(seqloop::files::read_npy(all[1]), std::move(reference));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "seqloop-evidence: %s\n", error.what());
    return 2;
  }
  return 0;
}
