// SPDX-License-Identifier: MIT
// The verb of a build without DDS or SQLite.
#include <utility>

#include "program/verbs/all_verbs.hpp"

namespace seqloop::program {

Verb keep_verb() {
  return {"keep", "Keep what robots tell each other (not in this build)", {}, [](Faults faults) {
            faults.push_back({"keep", "this build was made without DDS or SQLite",
                              "install cyclonedds-dev and libsqlite3-dev, configure and build "
                              "again"});
            refuse(std::move(faults));
          }};
}

}  // namespace seqloop::program
