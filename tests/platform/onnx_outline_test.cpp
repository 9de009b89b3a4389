// SPDX-License-Identifier: MIT
#include "opencv/detail/onnx_outline.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "platform/pictures.hpp"

namespace seqloop::opencv {
namespace {

OnnxOutline outline(const std::string& file) {
  const std::vector<unsigned char> bytes(file.begin(), file.end());
  return outline_onnx(bytes);
}

std::string model(const std::string& name) {
  return test::read_all(std::filesystem::path(SEQLOOP_TEST_DATA) / name);
}

TEST(OnnxOutline, FindsInputShapeAndTheNamesOfTensors) {
  const OnnxOutline chain = outline(model("gray_chain.onnx"));
  EXPECT_EQ(chain.input_shape, (std::vector<std::int64_t>{1, 1, 4, 4}));
  EXPECT_EQ(chain.node_names, (std::map<std::string, std::string>{
                                  {"c_out", "conv"}, {"r_out", "relu"}, {"y", "root"}}));
  EXPECT_EQ(outline(model("colour.onnx")).input_shape, (std::vector<std::int64_t>{1, 3, 0, 0}));
}

// Bad input: no ONNX, and 20,000 seeded mutations; a read outside the file fails under a sanitizer.
TEST(OnnxOutline, LeavesOutWhatItDoesNotUnderstand) {
  EXPECT_TRUE(outline("").node_names.empty());
  EXPECT_TRUE(outline("frame,match\n1,2\n").input_shape.empty());
  EXPECT_TRUE(outline(std::string(100, '\xff')).input_shape.empty());
  constexpr unsigned seed = 5;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const std::string good = model("gray_chain.onnx");
  int whole = 0;
  for (int i = 0; i < 20'000; ++i)
    whole += outline(test::mutated(good, random)).node_names.size() == 3 ? 1 : 0;
  EXPECT_GT(whole, 0);
  EXPECT_LT(whole, 20'000);
}

}  // namespace
}  // namespace seqloop::opencv
