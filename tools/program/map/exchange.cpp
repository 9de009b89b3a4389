// SPDX-License-Identifier: MIT
#include "program/map/exchange.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "files/npy_header.hpp"
#include "files/output_folder.hpp"
#include "files/text_file.hpp"
#include "program/map/new_map.hpp"
#include "program/options/verb.hpp"
#include "program/process/interruption.hpp"
#include "program/process/json_text.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {
namespace {

namespace fs = std::filesystem;
using sqlite::MapFile;
using sqlite::MapForm;

constexpr const char* places_header = "place,session,frame,time_ns";
constexpr const char* links_header = "session,frame,visit,place,other,probability";

/// NumPy's type of what places consist of, as far as their size tells.
std::pair<std::string, std::uint64_t> type_of(const MapForm& form) {
  if (form.place_bytes == form.descriptor_size) return {"|i1", form.place_bytes};
  if (form.place_bytes == 4 * form.descriptor_size) return {"<f4", form.descriptor_size};
  return {"|u1", form.place_bytes};
}

std::string npy_header(const MapForm& form, std::uint64_t rows) {
  const auto& [type, columns] = type_of(form);
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}",
                                 type, rows, columns);
  text.resize(117, ' ');  // 128 bytes with what stands before and behind
  return std::string("\x93NUMPY\x01\x00", 8) + '\x76' + '\0' + text + '\n';
}

nlohmann::json described(const MapFile& map, const sqlite::SessionFacts& facts) {
  nlohmann::json json{{"name", facts.name},
                      {"began_ns", facts.began_ns},
                      {"settings", facts.settings},
                      {"frames", facts.frames}};
  if (const auto statistics = map.statistics(facts.id)) {
    json["statistics"] = {{"frames", statistics->frames},
                          {"mean", statistics->mean},
                          {"variance", statistics->variance}};
  }
  return json;
}

constexpr const char* exported = "name a folder that `seqloop map export` wrote";

/// The cells of a table under a header that must be this one. Throws SetupError.
std::vector<std::vector<std::string>> cells_of(const fs::path& file, const std::string& header) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30U;
  std::istringstream stream(files::read_text(file, most_bytes));
  std::string line;
  // Spreadsheets end lines as Windows does.
  const auto take = [&] {
    if (!std::getline(stream, line)) return false;
    if (line.ends_with('\r')) line.pop_back();
    return true;
  };
  if (!take() || line != header) {
    throw SetupError({file.string(), "does not begin with the line " + header, exported});
  }
  std::vector<std::vector<std::string>> rows;
  while (take()) {
    std::vector<std::string> cells(1);
    for (const char letter : line) {
      if (letter == ',') {
        cells.emplace_back();
      } else {
        cells.back() += letter;
      }
    }
    rows.push_back(std::move(cells));
  }
  return rows;
}

template <class Number>
Number number_in(const fs::path& file, std::size_t row, const std::string& cell) {
  Number number{};
  const char* end = cell.data() + cell.size();
  const auto [stopped, error] = std::from_chars(cell.data(), end, number);
  if (error != std::errc() || stopped != end) {
    throw SetupError({fmt::format("{}:{}", file.string(), row + 2), "'" + cell + "' is no number"});
  }
  return number;
}

void check_cells(const fs::path& file, const std::vector<std::vector<std::string>>& rows,
                 std::size_t columns) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() == columns) continue;
    throw SetupError({fmt::format("{}:{}", file.string(), i + 2),
                      fmt::format("{} and not {}", counted(rows[i].size(), "cell"), columns)});
  }
}

std::vector<std::byte> bytes_of(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);  // of a pipe, an error
  std::ifstream stream;
  if (!error) stream.open(file, std::ios::binary);
  std::vector<std::byte> bytes(error ? 0 : static_cast<std::size_t>(size));
  if (error || !stream.read(reinterpret_cast<char*>(bytes.data()),
                            static_cast<std::streamsize>(bytes.size()))) {
    throw SetupError({file.string(), "cannot be read", exported});
  }
  return bytes;
}

/// A place's picture, which others show as they are told.
std::vector<std::byte> jpeg_in(const fs::path& file) {
  constexpr std::array start{std::byte{0xFF}, std::byte{0xD8}, std::byte{0xFF}};
  std::vector<std::byte> jpeg = bytes_of(file);
  if (std::ranges::mismatch(start, jpeg).in1 != start.end()) {
    throw SetupError({file.string(), "is no JPEG picture", "replace it, or remove it"});
  }
  return jpeg;
}

/// The bytes of a session's places.
std::vector<std::byte> places_in(const fs::path& file, std::uint64_t bytes) {
  std::vector<std::byte> all = bytes_of(file);
  std::string start;
  for (const std::byte byte : std::span(all).first(std::min<std::size_t>(all.size(), 12))) {
    start += std::to_integer<char>(byte);
  }
  const std::uint64_t from = files::npy_data_offset(start, file.string());
  if (from > all.size() || all.size() - from != bytes) {
    throw SetupError(
        {file.string(), fmt::format("its numbers are not the {} of the places in places.csv",
                                    counted(bytes, "byte"))});
  }
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(from));
  return all;
}

/// What belongs to one session.
struct Part {
  std::vector<sqlite::PlaceRecord> records;
  std::vector<sqlite::SavedLink> links;
  std::vector<sqlite::SavedThumbnail> thumbnails;
};

std::map<std::int64_t, Part> parts_of(const fs::path& folder) {
  std::map<std::int64_t, Part> parts;
  const fs::path places = folder / "places.csv";
  const auto rows = cells_of(places, places_header);
  check_cells(places, rows, 4);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto number = number_in<std::uint64_t>(places, i, rows[i][0]);
    Part& part = parts[number_in<std::int64_t>(places, i, rows[i][1])];
    if (!part.records.empty() && number <= part.records.back().number) {
      throw SetupError({fmt::format("{}:{}", places.string(), i + 2),
                        fmt::format("place {} stands behind place {} of its session", number,
                                    part.records.back().number),
                        "list places in the order of their numbers"});
    }
    part.records.push_back({number, number_in<std::uint64_t>(places, i, rows[i][2]),
                            number_in<std::int64_t>(places, i, rows[i][3])});
    const fs::path picture = folder / fmt::format("thumbnail-{}.jpg", number);
    if (fs::exists(picture)) part.thumbnails.push_back({number, jpeg_in(picture)});
  }
  const Part* before = nullptr;
  for (const auto& [session, part] : parts) {
    if (part.records.empty()) continue;
    const std::uint64_t first = part.records.front().number;
    if (before != nullptr && first <= before->records.back().number) {
      throw SetupError({places.string(),
                        fmt::format("place {} of session {} is not above place {} of one before it",
                                    first, session, before->records.back().number),
                        "sessions stand in the order of their places' numbers"});
    }
    before = &part;
  }
  const fs::path links = folder / "links.csv";
  const auto found = cells_of(links, links_header);
  check_cells(links, found, 6);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::vector<std::string>& row = found[i];
    sqlite::SavedLink link{number_in<std::int64_t>(links, i, row[0]),
                           number_in<std::uint64_t>(links, i, row[1]), std::nullopt,
                           number_in<std::uint64_t>(links, i, row[4]),
                           number_in<double>(links, i, row[5])};
    if (row[2] == "0") link.place = number_in<std::uint64_t>(links, i, row[3]);
    parts[link.session].links.push_back(link);
  }
  return parts;
}

/// The names of sessions, each of which must be another. Throws SetupError.
void check_names(const nlohmann::json& sessions, const fs::path& file) {
  std::set<std::string> names;
  for (const nlohmann::json& session : sessions) {
    const std::string name = session.at("name");
    if (name.empty() || !names.insert(name).second) {
      throw SetupError(
          {file.string(),
           name.empty() ? "a session has no name" : "two sessions have the name '" + name + "'",
           "give it another"});
    }
  }
}

void import_sessions(const nlohmann::json& json, const fs::path& folder, MapFile& map) {
  std::map<std::int64_t, Part> parts = parts_of(folder);
  std::int64_t number = 0;
  for (const nlohmann::json& said : json.at("sessions")) {
    stop_if_interrupted();
    const Part& part = parts[++number];
    const std::int64_t id =
        map.begin_session(said.at("name"), said.at("began_ns"), said.at("settings"));
    std::optional<sqlite::SavedStatistics> statistics;
    if (said.contains("statistics")) {
      const nlohmann::json& values = said.at("statistics");
      statistics = {values.at("frames"), values.at("mean"), values.at("variance")};
    }
    const std::vector<std::byte> places = places_in(folder / fmt::format("session-{}.npy", number),
                                                    part.records.size() * map.form().place_bytes);
    map.save(id, {.frames = said.at("frames"),
                  .records = part.records,
                  .places = places,
                  .links = part.links,
                  .thumbnails = part.thumbnails,
                  .statistics = statistics ? &*statistics : nullptr});
    parts.erase(number);
  }
  if (!parts.empty()) {
    throw SetupError({(folder / "places.csv").string(),
                      fmt::format("session {} is not in map.json", parts.begin()->first)});
  }
}

}  // namespace

void export_map(const MapFile& map, const fs::path& folder) {
  files::OutputFolder out(folder);
  const MapForm& form = map.form();
  nlohmann::json json{{"form", form.form},
                      {"describer", form.describer},
                      {"descriptor_size", form.descriptor_size},
                      {"place_bytes", form.place_bytes},
                      {"sessions", nlohmann::json::array()}};
  std::map<std::int64_t, std::int64_t> numbers;  // of sessions, from 1 on without gaps
  for (const sqlite::SessionFacts& facts : map.sessions()) {
    numbers.emplace(facts.id, static_cast<std::int64_t>(numbers.size()) + 1);
    json["sessions"].push_back(described(map, facts));
  }
  out.write("map.json", json_text(json, 2) + '\n');

  std::string table = std::string(places_header) + '\n';
  std::map<std::int64_t, std::pair<std::string, std::uint64_t>> open;  // bytes and rows
  const auto close = [&] {
    for (const auto& [number, content] : open) {
      out.write(fmt::format("session-{}.npy", number),
                npy_header(form, content.second) + content.first);
    }
    open.clear();
  };
  std::int64_t newest = 0;
  map.read([&](const sqlite::PlaceBlock& block) {
    stop_if_interrupted();
    const std::int64_t session = numbers.at(block.session);
    if (session != std::exchange(newest, session)) close();
    auto& [bytes, rows] = open[session];
    bytes.append(reinterpret_cast<const char*>(block.places.data()), block.places.size());
    rows += block.records.size();
    for (const sqlite::PlaceRecord& record : block.records) {
      table += fmt::format("{},{},{},{}\n", record.number, session, record.frame, record.time_ns);
    }
  });
  close();
  for (const sqlite::SessionFacts& facts : map.sessions()) {
    if (facts.places > 0) continue;
    out.write(fmt::format("session-{}.npy", numbers.at(facts.id)), npy_header(form, 0));
  }
  out.write("places.csv", table);

  table = std::string(links_header) + '\n';
  map.read_links([&](const sqlite::SavedLink& link) {
    if (!numbers.contains(link.session)) {
      throw SetupError({map.path().string(), "a link belongs to no session",
                        "`seqloop map recover` copies what is whole into a new file"});
    }
    table += fmt::format("{},{},{},{},{},{}\n", numbers.at(link.session), link.frame,
                         link.place ? 0 : 1, link.place.value_or(0), link.other, link.probability);
  });
  out.write("links.csv", table);
  map.read_thumbnails([&](const sqlite::SavedThumbnail& picture) {
    out.write(fmt::format("thumbnail-{}.jpg", picture.place), picture.jpeg);
  });
  out.commit();
}

void import_map(const fs::path& folder, const fs::path& out) {
  const fs::path file = folder / "map.json";
  Faults faults;
  std::optional<NewMap> made;
  nlohmann::json json;
  collect(faults, [&] { made.emplace(out); });
  collect(faults, [&] {
    std::ifstream stream(file);
    if (!stream) throw SetupError({file.string(), "cannot be read", exported});
    json = nlohmann::json::parse(stream, nullptr, false);
    if (!json.is_object()) throw SetupError({file.string(), "is no JSON object", exported});
  });
  refuse(std::move(faults));
  try {
    MapFile& map = made->open({json.at("form"), json.at("describer"), json.at("descriptor_size"),
                               json.at("place_bytes")});
    check_names(json.at("sessions"), file);
    import_sessions(json, folder, map);
    made->commit();
  } catch (const nlohmann::json::exception& error) {
    // In front stands the library's own number of the error.
    const std::string why = error.what();
    throw SetupError(
        {file.string(), "is not what an export says: " + why.substr(why.find("] ") + 2), exported});
  } catch (const std::invalid_argument&) {
    throw SetupError({folder.string(), "its places and links do not fit each other", exported});
  }
}

}  // namespace seqloop::program
