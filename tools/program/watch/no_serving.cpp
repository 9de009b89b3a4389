// SPDX-License-Identifier: MIT
// Where cpp-httplib was missing when the program was built.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "program/watch/serving.hpp"

namespace seqloop::program {

class Serving::Impl {};

void check(const ServeSettings& /*settings*/, Faults& faults) {
  faults.push_back({"serve", "this program was built without a server",
                    "install libcpp-httplib-dev and pkgconf, configure and build anew"});
}

// Never reached: whoever asks for one is refused.
Serving::Serving(const ServeSettings& /*settings*/, nlohmann::ordered_json /*run*/,
                 bool /*own_places*/, std::unique_ptr<PlacePictures> /*pictures*/) {
  std::abort();
}
Serving::~Serving() = default;
Watch& Serving::watch() noexcept { std::abort(); }
void Serving::keep_in(LastingMap& /*map*/) {}
void Serving::add_place(const Image& /*image*/, std::uint64_t /*number*/) {}

}  // namespace seqloop::program
