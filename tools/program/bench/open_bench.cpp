// SPDX-License-Identifier: MIT
#include "program/bench/open_bench.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "program/map/lasting_map.hpp"
#include "program/map/place_form.hpp"
#include "program/process/available_memory.hpp"
#include "program/process/say.hpp"
#include "seqloop/linux/touched_memory.hpp"
#include "seqloop/place_map.hpp"
#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t places_a_batch = 250;  // ten seconds of driving; 25 read as fast

/// A folder of its own, removed with what is in it.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "seqloop-bench-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  Folder(Folder&&) = delete;
  Folder& operator=(Folder&&) = delete;
  ~Folder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  [[nodiscard]] fs::path file() const { return path_ / "map.seqloop"; }

 private:
  fs::path path_;
};

/// A map as the program keeps one by default.
std::unique_ptr<LastingMap> open(const fs::path& file, std::size_t descriptor_size,
                                 bool read_only) {
  MapSettings settings;
  settings.file = file;
  settings.read_only = read_only;
  return open_map(settings, MatcherConfig{}, descriptor_size, "bench");
}

void write(const fs::path& file, const Capacity& size) {
  // Its file does not stay: no session comes into it.
  const PlaceForm form = open(file, size.descriptor_size, false)->form();
  sqlite::MapFile map = sqlite::MapFile::open(
      file, sqlite::MapForm{form.form, form.describer, form.descriptor_size, form.place_bytes});
  const std::int64_t session = map.begin_session("bench", 0, "");
  std::vector<std::byte> places(places_a_batch * size.descriptor_size);
  std::vector<sqlite::PlaceRecord> records(places_a_batch);
  std::uint32_t state = 1;
  for (std::size_t first = 0; first < size.places; first += places_a_batch) {
    const std::size_t count = std::min(places_a_batch, size.places - first);
    for (std::byte& byte : places) {
      state = state * 1664525U + 1013904223U;
      byte = static_cast<std::byte>(state >> 25U);  // none is -128, which no value of a place is
    }
    for (std::size_t i = 0; i < count; ++i) records[i] = {first + i, first + i, 0};
    map.save(session, {.frames = first + count,
                       .records = std::span(records).first(count),
                       .places = std::span(places).first(count * size.descriptor_size)});
  }
}

/// Has the system forget what it keeps of a file, as far as it does.
void drop(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  (void)::fdatasync(descriptor);
  (void)::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  ::close(descriptor);
}

/// Where places go to, each page of it touched.
struct Opened {
  explicit Opened(const Capacity& capacity)
      : memory(PlaceMap::bytes_needed(MatcherConfig{}, capacity)),
        map(MatcherConfig{}, capacity, memory.span(), true) {}

  live::TouchedMemory memory;
  PlaceMap map;
};

void read_plainly(const fs::path& file, std::vector<std::byte>& piece) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  while (::read(descriptor, piece.data(), piece.size()) > 0) {
  }
  ::close(descriptor);
}

}  // namespace

void time_opening(const Capacity& size, std::size_t rounds, std::vector<Contender>& timed) {
  const std::uint64_t bytes = std::uint64_t{size.places} * size.descriptor_size;
  if (!fits_memory(bytes + PlaceMap::bytes_needed(MatcherConfig{}, size), "open")) return;
  const Folder folder;
  const fs::path file = folder.file();
  say("open: writing {} MB to {}", bytes / 1'000'000, file.string());
  write(file, size);
  std::vector<std::byte> memory(static_cast<std::size_t>(bytes));
  std::vector<std::byte> piece(std::size_t{1} << 20U);
  const auto copy = [&] {
    auto to = memory.begin();
    sqlite::MapFile::read_only(file).read(
        [&to](const sqlite::PlaceBlock& block) { to = std::ranges::copy(block.places, to).out; });
  };
  std::optional<Opened> opened;
  const auto open_as_program = [&] {
    const std::unique_ptr<LastingMap> saved = open(file, size.descriptor_size, true);
    saved->load(opened.emplace(saved->capacity(0)).map);
    opened->memory.wait();
  };
  const auto forget = [&] {
    opened.reset();
    drop(file);
  };
  std::vector<Contender> contenders;
  const auto add = [&](const char* by, std::function<void()> round) {
    contenders.push_back({"open", by, size.places, size.descriptor_size, fs::file_size(file),
                          std::move(round), forget});
  };
  add("seqloop-map-file", copy);
  add("seqloop-map-ready", open_as_program);
  add("plain-read", [&] { read_plainly(file, piece); });
  time_in_turn(std::move(contenders), rounds, timed, {1, 1});
}

}  // namespace seqloop::program
