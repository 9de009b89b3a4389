// SPDX-License-Identifier: MIT
#include "experiment/report/results_csv.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "experiment/report/columns.hpp"
#include "experiment/report/selection.hpp"
#include "experiment/report/text.hpp"
#include "experiment/synthetic_result.hpp"

namespace seqloop::experiment {
namespace {

Result with_settings(std::vector<Setting> settings) {
  return synthetic_result("p", "m", "d", std::move(settings), 0.5);
}

TEST(ResultsCsv, HasARowForEachResultAndAColumnForEachSetting) {
  Result first = with_settings({{"ds", "20"}});
  first.measures.answered = 1900;
  first.measures.correct = 1800;
  first.measures.area_under_curve = 1.0 / 3.0;
  first.most_distances = 4'000'000'000;
  first.candidates = 22.5;
  first.measures.unknown = 7;
  first.measures.accepted = 1500;
  first.measures.accepted_precision = 1.0;
  first.measures.accepted_recall = 0.625;
  first.measures.reliability[9] = {4, 3, 3.8};
  Result second =
      synthetic_result("a, b", "the \"best\"", "two\nlines", {{"k", "10"}, {"ds", "40"}}, 0.0);
  second.speed_up = 5.25;
  EXPECT_EQ(results_csv({first, second}),
            "pair,method,descriptor,ds,k,places,queries,frames,descriptor_size,answered,correct,"
            "unknown,precision,recall,recall_at_100_precision,area_under_curve,accepted,"
            "accepted_precision,accepted_recall,expected_calibration_error,distances,"
            "most_distances,candidates,seconds,speed_up\n"
            "p,m,d,20,,2400,2400,2400,735,1900,1800,7,0.75,0.5,0.5,0.333333333,1500,1,0.625,0.2,"
            "43264.5,4e+09,22.5,12.34,nan\n"
            "\"a, b\",\"the \"\"best\"\"\",\"two\nlines\",40,10,2400,2400,2400,735,0,0,0,0,0,0,0,"
            "nan,nan,nan,nan,43264.5,0,0,12.34,5.25\n");
}

TEST(ResultsCsv, OfNothingIsAHeader) {
  EXPECT_TRUE(results_csv({}).starts_with("pair,method,descriptor,places,"));
}

TEST(Result, HasValuesAndNumbersUnderNames) {
  const Result result = with_settings({{"ds", "20"}, {"enhance", "on"}, {"vmax", "1.2 "}});
  EXPECT_EQ(value_of(result, "pair"), "p");
  EXPECT_EQ(value_of(result, "method"), "m");
  EXPECT_EQ(value_of(result, "descriptor"), "d");
  EXPECT_EQ(value_of(result, "enhance"), "on");
  EXPECT_EQ(value_of(result, "k"), "");
  EXPECT_EQ(number_of(result, "ds"), 20.0);
  EXPECT_EQ(number_of(result, "seconds"), 12.34);
  EXPECT_EQ(number_of(result, "recall_at_100_precision"), 0.5);
  for (const char* none : {"enhance", "vmax", "k", "pair", "speed_up", ""}) {
    EXPECT_TRUE(std::isnan(number_of(result, none))) << none;
  }
}

TEST(Columns, AreShownToPeople) {
  const double nan = std::nan("");
  EXPECT_EQ(shown(Unit::count, 3476.0), "3,476");
  EXPECT_EQ(shown(Unit::count, 1234567.8), "1,234,568");
  EXPECT_EQ(shown(Unit::count, 999.0), "999");
  EXPECT_EQ(shown(Unit::count, 22.46), "22.5");
  EXPECT_EQ(shown(Unit::share, 0.8), ".800");
  EXPECT_EQ(shown(Unit::share, 1.0), "1.000");
  EXPECT_EQ(shown(Unit::share, 0.0), ".000");
  EXPECT_EQ(shown(Unit::seconds, 3989.4), "3,989");
  EXPECT_EQ(shown(Unit::seconds, 98.42), "98.4");
  EXPECT_EQ(shown(Unit::seconds, 0.0123), "0.012");
  EXPECT_EQ(shown(Unit::times, 5.23), "×5.2");
  EXPECT_EQ(shown(Unit::times, nan), "–");
}

TEST(Selection, SortsNumbersBySizeAndWordsAsTheyCome) {
  const std::vector<Result> results{
      with_settings({{"ds", "100"}, {"use", "b"}}), with_settings({{"ds", "20"}, {"use", "a"}}),
      with_settings({{"ds", "100"}, {"use", "a"}}), with_settings({{"ds", "20"}, {"use", "a"}})};
  const std::vector<Key> expected{{"20", "a"}, {"100", "b"}, {"100", "a"}};
  EXPECT_EQ(keys_of(choose(results, {}), {"ds", "use"}), expected);
  EXPECT_EQ(choose(results, {{"ds", {"20"}}, {"use", {"a", "c"}}}).size(), 2U);
  EXPECT_EQ(unnamed_differences(choose(results, {}), {"ds"}), Names{"use"});
  EXPECT_EQ(in_words({"method", "ds", "k"}, {"A-", "20", ""}), "A- ds 20");
}

TEST(Text, IsSafeInXml) {
  EXPECT_EQ(escaped("a<b> & \"c\"\té"), "a&lt;b&gt; &amp; &quot;c&quot;\té");
  EXPECT_EQ(escaped("\x01|\xFF|\xC3|\xED\xA0\x80|\xC0\x80"),
            "\uFFFD|\uFFFD|\uFFFD|\uFFFD\uFFFD\uFFFD|\uFFFD\uFFFD");
}

TEST(Text, IsShortenedInTheMiddleAndWrappedAtSpaces) {
  EXPECT_EQ(shortened("short", 10.0, 100.0), "short");
  EXPECT_EQ(shortened("00000000aa99999999", 10.0, 56.0), "0000…999");
  EXPECT_EQ(wrapped("aaaa aaaa bbbb", 10.0, 56.0), (std::vector<std::string>{"aaaa aaaa", "bbbb"}));
  EXPECT_EQ(slug("Fig. 4: A-SeqCNNSLAM, K × Num?"), "fig-4-a-seqcnnslam-k-num");
  EXPECT_EQ(slug(std::string(60, 'x')), std::string(40, 'x'));
  EXPECT_EQ(slug("→"), "");
}

// What DejaVu Sans takes, which a Debian has where nobody has installed another font.
TEST(Text, IsAsWideAsInTheWidestFont) {
  EXPECT_GE(text_width("abcdefghijklmnopqrstuvwxyz", 1.0), 14.65);
  EXPECT_GE(text_width("ABCDEFGHIJKLMNOPQRSTUVWXYZ", 1.0), 17.47);
  EXPECT_GE(text_width("0123456789.,-+%×", 1.0), 6.36 + 0.32 + 0.32 + 0.36 + 0.84 + 0.95 + 0.84);
  EXPECT_LE(text_width("SeqCNNSLAM standardised", 1.0), 1.15 * 13.64);
}

TEST(Text, IsMadeOfBytes) {
  const std::vector<std::uint8_t> bytes{'M', 'a', 'n', 0xFF};
  EXPECT_EQ(base64(std::span(bytes).first(0)), "");
  EXPECT_EQ(base64(std::span(bytes).first(1)), "TQ==");
  EXPECT_EQ(base64(std::span(bytes).first(2)), "TWE=");
  EXPECT_EQ(base64(std::span(bytes).first(3)), "TWFu");
  EXPECT_EQ(base64(bytes), "TWFu/w==");
}

}  // namespace
}  // namespace seqloop::experiment
