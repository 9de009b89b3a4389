// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "program/map/exchange.hpp"
#include "program/map/merge.hpp"
#include "program/map/move_log.hpp"
#include "program/map/new_map.hpp"
#include "program/process/interruption.hpp"
#include "program/process/json_text.hpp"
#include "program/process/outputs.hpp"
#include "program/process/say.hpp"
#include "program/verbs/all_verbs.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/sqlite/map_file.hpp"
#include "seqloop/sqlite/recover.hpp"

namespace seqloop::program {
namespace {

namespace fs = std::filesystem;
using sqlite::MapFile;

struct MapSettings {
  std::vector<std::string> words;
  fs::path out;
  bool json = false;
};

std::uint64_t places_of(const std::vector<sqlite::SessionFacts>& sessions) {
  std::uint64_t places = 0;
  for (const sqlite::SessionFacts& facts : sessions) places += facts.places;
  return places;
}

/// "80 places in 2 sessions"
std::string content_of(const MapFile& map) {
  const std::vector<sqlite::SessionFacts> sessions = map.sessions();
  return fmt::format("{} in {}", counted(places_of(sessions), "place"),
                     counted(sessions.size(), "session"));
}

/// Of the log beside it, in which what was saved may stand until the map is closed.
std::uintmax_t log_bytes(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file.string() + "-wal", error);
  return error ? 0 : bytes;
}

void info(const MapSettings& settings) {
  const fs::path file = settings.words[1];
  const MapFile map = MapFile::read_only(file);
  const std::vector<sqlite::SessionFacts> sessions = map.sessions();
  const sqlite::MapForm& form = map.form();
  const std::uintmax_t log = log_bytes(file);
  const std::uintmax_t bytes = fs::file_size(file) + log;
  const sqlite::ThumbnailFacts thumbnails = map.thumbnail_facts();
  std::map<std::int64_t, std::uint64_t> visits;  // by session
  map.read_links([&visits](const sqlite::SavedLink& link) {
    if (sqlite::is_visit(link)) ++visits[link.session];
  });
  if (settings.json) {
    auto list = nlohmann::ordered_json::array();
    for (const sqlite::SessionFacts& facts : sessions) {
      list.push_back({{"name", facts.name},
                      {"places", facts.places},
                      {"frames", facts.frames},
                      {"visits", visits[facts.id]},
                      {"began_ns", facts.began_ns},
                      {"settings", facts.settings}});
    }
    const nlohmann::ordered_json json{{"places", places_of(sessions)},
                                      {"descriptor_size", form.descriptor_size},
                                      {"place_bytes", form.place_bytes},
                                      {"form", form.form},
                                      {"describer", form.describer},
                                      {"next_place", map.next_place()},
                                      {"file_bytes", bytes},
                                      {"thumbnails", thumbnails.count},
                                      {"thumbnail_bytes", thumbnails.bytes},
                                      {"sessions", list}};
    fmt::print("{}\n", json_text(json, 2));
    return;
  }
  std::string text = fmt::format(
      "{} of {}, descriptors of {}\nform: {}\ndescribed by: {}\nfile: {}{}, {} of them for {}\n\n"
      "      places      frames      visits  session\n",
      counted(places_of(sessions), "place"), counted(form.place_bytes, "byte"),
      counted(form.descriptor_size, "value"), form.form, form.describer, counted(bytes, "byte"),
      log > 0 ? " with its log" : "", thumbnails.bytes, counted(thumbnails.count, "thumbnail"));
  for (const sqlite::SessionFacts& facts : sessions) {
    text += fmt::format("{:>12}{:>12}{:>12}  {}\n", facts.places, facts.frames, visits[facts.id],
                        printable(facts.name));
  }
  fmt::print("{}", printable_lines(text));
}

void check(const MapSettings& settings) {
  const std::string file = settings.words[1];
  const MapFile map = MapFile::read_only(file);
  Faults faults;
  for (const std::string& wrong : map.check()) {
    faults.push_back({file, wrong, "`seqloop map recover` copies what is whole into a new file"});
  }
  refuse(std::move(faults));
  say("{}: {}, all of them whole", file, content_of(map));
}

void recover(const MapSettings& settings) {
  NewMap out(settings.words[2]);
  sqlite::Recovered found;
  out.make([&] {
    found = sqlite::recover(settings.words[1], out.partial(), stop_if_interrupted);
    if (found.places == 0 && !found.lost.empty()) {
      throw SetupError(
          {settings.words[1], "no place of it is whole", "take a copy, if there is one"});
    }
  });
  for (const std::string& lost : found.lost) say("{}: lost: {}", settings.words[1], lost);
  say("{}: {} in {}, {}, {}", settings.words[2], counted(found.places, "place"),
      counted(found.sessions, "session"), counted(found.links, "link"),
      counted(found.thumbnails, "thumbnail"));
}

void merge(const MapSettings& settings) {
  const std::vector<fs::path> maps(settings.words.begin() + 1, settings.words.end());
  const std::vector<std::uint64_t> added = merge_maps(maps, settings.out, stop_if_interrupted);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    say("{}: {} is added to the numbers of its places", maps[i].string(), added[i]);
  }
  say("{}: {}", settings.out.string(), content_of(MapFile::read_only(settings.out)));
}

void exchange(const MapSettings& settings, bool exports) {
  if (!exports) import_map(settings.words[1], settings.out);
  const MapFile map = MapFile::read_only(exports ? fs::path(settings.words[1]) : settings.out);
  if (exports) export_map(map, settings.out);
  say("{}: {}", settings.out.string(), content_of(map));
}

void change(const MapSettings& settings) {
  const fs::path file = settings.words[1];
  std::error_code missing;
  const std::uintmax_t before = fs::file_size(file, missing) + log_bytes(file);
  std::string left;
  {
    MapFile map = MapFile::open(file, std::nullopt);
    if (settings.words[0] == "forget") map.forget(settings.words[2]);
    if (settings.words[0] == "compact") map.compact();
    left = content_of(map);
    if (const auto stays = move_log_into(map)) throw std::runtime_error(*stays);
  }
  say("{}: {} in {} bytes, {} before", file.string(), left, fs::file_size(file), before);
}

/// What can be done with maps.
struct Work {
  std::string name;
  std::size_t least;  ///< words that must follow
  std::size_t most;
  bool out;  ///< whether it needs --out
  std::string usage;
  std::function<void(const MapSettings&)> run;
};

const std::vector<Work>& works() {
  static const std::vector<Work> all{
      {"info", 1, 1, false, "info FILE [--json]", info},
      {"check", 1, 1, false, "check FILE", check},
      {"recover", 2, 2, false, "recover DAMAGED NEW", recover},
      {"merge", 2, 1000, true, "merge A B… --out NEW", merge},
      {"export", 1, 1, true, "export FILE --out FOLDER",
       [](const MapSettings& settings) { exchange(settings, true); }},
      {"import", 1, 1, true, "import FOLDER --out NEW",
       [](const MapSettings& settings) { exchange(settings, false); }},
      {"forget", 2, 2, false, "forget FILE SESSION", change},
      {"compact", 1, 1, false, "compact FILE", change}};
  return all;
}

void work_on_map(const MapSettings& settings, Faults faults) {
  const auto& words = settings.words;
  const Work* asked = nullptr;
  std::vector<std::string> names;
  for (const Work& work : works()) {
    names.push_back(work.name);
    if (!words.empty() && work.name == words[0]) asked = &work;
  }
  if (asked == nullptr) {
    const std::string meant = words.empty() ? "" : nearest(words[0], names);
    faults.push_back({words.empty() ? "map" : "'" + words[0] + "'",
                      words.empty() ? "what is to be done with it?" : "maps cannot do that",
                      meant.empty() ? "see seqloop map --help" : "did you mean '" + meant + "'?"});
    return refuse(std::move(faults));
  }
  const std::size_t given = words.size() - 1;
  if (given < asked->least || given > asked->most) {
    faults.push_back({"map " + asked->name, counted(given, "name") + " after it",
                      "seqloop map " + asked->usage});
  }
  if (settings.out.empty() == asked->out) {
    faults.push_back({"out", asked->out ? "not given" : "map " + asked->name + " does not take it",
                      "seqloop map " + asked->usage});
  }
  if (settings.json && asked->name != "info") {
    faults.push_back({"json", "only map info takes it", "leave it out here"});
  }
  refuse(std::move(faults));
  take_interruptions();
  asked->run(settings);
}

}  // namespace

Verb map_verb() {
  const auto settings = std::make_shared<MapSettings>();
  Verb verb{"map",
            "Look into a map that was saved, repair, merge, exchange or shrink it",
            {},
            [settings](Faults faults) { work_on_map(*settings, std::move(faults)); }};
  verb.options.section("Task");
  verb.options.path("out", Access::writes, settings->out,
                    "merge, import: the new map; export: a new folder");
  verb.options.flag("json", settings->json, "info: as JSON");
  verb.words = [settings](std::vector<std::string> words) { settings->words = std::move(words); };
  verb.tasks = "What it does:";
  for (const Work& work : works()) verb.tasks += "\n  seqloop map " + work.usage;
  return verb;
}

}  // namespace seqloop::program
