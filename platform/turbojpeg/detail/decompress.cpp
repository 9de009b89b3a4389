// SPDX-License-Identifier: MIT
#include "turbojpeg/detail/decompress.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <new>
#include <string_view>
#include <vector>

namespace seqloop::turbojpeg {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Decompressor = std::unique_ptr<void, decltype(&tjDestroy)>;

constexpr std::string_view no_memory = "Insufficient memory";  // as libjpeg begins to say it

/// @param why set to libjpeg's first warning or its error; emptied where there was none
void decode(Bytes jpeg, const Pixels& into, FixedText& why) {
  why.clear();
  // A new one for every picture (0.2 us): an old one fills in tables from the pictures before.
  const Decompressor decompressor(tjInitDecompress(), &tjDestroy);
  if (!decompressor) return why.assign({no_memory});
  const bool gray = into.format == PixelFormat::gray8;
  // A few bytes more would otherwise be a whole pass over the picture more.
  const int failed = tjDecompress2(decompressor.get(), jpeg.data(), jpeg.size(), into.data,
                                   into.width, into.width * (gray ? 1 : 3), into.height,
                                   gray ? TJPF_GRAY : TJPF_BGR, TJFLAG_LIMITSCANS);
  if (failed != 0) why.assign({tjGetErrorStr2(decompressor.get())});
}

/// Whether libjpeg complains of a few bytes between the picture's data and its end and of nothing
/// else: it keeps its first warning, and after the end there is no other.
bool is_padding(std::string_view warning) {
  constexpr std::string_view before = "Corrupt JPEG data: ";
  constexpr std::string_view behind = " extraneous bytes before marker 0xd9";
  if (!warning.starts_with(before) || !warning.ends_with(behind)) return false;
  warning.remove_prefix(before.size());
  int bytes = 0;
  const char* end = warning.data() + warning.size() - behind.size();
  const auto [stopped, error] = std::from_chars(warning.data(), end, bytes);
  return error == std::errc() && stopped == end && bytes <= most_padding;
}

/// Whether libjpeg complains of numbers in a header that it makes no use of.
bool is_odd_header(std::string_view warning) {
  return warning == "Invalid SOS parameters for sequential JPEG" ||  // some phones' pictures
         warning.starts_with("Warning: unknown JFIF revision number");
}

/// The same picture with the numbers that libjpeg makes no use of as it wants them, so that it
/// warns of nothing but damage.
std::vector<std::uint8_t> with_usual_header(Bytes jpeg) {
  constexpr std::array<std::uint8_t, 3> whole_spectrum{0, 63, 0};
  std::vector<std::uint8_t> copy(jpeg.begin(), jpeg.end());
  std::size_t place = 2;
  while (copy.size() - place >= 4 && copy[place] == 0xff) {
    const std::uint8_t marker = copy[place + 1];
    const auto end = place + 2 + static_cast<std::size_t>(copy[place + 2] << 8 | copy[place + 3]);
    if (marker == 0xff) {  // padding
      ++place;
      continue;
    }
    if (end > copy.size()) break;
    constexpr std::size_t revision = 9;  // after marker, length and "JFIF"
    if (marker == 0xe0 && place + revision < end) copy[place + revision] = 1;
    if (marker == 0xda) {
      if (end - place > 4 + whole_spectrum.size())
        std::ranges::copy(whole_spectrum, copy.begin() + static_cast<std::ptrdiff_t>(end - 3));
      break;
    }
    place = end;
  }
  return copy;
}

}  // namespace

void set_no_memory(FixedText& fault, int width, int height) noexcept {
  fault.assign({"there is not enough memory for a picture of "});
  fault.append_number(static_cast<std::uint64_t>(width));
  fault.append("x");
  fault.append_number(static_cast<std::uint64_t>(height));
}

bool decompress(Bytes jpeg, const Pixels& into, FixedText& fault) noexcept {
  FixedText why;
  decode(jpeg, into, why);
  try {
    if (is_odd_header(why.view())) decode(with_usual_header(jpeg), into, why);
  } catch (const std::bad_alloc&) {
    why.assign({no_memory});
  }
  fault.clear();
  if (why.empty() || is_padding(why.view())) return true;
  if (why.view().starts_with(no_memory)) {
    set_no_memory(fault, into.width, into.height);
  } else {
    fault.assign({"the JPEG picture is damaged (", why.view(), ")"});
  }
  return false;
}

}  // namespace seqloop::turbojpeg
