// SPDX-License-Identifier: MIT
#include "program/watch/serving.hpp"

#include <utility>

namespace seqloop::program {

void add_serve_options(OptionTable& options, ServeSettings& settings) {
  options.section("Seen while it runs");
  Option serve{"serve", ValueKind::text, "show the run in a browser, at ADDR:PORT [127.0.0.1:8321]",
               [&settings](std::string_view value) { settings.address = value; }};
  serve.may_be_bare = true;
  options.add(std::move(serve));
  options.path("serve-token", Access::reads, settings.token,
               "file with the token that control needs, 16 characters or more [a new one]");
}

}  // namespace seqloop::program
