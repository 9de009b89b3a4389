// SPDX-License-Identifier: MIT
#include "program/map/map_json.hpp"

#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "evaluation/line_faults.hpp"
#include "program/options/verb.hpp"
#include "program/process/json_text.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::program {
namespace {

namespace fs = std::filesystem;

constexpr auto most_whole = static_cast<std::int64_t>(sqlite::number_end) - 1;

class MapJson {
  using Json = nlohmann::json;

 public:
  explicit MapJson(const fs::path& file) : name_(file.string()), faults_(name_) {}

  DescribedMap read() {
    DescribedMap map;
    const Json json = parsed();
    if (!json.is_object()) return map;
    map.form.form = text(json, "form", "");
    map.form.describer = text(json, "describer", "");
    // A place has a bit a value at least; what is recovered may know none.
    constexpr auto most_bytes = static_cast<std::int64_t>(sqlite::most_place_bytes);
    const auto size = whole(json, "descriptor_size", "", 0, 8 * most_bytes);
    map.form.descriptor_size = static_cast<std::uint64_t>(size.value_or(0));
    map.form.place_bytes =
        static_cast<std::uint64_t>(whole(json, "place_bytes", "", 1, most_bytes).value_or(0));
    const Json* sessions = find(json, "sessions", "");
    if (sessions == nullptr) return map;
    if (!sessions->is_array()) {
      blame("'sessions'", *sessions, "an array of sessions");
      return map;
    }
    map.sessions.emplace();
    std::set<std::string> names;
    for (const Json& session : *sessions) {
      map.sessions->push_back(
          described(session, fmt::format("session {}", map.sessions->size() + 1), size, names));
    }
    return map;
  }

  void refuse() { faults_.refuse(); }

 private:
  Json parsed() {
    std::ifstream stream(name_);
    if (!stream) {
      faults_.add({name_, "cannot be read", give_an_export});
      return {};
    }
    try {
      Json json = Json::parse(stream);
      if (!json.is_object()) faults_.add({name_, "is no JSON object", give_an_export});
      return json;
    } catch (const Json::exception& error) {
      // In front stands the library's own number of the error.
      const std::string why = error.what();
      faults_.add({name_, "is no JSON object: " + why.substr(why.find("] ") + 2), give_an_export});
      return {};
    }
  }

  /// @param size of a descriptor; nothing: it is not known
  DescribedSession described(const Json& said, const std::string& which,
                             const std::optional<std::int64_t>& size,
                             std::set<std::string>& names) {
    DescribedSession session;
    if (!said.is_object()) {
      blame(which, said, "an object");
      return session;
    }
    if (const Json* name = find(said, "name", which); name != nullptr && !name->is_string()) {
      blame("'name' of " + which, *name, "a text");
    } else if (name != nullptr) {
      session.name = *name;
      if (session.name.empty()) {
        faults_.add({name_, which + " has no name", "give it one"});
      } else if (!names.insert(session.name).second) {
        faults_.add(
            {name_, "two sessions have the name '" + session.name + "'", "give one another"});
      }
    }
    using Limits = std::numeric_limits<std::int64_t>;
    session.began_ns = whole(said, "began_ns", which, Limits::min(), Limits::max()).value_or(0);
    session.settings = text(said, "settings", which);
    session.frames =
        static_cast<std::uint64_t>(whole(said, "frames", which, 0, most_whole).value_or(0));
    const auto statistics = said.find("statistics");
    if (statistics == said.end()) return session;
    if (!statistics->is_object()) {
      blame("'statistics' of " + which, *statistics, "an object");
      return session;
    }
    const std::string its = "the statistics of " + which;
    const auto frames = whole(*statistics, "frames", its, 0, most_whole).value_or(0);
    // As the values of descriptors.
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    session.statistics = {static_cast<std::uint64_t>(frames),
                          numbers(*statistics, "mean", its, size, -most, most),
                          numbers(*statistics, "variance", its, size, 0.0, most * most)};
    return session;
  }

  /// @param of whose key it is; empty: the map's
  /// @return null where it is missing, which is told
  const Json* find(const Json& object, const char* key, const std::string& of) {
    const auto found = object.find(key);
    if (found != object.end()) return &*found;
    faults_.add({name_, fmt::format("there is no '{}'{}", key, of.empty() ? "" : " of " + of),
                 give_an_export});
    return nullptr;
  }

  std::string text(const Json& object, const char* key, const std::string& of) {
    const Json* value = find(object, key, of);
    if (value == nullptr) return {};
    if (value->is_string()) return *value;
    blame(named(key, of), *value, "a text");
    return {};
  }

  std::optional<std::int64_t> whole(const Json& object, const char* key, const std::string& of,
                                    std::int64_t least, std::int64_t most) {
    const Json* value = find(object, key, of);
    if (value == nullptr) return std::nullopt;
    const bool fits =
        value->is_number_integer() &&
        !(value->is_number_unsigned() &&
          value->get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()});
    if (fits && *value >= least && *value <= most) return value->get<std::int64_t>();
    blame(named(key, of), *value, fmt::format("a whole number from {} to {}", least, most));
    return std::nullopt;
  }

  /// As many numbers as a descriptor has values, if that is known.
  std::vector<double> numbers(const Json& object, const char* key, const std::string& of,
                              const std::optional<std::int64_t>& count, double least, double most) {
    const Json* values = find(object, key, of);
    if (values == nullptr) return {};
    if (!values->is_array()) {
      blame(named(key, of), *values, "an array of numbers");
      return {};
    }
    if (count && values->size() != static_cast<std::uint64_t>(*count)) {
      faults_.add({name_,
                   fmt::format("{} has {}", named(key, of), counted(values->size(), "value")),
                   fmt::format("write {}, as a descriptor has", *count)});
    }
    std::vector<double> all;
    for (const Json& value : *values) {
      if (!value.is_number() || value < least || value > most) {
        blame("a value of " + named(key, of), value,
              fmt::format("a number from {:.3g} to {:.3g}", least, most));
        return {};
      }
      all.push_back(value);
    }
    return all;
  }

  static std::string named(const char* key, const std::string& of) {
    return fmt::format("'{}'{}", key, of.empty() ? "" : " of " + of);
  }

  /// A value in a message, in which a long one has no room.
  static std::string shown(const Json& value) {
    if (value.is_array()) return "an array";
    if (value.is_object()) return "an object";
    std::string text = json_text(value);
    constexpr std::size_t room = 40;
    return text.size() > room ? "a long text" : text;
  }

  void blame(const std::string& what, const Json& value, const std::string& wanted) {
    faults_.add({name_, what + " is " + shown(value), "write " + wanted});
  }

  std::string name_;
  evaluation::LineFaults faults_;
};

}  // namespace

DescribedMap read_map_json(const fs::path& file, Faults& faults) {
  MapJson json(file);
  DescribedMap map;
  collect(faults, [&] {
    map = json.read();
    json.refuse();
  });
  return map;
}

}  // namespace seqloop::program
