// SPDX-License-Identifier: MIT
// The verb of a build without SQLite.
#include <utility>

#include "program/verbs/all_verbs.hpp"

namespace seqloop::program {

Verb map_verb() {
  Verb verb{"map", "Look into a map that was saved (not in this build)", {}, [](Faults faults) {
              faults.push_back({"map", "this build was made without SQLite",
                                "install libsqlite3-dev, configure and build again"});
              refuse(std::move(faults));
            }};
  verb.words = [](const std::vector<std::string>&) {};
  return verb;
}

}  // namespace seqloop::program
