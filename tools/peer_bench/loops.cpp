// SPDX-License-Identifier: MIT
#include "peer_bench/loops.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <ctime>
#include <memory>
#include <string>
#include <utility>

#include "peer_bench/peer.hpp"
#include "program/drives/drives.hpp"
#include "program/process/available_memory.hpp"
#include "program/process/interruption.hpp"
#include "program/process/progress.hpp"
#include "seqloop/files/output_file.hpp"

namespace seqloop::peers {
namespace {

struct Settings {
  std::filesystem::path source;
  std::filesystem::path reference;
  std::filesystem::path out;
  std::string by = "flat";
  bool standardise = false;
  std::size_t exclude = 100;
};

/// Of this thread, so that other work on the machine costs a peer nothing.
double processor_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) / 1e6;
}

/// Every frame of a drive, in order. Throws SetupError: one cannot be read.
template <class Take>
void each(const std::filesystem::path& path, const char* doing, Take take) {
  const auto drive = program::open_drive(path, "source", {});
  program::Progress progress(doing, drive->frame_count());
  Frame frame;
  for (Grab grab = drive->grab(frame); grab != Grab::end; grab = drive->grab(frame)) {
    program::stop_if_interrupted();
    if (grab != Grab::frame) {
      throw SetupError({path.string(), "frame " + std::to_string(frame.index) + " cannot be read",
                        "leave it out of the drive"});
    }
    take(frame);
    progress.step();
  }
  progress.done();
}

std::unique_ptr<Peer> make_peer(const Settings& settings, bool closing) {
  if (settings.by == "words") return bag_of_words(settings.exclude);
  return nearest_neighbour(settings.by == "hnsw", settings.standardise, closing, settings.exclude);
}

void loops(const Settings& settings, Faults faults) {
  program::take_interruptions();
  const bool closing = settings.reference.empty();
  if (settings.by != "flat" && settings.by != "hnsw" && settings.by != "words") {
    faults.push_back({"by", "'" + settings.by + "' is none of flat, hnsw and words"});
  }
  if (settings.source.empty()) faults.push_back({"source", "not given", "--source DRIVE"});
  std::unique_ptr<files::OutputFile> out;
  program::collect(faults, [&] { out = std::make_unique<files::OutputFile>(settings.out); });
  for (const auto& path : {settings.source, settings.reference}) {
    if (!path.empty() && program::is_described(path) == (settings.by == "words")) {
      faults.push_back({path.string(), settings.by == "words" ? "words need pictures"
                                                              : "FAISS needs descriptors, .npy"});
    }
  }
  program::refuse(std::move(faults));
  const std::unique_ptr<Peer> peer = make_peer(settings, closing);
  each(closing ? settings.source : settings.reference, "learning",
       [&](const Frame& frame) { peer->learn(frame); });
  peer->learnt();
  const std::uint64_t before = program::resident_memory();
  if (closing) {
    peer->begin();
  } else {
    each(settings.reference, "mapping", [&](const Frame& frame) {
      peer->see(frame);
      peer->keep();
    });
    peer->begin();
  }
  out->write("frame,place,distance,ratio,inliers,see_ms,answer_ms,bytes\n");
  std::uint64_t count = 0;
  each(settings.source, "answering", [&](const Frame& frame) {
    const double start = processor_ms();
    peer->see(frame);
    const double seen = processor_ms();
    const Guess guess = peer->find();
    if (closing) peer->keep();
    const double end = processor_ms();
    const std::uint64_t now = program::resident_memory();
    out->write(fmt::format("{},{},{:.6g},{:.6g},{},{:.4f},{:.4f},{}\n", count++,
                           guess.place ? std::to_string(*guess.place) : "",
                           guess.place ? guess.distance : 0.0, guess.ratio, guess.inliers,
                           seen - start, end - seen, now > before ? now - before : 0));
  });
  out->commit();
}

}  // namespace

program::Verb loops_verb() {
  const auto settings = std::make_shared<Settings>();
  program::Verb verb{"loops",
                     "Find places again by another method, one guess a frame",
                     {},
                     [settings](Faults faults) { loops(*settings, std::move(faults)); }};
  verb.options.section("Task");
  verb.options.path("source", program::Access::reads, settings->source,
                    "drive: descriptors, .npy; pictures for words");
  verb.options.path("reference", program::Access::reads, settings->reference,
                    "drive to localise in, likewise [close loops within the source]");
  verb.options.path("out", program::Access::writes, settings->out,
                    "guess, times and memory of each frame, CSV");
  verb.options.text("by", settings->by,
                    "flat: FAISS, exact; hnsw: FAISS, by a graph; words: ORB features as words, "
                    "checked by geometry [flat]");
  verb.options.flag("standardise", settings->standardise,
                    "FAISS: standardise descriptors as seqloop does");
  verb.options.count("exclude", settings->exclude, "newest frames that are no places [100]");
  return verb;
}

}  // namespace seqloop::peers
