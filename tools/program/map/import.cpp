// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/csv.hpp"
#include "evaluation/line_faults.hpp"
#include "files/npy_header.hpp"
#include "files/text_file.hpp"
#include "program/map/exchange.hpp"
#include "program/map/map_json.hpp"
#include "program/map/new_map.hpp"
#include "program/options/verb.hpp"
#include "program/process/interruption.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {
namespace {

namespace fs = std::filesystem;
using evaluation::CsvRow;
using evaluation::CsvTable;
using evaluation::LineFaults;
using sqlite::MapFile;
using sqlite::PlaceRecord;
using sqlite::SavedLink;

/// A file of any size. Throws SetupError.
std::string bytes_of(const fs::path& file) {
  return files::read_bytes(file, std::numeric_limits<std::uintmax_t>::max());
}

/// A place's picture, which others show as they are told.
std::vector<std::byte> jpeg_in(const fs::path& file) {
  const std::string jpeg = bytes_of(file);
  if (!jpeg.starts_with("\xFF\xD8\xFF")) {
    throw SetupError({file.string(), "is no JPEG picture", "replace it, or remove it"});
  }
  const auto bytes = std::as_bytes(std::span(jpeg));
  return {bytes.begin(), bytes.end()};
}

/// Where the bytes of a session's places begin in their file. Throws SetupError.
/// @param bytes that they must be; nothing: it is not known
std::uint64_t begin_of_places(const fs::path& file, const std::optional<std::uint64_t>& bytes) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);  // of a pipe, an error
  std::ifstream stream;
  if (!error) stream.open(file, std::ios::binary);
  if (!stream.is_open()) throw SetupError({file.string(), "cannot be read", give_an_export});
  std::array<char, 12> start{};
  stream.read(start.data(), start.size());
  const std::uint64_t from = files::npy_data_offset(
      std::span(start).first(static_cast<std::size_t>(stream.gcount())), file.string());
  if (from > size) throw SetupError({file.string(), "ends within its header", give_an_export});
  if (bytes && size - from != *bytes) {
    throw SetupError(
        {file.string(), fmt::format("its numbers are not the {} of the places in places.csv",
                                    counted(*bytes, "byte"))});
  }
  return from;
}

/// What belongs to one session.
struct Part {
  std::vector<PlaceRecord> records;
  std::vector<SavedLink> links;
  std::vector<sqlite::SavedThumbnail> thumbnails;
};

/// A folder that is imported: all that is wrong with it is found before a map is made.
class Exported {
 public:
  explicit Exported(fs::path folder) : folder_(std::move(folder)) {}

  void look(Faults& faults) {
    const std::size_t others = faults.size();
    map_ = read_map_json(folder_ / "map.json", faults);
    const bool form_known = faults.size() == others;
    const std::size_t before = faults.size();
    collect(faults, [this] { read_places(); });
    collect(faults, [this] { check_sessions_order(); });
    places_known_ = faults.size() == before;
    collect(faults, [this] { read_links(); });
    collect(faults, [this] { read_thumbnails(); });
    collect(faults, [&] { check_places(form_known && places_known_); });
  }

  void write(MapFile& map) {
    for (std::size_t i = 0; i < map_.sessions->size(); ++i) {
      stop_if_interrupted();
      const DescribedSession& session = (*map_.sessions)[i];
      const Part part = std::move(parts_[i + 1]);
      const std::int64_t id = map.begin_session(session.name, session.began_ns, session.settings);
      const fs::path file = npy_of(i + 1);
      const std::uint64_t from =
          begin_of_places(file, part.records.size() * map.form().place_bytes);
      const std::string places = bytes_of(file);
      // It may have become shorter.
      const auto begin = static_cast<std::size_t>(std::min<std::uint64_t>(from, places.size()));
      map.save(id, {.frames = session.frames,
                    .records = part.records,
                    .places = std::as_bytes(std::span(places)).subspan(begin),
                    .links = part.links,
                    .thumbnails = part.thumbnails,
                    .statistics = session.statistics ? &*session.statistics : nullptr});
    }
  }

  [[nodiscard]] const sqlite::MapForm& form() const { return map_.form; }

 private:
  static CsvTable table_of(const fs::path& file) {
    constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30U;
    return {files::read_text(file, most_bytes), file.string()};
  }

  [[nodiscard]] fs::path npy_of(std::uint64_t session) const {
    return folder_ / fmt::format("session-{}.npy", session);
  }

  /// The part of a row's session. Throws SetupError: there is none.
  Part& part_of(const CsvRow& row, std::uint64_t session) {
    const std::uint64_t most = map_.sessions ? map_.sessions->size() : sqlite::number_end;
    if (session >= 1 && session <= most) return parts_[session];
    throw SetupError({row.where(),
                      fmt::format("session {} is not in map.json", session) +
                          (map_.sessions ? ", which has " + counted(most, "session") : ""),
                      "they are counted from 1"});
  }

  /// Throws SetupError.
  static void check_below_end(const CsvRow& row, const char* what, std::uint64_t number) {
    if (number < sqlite::number_end) return;
    throw SetupError({row.where(), fmt::format("{} {} is too high", what, number),
                      fmt::format("write one below {}", sqlite::number_end)});
  }

  void read_places() {
    const CsvTable table = table_of(folder_ / "places.csv");
    const auto column = table.columns({"place", "session", "frame", "time_ns"});
    table.for_each_row([&](CsvRow& row) {
      const PlaceRecord place{row.whole(column[0]), row.whole(column[2]), row.integer(column[3])};
      const std::uint64_t session = row.whole(column[1]);
      if (!row.faults().empty()) return;
      check_below_end(row, "place", place.number);
      check_below_end(row, "frame", place.frame);
      std::vector<PlaceRecord>& records = part_of(row, session).records;
      // The next one is compared with it, whatever is wrong with it: that is told once.
      records.push_back(place);
      if (records.size() > 1) check_follows(row, place, records[records.size() - 2]);
    });
  }

  /// Throws SetupError.
  static void check_follows(const CsvRow& row, const PlaceRecord& place,
                            const PlaceRecord& before) {
    if (sqlite::can_follow(place, before)) return;
    if (place.number <= before.number) {
      throw SetupError({row.where(),
                        fmt::format("place {} stands behind place {} of its session", place.number,
                                    before.number),
                        "list places in the order of their numbers"});
    }
    throw SetupError({row.where(),
                      fmt::format("frame {} of place {} is not above frame {} of place {}",
                                  place.frame, place.number, before.frame, before.number),
                      "list places of a session in the order of their frames"});
  }

  /// Throws SetupError.
  void check_sessions_order() const {
    const Part* before = nullptr;
    for (const auto& [session, part] : parts_) {
      if (part.records.empty()) continue;
      const std::uint64_t first = part.records.front().number;
      if (before != nullptr && first <= before->records.back().number) {
        throw SetupError(
            {(folder_ / "places.csv").string(),
             fmt::format("place {} of session {} is not above place {} of one before it", first,
                         session, before->records.back().number),
             "sessions stand in the order of their places' numbers"});
      }
      before = &part;
    }
  }

  void read_links() {
    const CsvTable table = table_of(folder_ / "links.csv");
    const auto column =
        table.columns({"session", "frame", "visit", "place", "other", "probability"});
    table.for_each_row([&](CsvRow& row) {
      const std::uint64_t session = row.whole(column[0]);
      SavedLink link{static_cast<std::int64_t>(session), row.whole(column[1]), std::nullopt,
                     row.whole(column[4]), row.number(column[5])};
      const bool visit = row.flag(column[2]);
      const std::uint64_t place = row.whole(column[3]);
      if (!row.faults().empty()) return;
      if (!visit) link.place = place;
      Part& part = part_of(row, session);
      check_below_end(row, "frame", link.frame);
      check_below_end(row, "place", place);
      check_below_end(row, "place", link.other);
      check_probability(row, link);
      if (visit && place != 0) {
        throw SetupError({row.where(),
                          fmt::format("a visit has no place of its own, and this has {}", place),
                          "write 0, or no visit"});
      }
      if (!visit && places_known_) check_own_place(row, session, link);
      part.links.push_back(link);
    });
  }

  /// Throws SetupError.
  static void check_probability(const CsvRow& row, const SavedLink& link) {
    const double said = link.probability;
    const bool is_word =
        !link.place && (said == sqlite::person_accepted || said == sqlite::person_rejected);
    if (is_word || (said >= 0.0 && said <= 1.0)) return;
    throw SetupError({row.where(), fmt::format("its probability is {}", said),
                      fmt::format("write a number from 0 to 1, or, of a visit, a person's word: {} "
                                  "or {}",
                                  sqlite::person_accepted, sqlite::person_rejected)});
  }

  /// What a frame became itself is a place of this frame, or it is gone. Throws SetupError.
  void check_own_place(const CsvRow& row, std::uint64_t session, const SavedLink& link) const {
    for (const auto& [other, part] : parts_) {
      const auto found =
          std::ranges::lower_bound(part.records, *link.place, {}, &PlaceRecord::number);
      if (found == part.records.end() || found->number != *link.place) continue;
      if (other == session && found->frame == link.frame) return;
      throw SetupError(
          {row.where(), other == session
                            ? fmt::format("place {} is frame {} of its session, and not {}",
                                          found->number, found->frame, link.frame)
                            : fmt::format("place {} is of session {}, and not of {}", found->number,
                                          other, session)});
    }
  }

  void read_thumbnails() {
    LineFaults faults(folder_.string());
    for (auto& [session, part] : parts_) {
      for (const PlaceRecord& place : part.records) {
        const fs::path picture = folder_ / fmt::format("thumbnail-{}.jpg", place.number);
        if (!fs::exists(picture)) continue;
        faults.collect([&, &its = part] {
          its.thumbnails.push_back({place.number, jpeg_in(picture)});
        });
      }
    }
    faults.refuse();
  }

  /// @param sizes whether it is known how large they must be
  void check_places(bool sizes) {
    if (!map_.sessions) return;
    LineFaults faults(folder_.string());
    for (std::uint64_t session = 1; session <= map_.sessions->size(); ++session) {
      stop_if_interrupted();
      std::optional<std::uint64_t> bytes;
      if (sizes) bytes = parts_[session].records.size() * map_.form.place_bytes;
      faults.collect([&] { static_cast<void>(begin_of_places(npy_of(session), bytes)); });
    }
    faults.refuse();
  }

  fs::path folder_;
  DescribedMap map_;
  bool places_known_ = false;
  std::map<std::uint64_t, Part> parts_;  // by session, from 1 on
};

}  // namespace

void import_map(const fs::path& folder, const fs::path& out) {
  Faults faults;
  std::optional<NewMap> made;
  collect(faults, [&] { made.emplace(out); });
  Exported found(folder);
  std::error_code error;
  if (fs::is_directory(folder, error)) {
    found.look(faults);
  } else {
    faults.push_back({folder.string(), "is no folder", give_an_export});
  }
  refuse(std::move(faults));
  try {
    made->make([&] { found.write(made->open(found.form())); });
  } catch (const std::invalid_argument&) {
    throw SetupError(
        {folder.string(), "its places and links do not fit each other", give_an_export});
  }
}

}  // namespace seqloop::program
