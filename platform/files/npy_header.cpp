// SPDX-License-Identifier: MIT
#include "files/npy_header.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

namespace seqloop::files {
namespace {

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::size_t header_bytes = 128;  // NumPy wants a multiple of 64; two 64-bit numbers fit
constexpr const char* remedy = "save it with numpy.save as float32 in C order";

std::uint64_t little_endian(std::span<const char> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

/// Bytes of the field that holds the header's length; 0 for a version this reader does not know.
std::size_t length_bytes(char version) {
  if (version == 1) return 2;
  return version == 2 || version == 3 ? 4 : 0;
}

/// What follows `'key':` in the dictionary, blanks left out; nothing when the key is not there.
std::optional<std::string_view> value_of(std::string_view dictionary, std::string_view key) {
  constexpr std::string_view blanks = " \t\n";
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    const std::size_t place = dictionary.find(quoted);
    if (place == std::string_view::npos) continue;
    std::string_view rest = dictionary.substr(place + quoted.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    if (!rest.starts_with(':')) return std::nullopt;
    rest.remove_prefix(1);
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    return rest;
  }
  return std::nullopt;
}

/// The text of a quoted value, or all up to the next comma.
std::string_view word(std::string_view value) {
  if (value.starts_with('\'') || value.starts_with('"'))
    return value.substr(1, value.find(value.front(), 1) - 1);
  return value.substr(0, value.find_first_of(",}"));
}

/// The numbers of `(3, 4)` or `(3,)` or `()`; nothing when it is not such a tuple or too large.
std::optional<std::vector<std::uint64_t>> numbers(std::string_view value) {
  if (!value.starts_with('(')) return std::nullopt;
  value.remove_prefix(1);
  std::vector<std::uint64_t> found;
  for (bool comma = true;;) {
    value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
    if (value.starts_with(')')) return found;
    if (!comma) return std::nullopt;
    std::uint64_t number = 0;
    const auto end = std::from_chars(value.data(), value.data() + value.size(), number);
    if (end.ec != std::errc()) return std::nullopt;
    found.push_back(number);
    value.remove_prefix(static_cast<std::size_t>(end.ptr - value.data()));
    value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
    comma = value.starts_with(',');
    if (comma) value.remove_prefix(1);
  }
}

/// Text from a file, made fit for one line on a terminal.
std::string shown(std::string_view text) {
  std::string result;
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c <= '~' ? c : '?';
  return "'" + result + "'";
}

void check_type(std::string_view dictionary, const std::string& name, Faults& faults) {
  const auto value = value_of(dictionary, "descr");
  if (!value) {
    faults.push_back({name, "its header names no number type", remedy});
  } else if (word(*value) == ">f4") {
    faults.push_back({name, "its numbers are big-endian ('>f4')", remedy});
  } else if (word(*value) != "<f4") {
    faults.push_back(
        {name, "its numbers are of type " + shown(word(*value)) + ", not float32 ('<f4')", remedy});
  }
}

void check_order(std::string_view dictionary, const std::string& name, Faults& faults) {
  const auto value = value_of(dictionary, "fortran_order");
  if (!value || (!value->starts_with("False") && !value->starts_with("True"))) {
    faults.push_back({name, "its header does not tell the order of its numbers", remedy});
  } else if (value->starts_with("True")) {
    faults.push_back({name, "its numbers are in Fortran order", remedy});
  }
}

void read_shape(std::string_view dictionary, const std::string& name, NpyHeader& header,
                Faults& faults) {
  const auto value = value_of(dictionary, "shape");
  const auto shape = value ? numbers(*value) : std::nullopt;
  if (!shape) {
    faults.push_back({name, "its header has no readable shape", remedy});
  } else if (shape->size() != 2) {
    faults.push_back({name, "it has " + std::to_string(shape->size()) + " dimensions, not 2",
                      "give one row a frame, [N, D]"});
  } else {
    header.rows = (*shape)[0];
    header.columns = (*shape)[1];
    if (header.rows == 0)
      faults.push_back({name, "it has no rows", "describe a drive that has frames"});
    if (header.columns == 0)
      faults.push_back({name, "its rows have no values", "describe the drive again"});
  }
}

}  // namespace

std::uint64_t npy_data_offset(std::span<const char> start, const std::string& name) {
  const std::string_view text(start.data(), start.size());
  if (text.empty()) throw SetupError(Fault{name, "is empty"});
  if (!text.starts_with(magic.substr(0, text.size())))
    throw SetupError(Fault{name, "is not a .npy file", remedy});
  if (text.size() < magic.size() + 2)
    throw SetupError(Fault{name, "is truncated inside its header", "make the file again"});
  const std::size_t length = length_bytes(text[magic.size()]);
  if (length == 0)
    throw SetupError(Fault{name,
                           "is of .npy version " +
                               std::to_string(static_cast<unsigned char>(text[magic.size()])) +
                               ", not 1, 2 or 3",
                           remedy});
  const std::size_t begin = magic.size() + 2;
  if (text.size() < begin + length)
    throw SetupError(Fault{name, "is truncated inside its header", "make the file again"});
  return begin + length + little_endian(start.subspan(begin, length));
}

NpyHeader parse_npy_header(std::span<const char> start, const std::string& name) {
  const std::string_view text(start.data(), start.size());
  const std::string_view dictionary =
      text.substr(magic.size() + 2 + length_bytes(text[magic.size()]));
  NpyHeader header;
  header.data_offset = start.size();
  Faults faults;
  check_type(dictionary, name, faults);
  check_order(dictionary, name, faults);
  read_shape(dictionary, name, header, faults);
  if (!faults.empty()) throw SetupError(std::move(faults));
  return header;
}

std::string make_npy_header(std::size_t rows, std::size_t columns) {
  constexpr std::size_t preamble = 10;
  std::string text(magic);
  text += {'\x01', '\x00', static_cast<char>(header_bytes - preamble), '\x00'};
  text += "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ", " +
          std::to_string(columns) + "), }";
  text.resize(header_bytes - 1, ' ');
  return text + '\n';
}

}  // namespace seqloop::files
