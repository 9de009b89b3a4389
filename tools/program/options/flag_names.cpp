// SPDX-License-Identifier: MIT
#include "program/options/flag_names.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace seqloop::program {
namespace {

struct Renamed {
  std::string_view member;
  std::string_view flag;
};

// What a fault of the configuration can be about. Where one name holds another, the longer comes
// first.
constexpr std::array members{Renamed{"sequence_length", "ds"},
                             Renamed{"initial_k", "initial-k"},
                             Renamed{"relocalising.rows_scanned", "slice"},
                             Renamed{"relocalising.distances", "distances"},
                             Renamed{"full_map", "full-map"},
                             Renamed{"frames_at_once", "frames-at-once"},
                             Renamed{"standardisation.prior_frames", "standardise-prior"},
                             Renamed{"standardisation.horizon", "standardise-horizon"},
                             Renamed{"max_uniqueness", "max-uniqueness"},
                             Renamed{"min_probability", "min-probability"},
                             Renamed{"patience", "patience"},
                             Renamed{"descriptor_size", "descriptor-size"},
                             Renamed{"places", "max-places"},
                             Renamed{"vmin, vmax", "vmin, vmax"},
                             Renamed{"vmin", "vmin"},
                             Renamed{"arithmetic", "arithmetic"},
                             Renamed{"map", "map"}};

// What remedies say of them.
constexpr std::array phrases{Renamed{"set arithmetic to float32", "--arithmetic float"},
                             Renamed{"relocalising.on to false", "--relocalise off"},
                             Renamed{"decision to uniqueness", "--decide-by uniqueness"},
                             Renamed{"set full_map to refuse", "--full-map refuse"},
                             Renamed{"raise sequence_length", "lengthen ds"},
                             Renamed{"sequence_length", "ds"},
                             Renamed{"full_map", "full-map"}};

}  // namespace

Fault in_flags(Fault fault) {
  const auto* const known = std::ranges::find(members, fault.what, &Renamed::member);
  if (known == members.end()) return fault;
  fault.what = known->flag;
  for (const auto& [members_words, flags_words] : phrases) {
    const std::size_t at = fault.remedy.find(members_words);
    if (at != std::string::npos) fault.remedy.replace(at, members_words.size(), flags_words);
  }
  return fault;
}

Fault in_keys(Fault fault) {
  const auto is_name = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  };
  for (std::string* const text : {&fault.why, &fault.remedy}) {
    for (std::size_t at = 0; (at = text->find("--", at)) != std::string::npos;) {
      // Names of files may hold dashes, too.
      const bool begins = at == 0 || (*text)[at - 1] == ' ';
      std::size_t end = at + 2;
      while (end < text->size() && is_name((*text)[end])) ++end;
      if (begins && end > at + 2)
        text->replace(at, end - at, "'" + text->substr(at + 2, end - at - 2) + "'");
      at = end;
    }
  }
  return fault;
}

}  // namespace seqloop::program
