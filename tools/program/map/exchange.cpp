// SPDX-License-Identifier: MIT
#include "program/map/exchange.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "files/output_folder.hpp"
#include "program/process/interruption.hpp"
#include "program/process/json_text.hpp"
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
    stop_if_interrupted();
    if (!numbers.contains(link.session)) {
      throw SetupError({map.path().string(), "a link belongs to no session",
                        "`seqloop map recover` copies what is whole into a new file"});
    }
    table += fmt::format("{},{},{},{},{},{}\n", numbers.at(link.session), link.frame,
                         link.place ? 0 : 1, link.place.value_or(0), link.other, link.probability);
  });
  out.write("links.csv", table);
  map.read_thumbnails([&](const sqlite::SavedThumbnail& picture) {
    stop_if_interrupted();
    out.write(fmt::format("thumbnail-{}.jpg", picture.place), picture.jpeg);
  });
  out.commit();
}

}  // namespace seqloop::program
