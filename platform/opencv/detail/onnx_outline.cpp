// SPDX-License-Identifier: MIT
#include "opencv/detail/onnx_outline.hpp"

#include <optional>
#include <set>
#include <string_view>

namespace seqloop::opencv {
namespace {

using Bytes = std::span<const unsigned char>;

/// One field of a protocol buffer message: a number or a run of bytes.
struct Field {
  std::uint64_t number = 0;  ///< the field's number in the .proto file
  std::uint64_t value = 0;
  Bytes bytes;
};

std::optional<std::uint64_t> take_varint(Bytes& rest) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && !rest.empty(); shift += 7) {
    const unsigned char byte = rest.front();
    rest = rest.subspan(1);
    value |= std::uint64_t{byte & 0x7fU} << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

/// The next field of a message; nothing at its end or where it is broken.
std::optional<Field> take_field(Bytes& rest) {
  const auto key = take_varint(rest);
  if (!key) return std::nullopt;
  Field field{*key >> 3, 0, {}};
  std::uint64_t length = 0;
  switch (*key & 7) {  // wire types of the protocol buffer encoding
    case 0: {
      const auto value = take_varint(rest);
      if (!value) return std::nullopt;
      field.value = *value;
      return field;
    }
    case 1:
      length = 8;
      break;
    case 5:
      length = 4;
      break;
    case 2: {
      const auto value = take_varint(rest);
      if (!value) return std::nullopt;
      length = *value;
      break;
    }
    default:
      return std::nullopt;
  }
  if (length > rest.size()) return std::nullopt;
  field.bytes = rest.first(static_cast<std::size_t>(length));
  rest = rest.subspan(static_cast<std::size_t>(length));
  return field;
}

template <typename Visit>
void for_each_field(Bytes message, Visit visit) {
  while (const auto field = take_field(message)) visit(*field);
}

std::string text(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

/// The last field of that number; empty where there is none.
Bytes part(Bytes message, std::uint64_t number) {
  Bytes found;
  for_each_field(message, [&](const Field& field) {
    if (field.number == number) found = field.bytes;
  });
  return found;
}

// Field numbers: onnx.proto.

void read_node(Bytes node, OnnxOutline& outline) {
  std::optional<std::string> first_output;
  for_each_field(node, [&](const Field& field) {
    if (field.number == 2 && !first_output) first_output = text(field.bytes);  // output
  });
  const std::string name = text(part(node, 3));
  if (first_output && !name.empty()) outline.node_names.emplace(*first_output, name);
}

std::vector<std::int64_t> shape_of(Bytes value_info) {
  std::vector<std::int64_t> shape;
  const Bytes tensor_type = part(part(value_info, 2), 1);
  for_each_field(part(tensor_type, 2), [&](const Field& dimension) {
    if (dimension.number != 1) return;
    std::int64_t size = 0;
    for_each_field(dimension.bytes, [&](const Field& field) {
      if (field.number == 1) size = static_cast<std::int64_t>(field.value);  // dim_value
    });
    shape.push_back(size);
  });
  return shape;
}

}  // namespace

OnnxOutline outline_onnx(std::span<const unsigned char> file) {
  OnnxOutline outline;
  std::set<std::string> weights;
  std::vector<Bytes> inputs;
  for_each_field(part(file, 7), [&](const Field& field) {  // graph
    if (field.number == 1) read_node(field.bytes, outline);
    if (field.number == 5) weights.insert(text(part(field.bytes, 8)));  // initializer's name
    if (field.number == 11) inputs.push_back(field.bytes);
  });
  for (const Bytes input : inputs) {
    if (weights.contains(text(part(input, 1)))) continue;  // older files list weights as inputs
    outline.input_shape = shape_of(input);
    break;
  }
  return outline;
}

}  // namespace seqloop::opencv
