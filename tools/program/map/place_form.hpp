// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// What all places of a map have in common: only such places can be compared.
struct PlaceForm {
  std::string form;
  std::string describer;
  std::size_t descriptor_size = 0;
  std::size_t place_bytes = 0;
};

/// How places are kept, in words: "int8 euclidean standardised".
[[nodiscard]] std::string form_of(const MatcherConfig& config);

/// Whether a place of such a form can have these bytes; of a form that is not known here, any.
[[nodiscard]] bool can_be_place(std::string_view form, std::span<const std::byte> bytes) noexcept;

}  // namespace seqloop::program
