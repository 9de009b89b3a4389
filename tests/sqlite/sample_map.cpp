// SPDX-License-Identifier: MIT
#include "sqlite/sample_map.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "seqloop/fault.hpp"
#include "sqlite/checksum.hpp"
#include "sqlite/database.hpp"
#include "sqlite/state.hpp"

namespace seqloop::test {

using namespace sqlite;

MapForm sample_form() { return {"int8 euclidean", "built-in 1f00", 5, 200}; }

std::vector<std::byte> sample_place(std::uint64_t number, std::size_t bytes) {
  std::vector<std::byte> place(bytes);
  std::uint64_t state = number * 0x9E3779B97F4A7C15U + 1;
  for (std::byte& byte : place) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    byte = static_cast<std::byte>(state >> 56U);
  }
  return place;
}

void save_sample(MapFile& map, std::int64_t session, std::uint64_t frames, std::size_t places,
                 std::vector<std::uint64_t> removed, std::optional<std::uint64_t> first,
                 bool jpeg) {
  std::vector<PlaceRecord> records;
  std::vector<std::byte> bytes;
  std::vector<SavedThumbnail> pictures;
  std::vector<SavedLink> links;
  const std::uint64_t next = first.value_or(map.next_place());
  const auto size = static_cast<std::size_t>(map.form().place_bytes);
  for (std::uint64_t number = next; number < next + places; ++number) {
    records.push_back(
        {number, frames + number - next, static_cast<std::int64_t>(number) * 40 - 100});
    const std::vector<std::byte> place = sample_place(number, size);
    bytes.insert(bytes.end(), place.begin(), place.end());
  }
  if (places > 0) {
    pictures.push_back({next, sample_place(next, 700)});
    constexpr std::array start{std::byte{0xFF}, std::byte{0xD8}, std::byte{0xFF}};
    if (jpeg) std::ranges::copy(start, pictures.back().jpeg.begin());
    links.push_back({session, frames, next, next / 2, .5 + static_cast<double>(next % 50) / 100});
  }
  links.push_back({session, frames + places, std::nullopt, next / 3, .999});
  SavedStatistics statistics{frames + places, {}, {}};
  for (std::uint64_t i = 0; i < map.form().descriptor_size; ++i) {
    statistics.mean.push_back(static_cast<double>(frames + i) / 7.0);
    statistics.variance.push_back(1.0 / static_cast<double>(frames + i + 1));
  }
  map.save(session, {.frames = frames + places + 1,
                     .records = records,
                     .places = bytes,
                     .links = links,
                     .thumbnails = pictures,
                     .removed = removed,
                     .statistics = &statistics});
}

void set_frame(const std::filesystem::path& path, std::uint64_t number, std::uint64_t frame) {
  const Database database(path, SQLITE_OPEN_READWRITE);
  Statement find(database, std::string(block_columns) +
                               "FROM block WHERE first <= ? ORDER BY first DESC LIMIT 1");
  if (!find.with(signed_of(number)).step()) throw std::invalid_argument("no such place");
  BlockRow row = block_row(find);
  std::vector<PlaceRecord> records = decode_records(row.records);
  std::ranges::find(records, number, &PlaceRecord::number)->frame = frame;
  const std::vector<std::byte> coded = encode_records(records);
  row.records = coded;
  Statement(database, "UPDATE block SET records = ?, checksum = ? WHERE first = ?")
      .with(row.records, row.sum(), row.first)
      .run();
}

std::string journal_of(std::uint8_t pages) {
  std::string head("\xD9\xD5\x05\xF9\x20\xA1\x63\xD7");
  head.resize(28, '\0');
  head[11] = 1;  // pages in it
  head[19] = static_cast<char>(pages);
  return head;
}

std::string content_of(const MapFile& map, std::string& fault) {
  std::string text;
  const auto add = [&text](const auto&... values) {
    ((text += std::to_string(values) + ' '), ...);
    text += '\n';
  };
  try {
    for (const std::string& wrong : map.check()) fault += wrong + "; ";
    add(map.next_place());
    for (const SessionFacts& facts : map.sessions()) {
      text += facts.name + ' ' + facts.settings + ' ';
      add(facts.id, facts.began_ns, facts.frames, facts.places);
      if (const auto statistics = map.statistics(facts.id)) {
        add(statistics->frames);
        for (const double value : statistics->mean) add(value);
        for (const double value : statistics->variance) add(value);
      }
    }
    const auto size = static_cast<std::size_t>(map.form().place_bytes);
    map.read([&](const PlaceBlock& block) {
      for (std::size_t i = 0; i < block.records.size(); ++i) {
        const PlaceRecord& record = block.records[i];
        add(block.session, record.number, record.frame, record.time_ns,
            crc32(block.places.subspan(i * size, size)));
      }
    });
    map.read_links([&](const SavedLink& link) {
      add(link.session, link.frame, link.place.value_or(0), link.other, link.probability);
    });
    map.read_thumbnails(
        [&](const SavedThumbnail& picture) { add(picture.place, crc32(picture.jpeg)); });
  } catch (const SetupError& error) {
    fault += error.what();
  }
  return text;
}

}  // namespace seqloop::test
