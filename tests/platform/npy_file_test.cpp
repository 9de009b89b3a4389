// SPDX-License-Identifier: MIT
#include "seqloop/files/npy_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "expect_setup_error.hpp"
#include "temporary_folder.hpp"

namespace seqloop::files {
namespace {

using test::read_all;
using test::says;
using test::setup_error;
using test::TemporaryFolder;
using namespace std::string_literals;

constexpr std::string_view good_dictionary =
    "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }\n";

/// A `.npy` file: version 1 has two bytes of length, the others four.
std::string npy(std::string_view dictionary, std::string_view data, char version = 1) {
  std::string file = "\x93NUMPY"s + version + '\0';
  const std::size_t length = dictionary.size();
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i)
    file += static_cast<char>(length >> (8 * i) & 0xff);
  return file + std::string(dictionary) + std::string(data);
}

std::string bytes_of(std::span<const float> values) {
  std::string bytes(values.size_bytes(), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

const std::array<float, 6> values{1.0F, -2.5F, 3.0F, 0.0F, 1e-38F, 7.25F};

std::string good_file() { return npy(good_dictionary, bytes_of(values)); }

/// What reading a file of this content says.
std::string fault_of(std::string_view content) {
  const TemporaryFolder folder;
  const auto path = folder.write("in.npy", content);
  return setup_error([&] { static_cast<void>(read_npy(path)); });
}

std::string header_fault(std::string_view dictionary) {
  return fault_of(npy(dictionary, bytes_of(values)));
}

TEST(NpyFile, ReadsEveryVersion) {
  const TemporaryFolder folder;
  for (const char version : {'\1', '\2', '\3'}) {
    const auto path = folder.write("in.npy", npy(good_dictionary, bytes_of(values), version));
    const Matrix matrix = read_npy(path);
    EXPECT_EQ(matrix.rows, 2U);
    EXPECT_EQ(matrix.columns, 3U);
    EXPECT_EQ(matrix.values, std::vector<float>(values.begin(), values.end()));
    EXPECT_EQ(matrix.row(1)[2], 7.25F);
  }
}

TEST(NpyFile, ReadsADictionaryInAnyOrderAndSpacing) {
  const TemporaryFolder folder;
  const auto path = folder.write(
      "in.npy",
      npy("{\"shape\" : ( 3 ,2),'fortran_order':False,'descr':\"<f4\"}", bytes_of(values)));
  EXPECT_EQ(read_npy(path).rows, 3U);
}

TEST(NpyFile, WriterMakesWhatNumpyMakes) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "out.npy";
  NpyWriter writer(path, 3);
  writer.append(std::span(values).first(3));
  writer.append(std::span(values).last(3));
  EXPECT_FALSE(std::filesystem::exists(path));
  writer.commit();
  const std::string file = read_all(path);
  std::string header = "\x93NUMPY\x01"s + '\0' + 'v' + '\0' + std::string(good_dictionary);
  header.pop_back();
  header.resize(127, ' ');
  EXPECT_EQ(file, header + '\n' + bytes_of(values));
  EXPECT_EQ(read_npy(path).values, std::vector<float>(values.begin(), values.end()));
}

// Bad input: a row of another length, a full disk.
TEST(NpyFile, WriterRefuses) {
  const TemporaryFolder folder;
  NpyWriter writer(folder.path() / "out.npy", 3);
  EXPECT_THROW(writer.append(std::span(values).first(2)), std::invalid_argument);
  NpyWriter full("/dev/full", 3);
  full.append(std::span(values).first(3));
  EXPECT_THROW(full.commit(), IoError);
}

// Bad input: not there, not a file, not .npy.
TEST(NpyFile, NamesWhatIsNoNpyFile) {
  const TemporaryFolder folder;
  const auto missing = folder.path() / "none.npy";
  EXPECT_TRUE(says(setup_error([&] { static_cast<void>(read_npy(missing)); }), "does not exist"));
  EXPECT_TRUE(
      says(setup_error([&] { static_cast<void>(read_npy(folder.path())); }), "is a folder"));
  EXPECT_TRUE(says(setup_error([&] { static_cast<void>(read_npy("/dev/null")); }),
                   "is not a regular file"));
  EXPECT_TRUE(says(fault_of(""), "is empty"));
  EXPECT_TRUE(says(fault_of("frame,match\n1,2\n"), "is not a .npy file"));
  EXPECT_TRUE(says(fault_of("\x93NUMPY\x04"s + std::string(20, '\0')), "version 4"));
}

// Bad input: cut off or too long.
TEST(NpyFile, SaysWhyAFileCannotBeLookedAt) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "round.npy";
  std::filesystem::create_symlink(path, path);
  const std::string said = setup_error([&] { static_cast<void>(read_npy(path)); });
  EXPECT_TRUE(says(said, "cannot be read: Too many levels of symbolic links; check"));
}

TEST(NpyFile, ComparesLengths) {
  const std::string file = good_file();
  EXPECT_TRUE(says(fault_of(file.substr(0, 3)), "truncated inside its header"));
  EXPECT_TRUE(says(fault_of(file.substr(0, 9)), "truncated inside its header"));
  EXPECT_TRUE(says(fault_of(file.substr(0, 40)), "truncated inside its header"));
  EXPECT_TRUE(says(fault_of(file.substr(0, file.size() - 1)), "is truncated: 2 x 3 values"));
  EXPECT_TRUE(says(fault_of(file + '\0'), "is longer than declared"));
}

// Bad input: numbers of another kind, order or shape.
TEST(NpyFile, NamesEveryFaultOfTheHeader) {
  EXPECT_TRUE(says(header_fault("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3)}"),
                   "type '<f8', not float32"));
  EXPECT_TRUE(says(header_fault("{'descr': '>f4', 'fortran_order': False, 'shape': (2, 3)}"),
                   "big-endian"));
  EXPECT_TRUE(says(header_fault("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3)}"),
                   "Fortran order"));
  EXPECT_TRUE(says(header_fault("{'descr': '<f4', 'fortran_order': False, 'shape': (6,)}"),
                   "1 dimensions, not 2"));
  EXPECT_TRUE(says(header_fault("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3)}"),
                   "3 dimensions, not 2"));
  EXPECT_TRUE(says(header_fault("{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3)}"),
                   "has no rows"));
  EXPECT_TRUE(says(header_fault("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 0)}"),
                   "rows have no values"));
  EXPECT_TRUE(says(header_fault("{'descr': '<f4', 'fortran_order': False, 'shape': (-2, 3)}"),
                   "no readable shape"));
  const std::string all = header_fault("{'descr': [('x', '<f4')], 'fortran_order': 1}");
  EXPECT_TRUE(says(all, "not float32"));
  EXPECT_TRUE(says(all, "does not tell the order"));
  EXPECT_TRUE(says(all, "no readable shape"));
}

// Bad input: sizes whose product overflows, to 0 or to a little number.
TEST(NpyFile, NeverTrustsTheDeclaredSize) {
  for (const char* shape :
       {"4294967296, 4294967296", "4611686018427387904, 4", "2, 9223372036854775809",
        "1000000000000, 9216", "18446744073709551615, 1"}) {
    const std::string dictionary =
        "{'descr': '<f4', 'fortran_order': False, 'shape': ("s + shape + "), }";
    EXPECT_TRUE(says(header_fault(dictionary), "is truncated")) << shape;
  }
  EXPECT_TRUE(says(header_fault("{'descr': '<f4', 'fortran_order': False, 'shape': "
                                "(99999999999999999999, 1), }"),
                   "no readable shape"));
}

// Bad input: NaN and infinity.
TEST(NpyFile, NamesThePlaceOfANumberThatIsNotFinite) {
  auto bad = values;
  bad[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(says(fault_of(npy(good_dictionary, bytes_of(bad))), "NaN in row 1, column 1"));
  bad[2] = -std::numeric_limits<float>::infinity();
  const std::string both = fault_of(npy(good_dictionary, bytes_of(bad)));
  EXPECT_TRUE(says(both, "infinity in row 0, column 2"));
  EXPECT_TRUE(says(both, "such values in 1 row more"));
}

// Bad input: 20,000 seeded mutations of a good file.
TEST(NpyFile, MutatedFilesAreReadOrRefused) {
  constexpr unsigned seed = 7;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const TemporaryFolder folder;
  int read = 0;
  int refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string file = good_file();
    for (std::size_t change = below(4) + 1; change-- > 0 && !file.empty();) {
      const std::size_t place = below(file.size());
      switch (below(4)) {
        case 0:
          file[place] = static_cast<char>(below(256));
          break;
        case 1:
          file.erase(place, below(4) + 1);
          break;
        case 2:
          file.insert(place, 1, "0129,()'<f48:{} "[below(16)]);
          break;
        default:
          file.resize(below(16) == 0 ? place : file.size());
          break;
      }
    }
    // A new file each time: ext4 brings one that is overwritten to the disk at once.
    std::filesystem::remove(folder.path() / "in.npy");
    const auto path = folder.write("in.npy", file);
    try {
      const Matrix matrix = read_npy(path);
      ASSERT_EQ(matrix.values.size(), matrix.rows * matrix.columns);
      ASSERT_LE(matrix.values.size() * sizeof(float), file.size());
      for (const float value : matrix.values) ASSERT_TRUE(std::isfinite(value));
      ++read;
    } catch (const SetupError& error) {
      ASSERT_FALSE(error.faults().empty());
      ++refused;
    }
  }
  EXPECT_GT(read, 1000);  // both ways out were taken
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace seqloop::files
