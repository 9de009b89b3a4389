// SPDX-License-Identifier: MIT
#include "program/map/lasting_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "program/map/map_writer.hpp"
#include "program/map/stored_map.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::program {
namespace {

using Json = nlohmann::ordered_json;

/// Thumbnails in a file that somebody may be writing just now.
class SavedPictures : public PlacePictures {
 public:
  explicit SavedPictures(std::filesystem::path file) : file_(std::move(file)) {}

  [[nodiscard]] std::vector<std::uint64_t> around(std::uint64_t place) const override {
    return sqlite::MapFile::read_only(file_).thumbnails_around(place);
  }

  [[nodiscard]] std::string jpeg(std::uint64_t place) const override {
    const auto saved = sqlite::MapFile::read_only(file_).thumbnail(place);
    if (!saved) return {};
    std::string bytes(saved->jpeg.size(), '\0');
    std::ranges::transform(saved->jpeg, bytes.begin(),
                           [](std::byte byte) { return static_cast<char>(byte); });
    return bytes;
  }

 private:
  // Opened for each look: as long as somebody reads, the log beside the map grows.
  std::filesystem::path file_;
};

/// Opened anew: the file itself belongs to the thread that saves.
void read_places(const std::filesystem::path& path, std::size_t most,
                 const SavedPlaceReader& read) {
  const sqlite::MapFile file = sqlite::MapFile::read_only(path);
  std::map<std::int64_t, sqlite::SessionFacts> sessions;
  for (sqlite::SessionFacts& facts : file.sessions()) {
    if (facts.places > 0) sessions[facts.id] = std::move(facts);
  }
  while (sessions.size() > most) sessions.erase(sessions.begin());
  const auto bytes = static_cast<std::size_t>(file.form().place_bytes);
  file.read([&](const sqlite::PlaceBlock& block) {
    const auto found = sessions.find(block.session);
    if (found == sessions.end()) return;
    const sqlite::SessionFacts& session = found->second;
    for (std::size_t i = 0; i < block.records.size(); ++i) {
      const sqlite::PlaceRecord& record = block.records[i];
      read({session.began_ns,
            session.name,
            record.number,
            record.frame,
            record.time_ns,
            block.places.subspan(i * bytes, bytes),
            {},
            {}});
    }
  });
  file.read_links([&](const sqlite::SavedLink& link) {
    const auto session = sessions.find(link.session);
    if (!link.place || session == sessions.end()) return;
    read({session->second.began_ns,
          session->second.name,
          *link.place,
          link.frame,
          0,
          {},
          link.other,
          {}});
  });
  for (const auto& [id, session] : sessions) {
    const auto its = file.statistics(id);
    if (!its) continue;
    SavedPlace none{session.began_ns, session.name};
    none.statistics = {its->frames, its->mean, its->variance};
    read(none);
  }
}

class SqliteMap : public LastingMap {
 public:
  SqliteMap(const MapSettings& settings, const MatcherConfig& config, std::size_t descriptor_size,
            std::string describer, JpegEncoder encode)
      : stored_(settings, config, descriptor_size, std::move(describer)),
        settings_(settings),
        encode_(encode) {}

  [[nodiscard]] std::size_t places() const noexcept override { return stored_.places(); }

  [[nodiscard]] PlaceForm form() const override { return stored_.form(); }

  [[nodiscard]] std::vector<std::int64_t> begun() const override { return stored_.begun(); }

  void read_saved(std::size_t most, const SavedPlaceReader& read) const override {
    read_places(stored_.path(), most, read);
  }

  void follow(StatisticsReader learnt) override { learnt_ = std::move(learnt); }

  void read_newest(const SavedPlaceReader& read) override {
    MapWriter* const writer = followed_.load(std::memory_order_acquire);
    if (writer != nullptr) writer->read_newest(read);
  }

  [[nodiscard]] Capacity capacity(std::size_t drive) const noexcept override {
    return stored_.capacity(drive);
  }

  void load(PlaceMap& map) override {
    map_ = &map;
    stored_.load(map);
  }

  void note(Detector& detector, std::uint64_t counted, std::uint64_t index, double time_s,
            const Image& image, std::span<const Answer> answers, bool readable) noexcept override {
    if (writer_) writer_->note(detector, counted, index, time_s, image, answers, readable);
  }

  [[nodiscard]] std::optional<std::string> finish(Detector& detector,
                                                  std::span<const Answer> rest) override {
    return writer_ ? writer_->finish(detector, rest) : std::nullopt;
  }

  void discard() override {
    if (!writer_) return;
    writer_->stop();
    stored_.forget_session();
  }

  [[nodiscard]] std::optional<std::string> trouble() override {
    return writer_ ? writer_->trouble() : std::nullopt;
  }

  [[nodiscard]] std::uint64_t saved() const noexcept override {
    return writer_ ? writer_->saved() : 0;
  }

  [[nodiscard]] std::vector<Session> sessions() const override {
    const PlaceOrder& order = map_->order();
    std::vector<Session> all;
    for (std::size_t session = 0; session < order.sessions(); ++session) {
      const std::size_t row = order.session(session).first;
      all.push_back(
          {stored_.name(session), row < order.size() ? order.number(row) : order.next_number()});
    }
    return all;
  }

  bool save_now() override { return writer_ && writer_->save_now(); }

  bool judge(std::uint64_t frame, std::uint64_t place, Verdict verdict) override {
    return writer_ && writer_->judge(frame, place, verdict);
  }

  [[nodiscard]] Seen where(std::uint64_t number) const override {
    const PlaceOrder& order = map_->order();
    const std::size_t session = order.session_of_number(number);
    Seen seen{stored_.name(session), std::nullopt};
    if (const auto row = order.row_of_number(number)) {
      const bool running = writer_ && session + 1 == order.sessions();
      seen.frame = running ? writer_->source_frame(*row) : order.frame(*row);
    }
    return seen;
  }

  [[nodiscard]] std::unique_ptr<PlacePictures> pictures() const override {
    return std::make_unique<SavedPictures>(stored_.path());
  }

  void add_to(Json& frame) const override {
    for (Json& answer : frame["answers"]) name_place(answer, "match");
    name_place(frame, "match");
    if (!frame["now"].is_null()) name_place(frame["now"], "place");
    frame["saved"] = saved();
  }

  [[nodiscard]] std::string summary() const override {
    if (!writer_) return "the map has " + counted(map_->size(), "place") + "; it was only read";
    std::uint64_t places = map_->size() - writer_->lacking();
    std::string gone;
    for (const Retired& retired : writer_->retired()) {
      places -= retired.places;
      gone += fmt::format("; of '{}' {} went, since later ones show the same, and left {}",
                          retired.session, counted(retired.places, "place"),
                          counted(retired.visits, "visit"));
    }
    std::string text = fmt::format("the map has {} now; {} {} saved, {} of them as places",
                                   counted(places, "place"), counted(writer_->saved(), "frame"),
                                   are(writer_->saved()), writer_->saved_places()) +
                       gone;
    if (const auto missing = writer_->missing_thumbnails(); missing > 0) {
      text += "; there was no room for " + counted(missing, "thumbnail");
    }
    return text;
  }

 private:
  void start(const PlaceMap& map, const MatcherConfig& config, const std::string& method) override {
    map_ = &map;
    if (stored_.read_only()) return;
    stored_.begin_session(method);
    writer_.emplace(stored_, map, config, settings_, encode_, learnt_);
    followed_.store(&*writer_, std::memory_order_release);
  }

  void end() noexcept override {
    if (!writer_) return;
    writer_->stop();
    if (writer_->saved() > 0 || writer_->saved_places() > 0) return;
    try {
      stored_.forget_session();
    } catch (const std::exception&) {  // a session of no frames is in nobody's way
    }
  }

  /// Adds the session of a place, and its frame there.
  void name_place(Json& json, const char* key) const {
    json["session"] = nullptr;
    json["session_frame"] = nullptr;
    if (json[key].is_null()) return;
    const Seen seen = where(json[key].get<std::uint64_t>());
    json["session"] = seen.session;
    if (seen.frame) json["session_frame"] = *seen.frame;
  }

  StoredMap stored_;
  MapSettings settings_;
  JpegEncoder encode_;
  StatisticsReader learnt_;
  const PlaceMap* map_ = nullptr;
  std::optional<MapWriter> writer_;
  std::atomic<MapWriter*> followed_{nullptr};  // once it is there
};

}  // namespace

std::unique_ptr<LastingMap> open_map(const MapSettings& settings, const MatcherConfig& config,
                                     std::size_t descriptor_size, std::string describer,
                                     JpegEncoder encode) {
  return std::make_unique<SqliteMap>(settings, config, descriptor_size, std::move(describer),
                                     encode);
}

}  // namespace seqloop::program
