// SPDX-License-Identifier: MIT
#include "program/map/map_settings.hpp"

#include <unistd.h>

#include <stdexcept>

#include "files/partial.hpp"
#include "program/options/verb.hpp"
#include "program/process/database_file.hpp"
#include "program/process/utf8.hpp"

namespace seqloop::program {
namespace {

/// @return whether superseded sessions go
bool parse_grow(std::string_view text) {
  if (text == "novel") return true;
  if (text == "all") return false;
  throw std::invalid_argument("'" + std::string(text) + "' is neither all nor novel");
}

}  // namespace

void add_map_options(OptionTable& options, MapSettings& settings) {
  options.section("Map");
  options.path("map", Access::writes, settings.file,
               "map that lasts: localise in its sessions, and add the drive as another; made where "
               "it is missing [none]");
  options.flag("read-only", settings.read_only, "localise in the map, and leave it as it is");
  options.text("session", settings.session, "name of the drive in the map [when it began]");
  options.section("Map", Shown::in_help_all);
  options.add({"grow", ValueKind::text,
               "novel: of what was seen again on six later laps, the oldest go and leave visits; "
               "all: none goes [novel]",
               [&settings](std::string_view value) { settings.novel = parse_grow(value); }});
  options.number("save-every-s", settings.save_every_s,
                 "seconds of driving that may not be saved yet [1]");
}

void add_thumbnail_option(OptionTable& options, MapSettings& settings) {
  options.section("Map", Shown::in_help_all);
  options.on_off("thumbnails", settings.thumbnails,
                 "keep a small picture of each place in the map [on]");
}

void check(const MapSettings& settings, bool reference, Faults& faults) {
  if (settings.file.empty()) {
    const MapSettings usual;
    refuse_given(faults,
                 {{"read-only", settings.read_only},
                  {"session", !settings.session.empty()},
                  {"grow", settings.novel != usual.novel},
                  {"save-every-s", settings.save_every_s != usual.save_every_s},
                  {"thumbnails", settings.thumbnails != usual.thumbnails}},
                 "there is no map", "--map FILE");
    return;
  }
  // It is opened once the form of the drive's places is known: what can be seen before that is told
  // with all other faults.
  std::error_code error;
  const bool is_other = std::filesystem::is_regular_file(settings.file, error) &&
                        std::filesystem::file_size(settings.file, error) > 0 &&
                        ::access(settings.file.c_str(), R_OK) == 0 && !is_database(settings.file);
  const std::filesystem::path around =
      std::filesystem::absolute(settings.file, error).parent_path();
  if (settings.read_only && !std::filesystem::exists(settings.file, error) && !error) {
    faults.push_back({settings.file.string(), "there is no such map",
                      "name a map, or make one with `seqloop run --map`"});
  } else if (is_other) {
    faults.push_back(
        {settings.file.string(),
         "no SeqLoop map: it is not even an SQLite database, or its first page is damaged",
         "name a map; if it was one, `seqloop map recover` finds what is left of it"});
  } else if (!settings.read_only && !std::filesystem::is_directory(around, error)) {
    faults.push_back(files::missing_folder(settings.file.string(), around));
  }
  if (reference) {
    faults.push_back({"map, reference", "there are two maps", "leave out one of them"});
  }
  if (settings.read_only && !settings.session.empty()) {
    faults.push_back({"session", "nothing is added to a map that is only read",
                      "leave --session or --read-only out, and name the map by --map"});
  }
  check_name(faults, "session", settings.session);
  if (!(settings.save_every_s > 0.0 && settings.save_every_s <= 3600.0)) {
    faults.push_back({"save-every-s", "it must be above 0 and at most 3600"});
  }
}

}  // namespace seqloop::program
