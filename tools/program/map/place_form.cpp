// SPDX-License-Identifier: MIT
#include "program/map/place_form.hpp"

#include <array>

#include "seqloop/detail/descriptor_rows.hpp"

namespace seqloop::program {
namespace {

struct Name {
  Arithmetic arithmetic;
  std::string_view name;
};
constexpr std::array<Name, 3> names{
    {{Arithmetic::float32, "float"}, {Arithmetic::int8, "int8"}, {Arithmetic::sketch, "sketch"}}};

}  // namespace

std::string form_of(const MatcherConfig& config) {
  std::string form;
  for (const Name& name : names) {
    if (name.arithmetic == config.arithmetic) form = name.name;
  }
  form += config.difference == Difference::euclidean ? " euclidean" : " mean-absolute";
  return form + (config.standardisation.on ? " standardised" : " raw");
}

bool can_be_place(std::string_view form, std::span<const std::byte> bytes) noexcept {
  for (const Name& name : names) {
    if (form.starts_with(name.name)) return DescriptorRows::can_be_saved(name.arithmetic, bytes);
  }
  return true;
}

}  // namespace seqloop::program
