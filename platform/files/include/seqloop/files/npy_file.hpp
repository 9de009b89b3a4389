// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "seqloop/files/output_file.hpp"

namespace seqloop::files {

/// One row a frame, C order.
struct Matrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<float> values;  ///< [rows * columns]

  /// @param index 0..rows-1
  [[nodiscard]] std::span<const float> row(std::size_t index) const {
    return std::span(values).subspan(index * columns, columns);
  }
};

/// Reads a NumPy `.npy` file (format 1.0, 2.0 or 3.0) of finite little-endian float32, `[N, D]`, C
/// order, N >= 1, D >= 1.
/// Throws SetupError with every fault of the header, or else the first one of the data. What the
/// header claims is compared with the size of the file before anything is allocated.
[[nodiscard]] Matrix read_npy(const std::filesystem::path& path);

/// Throws SetupError where a value is NaN or infinite: the first one. @param name for the message
void check_finite(const Matrix& matrix, const std::string& name);

/// Writes a `.npy` file (format 1.0, float32, `[N, D]`) row by row, N being known only at the end.
/// The file appears under its name at `commit`, as OutputFile does it; a pipe cannot be written.
class NpyWriter {
 public:
  /// @param columns D, values in a row
  /// Throws SetupError as OutputFile does.
  NpyWriter(const std::filesystem::path& path, std::size_t columns);

  /// @param row [D]; std::invalid_argument when it has another length
  /// Throws IoError. Allocates: never.
  void append(std::span<const float> row);

  /// The last call. Throws IoError.
  void commit();

  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }

 private:
  OutputFile file_;
  std::size_t columns_;
  std::size_t rows_ = 0;
};

}  // namespace seqloop::files
