// SPDX-License-Identifier: MIT
#include "seqloop/files/npy_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

#include "files/npy_header.hpp"
#include "seqloop/detail/counted.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::files {
namespace {

static_assert(std::endian::native == std::endian::little, "floats are copied as they are");

/// Opens the file and returns its size in bytes.
std::uint64_t open_regular(const std::filesystem::path& path, std::ifstream& stream) {
  const std::string name = path.string();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  using enum std::filesystem::file_type;
  if (status.type() == none || status.type() == unknown)
    throw SetupError(Fault{name, "cannot be read: " + error.message(), "check its permissions"});
  if (status.type() == not_found) throw SetupError(Fault{name, "does not exist", "check the name"});
  if (std::filesystem::is_directory(status))
    throw SetupError(Fault{name, "is a folder, not a .npy file", "describe its pictures first"});
  if (!std::filesystem::is_regular_file(status))
    throw SetupError(Fault{name, "is not a regular file", "give the name of a file"});
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  stream.open(path, std::ios::binary);
  if (error || !stream) throw SetupError(Fault{name, "cannot be opened", "check its permissions"});
  return size;
}

/// The header, after its claims were checked against the size of the file.
NpyHeader read_header(std::ifstream& stream, std::uint64_t file_bytes, const std::string& name) {
  std::array<char, npy_preamble_bytes> preamble{};
  stream.read(preamble.data(), preamble.size());
  const auto got = static_cast<std::size_t>(stream.gcount());
  const std::uint64_t offset = npy_data_offset(std::span(preamble).first(got), name);
  if (offset > file_bytes)
    throw SetupError(Fault{name, "is truncated inside its header", "make the file again"});

  std::vector<char> start(static_cast<std::size_t>(offset));
  stream.clear();
  stream.seekg(0);
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (!stream) throw SetupError(Fault{name, "cannot be read", "check the disk it lies on"});
  const NpyHeader header = parse_npy_header(start, name);

  const std::uint64_t data_bytes = file_bytes - offset;
  const std::string shape = std::to_string(header.rows) + " x " + std::to_string(header.columns);
  // Division, because the product of two numbers from a file may not fit in 64 bits.
  if (header.columns > data_bytes / sizeof(float) / header.rows)
    throw SetupError(Fault{name,
                           "is truncated: " + shape + " values declared, " +
                               std::to_string(data_bytes) + " bytes there",
                           "make the file again"});
  if (header.rows * header.columns * sizeof(float) != data_bytes)
    throw SetupError(Fault{name,
                           "is longer than declared: " + shape + " values declared, " +
                               std::to_string(data_bytes) + " bytes there",
                           "make the file again"});
  return header;
}

}  // namespace

Matrix read_npy(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::ifstream stream;
  const std::uint64_t file_bytes = open_regular(path, stream);
  const NpyHeader header = read_header(stream, file_bytes, name);

  Matrix matrix{
      static_cast<std::size_t>(header.rows), static_cast<std::size_t>(header.columns), {}};
  matrix.values.resize(matrix.rows * matrix.columns);
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(matrix.values));
  // A read of the standard library goes through char, which may alias anything.
  stream.read(static_cast<char*>(static_cast<void*>(bytes.data())),
              static_cast<std::streamsize>(bytes.size()));
  if (!stream)
    throw SetupError(Fault{name, "cannot be read to its end", "check the disk it lies on"});

  check_finite(matrix, name);
  return matrix;
}

void check_finite(const Matrix& matrix, const std::string& name) {
  if (all_finite(matrix.values)) return;
  const auto bad = std::find_if_not(matrix.values.begin(), matrix.values.end(),
                                    [](float value) { return std::isfinite(value); });
  const auto place = static_cast<std::size_t>(bad - matrix.values.begin());
  const std::size_t first = place / matrix.columns;
  std::size_t more = 0;
  for (std::size_t row = first + 1; row < matrix.rows; ++row) {
    const std::span<const float> values = matrix.values;
    if (!all_finite(values.subspan(row * matrix.columns, matrix.columns))) ++more;
  }
  throw SetupError(
      Fault{name,
            std::string("holds ") + (std::isnan(*bad) ? "NaN" : "infinity") + " in row " +
                std::to_string(first) + ", column " + std::to_string(place % matrix.columns) +
                " (both from 0)" +
                (more > 0 ? ", and such values in " + counted(more, "row") + " more" : ""),
            "describe the drive again, or make it a row of zeros: a frame that could not be read"});
}

NpyWriter::NpyWriter(const std::filesystem::path& path, std::size_t columns)
    : file_(path), columns_(columns) {
  if (!file_.rewindable()) {
    throw SetupError(Fault{path.string(),
                           "a .npy file cannot be streamed: its length stands at its start",
                           "give the name of a file"});
  }
  file_.write(make_npy_header(0, columns_));
}

void NpyWriter::append(std::span<const float> row) {
  if (row.size() != columns_) throw std::invalid_argument("NpyWriter: a row of another length");
  file_.write(std::as_bytes(row));
  ++rows_;
}

void NpyWriter::commit() {
  const std::string header = make_npy_header(rows_, columns_);
  file_.overwrite_start(std::as_bytes(std::span(header)));
  file_.commit();
}

}  // namespace seqloop::files
