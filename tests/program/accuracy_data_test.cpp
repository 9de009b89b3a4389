// Recall at 100 % precision on the real drives: the numbers that the README names, with room for
// what another build of OpenCV rounds otherwise.
#include <nlohmann/json.hpp>

#include "program/program.hpp"
#include "shared_data.hpp"

namespace seqloop {
namespace {

class Accuracy : public test::Program {
 protected:
  double recall_at_100_precision(const std::string& reference, const std::string& query,
                                 const std::string& match, const std::string& eval,
                                 const std::string& describe = "") {
    for (const auto& [drive, out] : {std::pair{reference, "r.npy"}, std::pair{query, "q.npy"}}) {
      if (exists(out)) continue;
      const auto outcome = run("describe --source '" + drive + "' --out " + out + ' ' + describe);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    const auto matched = run("match --reference r.npy --query q.npy --out m.csv " + match);
    EXPECT_EQ(matched.exit_code, 0) << matched.err;
    const auto evaluated = run("eval --json --matches m.csv " + eval);
    const auto measures = nlohmann::json::parse(evaluated.out);
    std::printf("%s: %s\n", match.c_str(), measures.dump().c_str());
    return measures["recall_at_100_precision"].get<double>();
  }
};

TEST_F(Accuracy, GardensPointWithTheBuiltInDescriptor) {
  SEQLOOP_DATA_OR_SKIP(shared);
  const std::string drives = (shared / "data/gardens_point/").string();
  const auto at = [&](const std::string& ds) {
    return recall_at_100_precision(drives + "day_left", drives + "night_right",
                                   "--method seqcnnslam --ds " + ds, "--frames 200");
  };
  EXPECT_GE(at("40"), 0.60);
  EXPECT_GE(at("20"), 0.45);
}

TEST_F(Accuracy, GardensPointWithPool5ToTheLetter) {
  SEQLOOP_DATA_OR_SKIP(shared);
  const std::string drives = (shared / "data/gardens_point/").string();
  EXPECT_NEAR(
      recall_at_100_precision(
          drives + "day_left", drives + "night_right", "--paper --method seqcnnslam --ds 40",
          "--frames 200",
          "--layer pool5 --mean 104.05,112.51,116.67 --scale 0.00392156862745098 --model '" +
              (shared / "models/squeezenet11_places365.onnx").string() + "'"),
      0.800, 1e-9);
}

TEST_F(Accuracy, NordlandWithTheBuiltInDescriptor) {
  SEQLOOP_DATA_OR_SKIP(shared);
  const std::string drives = (shared / "data/nordland_64x32/").string();
  const auto at = [&](const std::string& match) {
    return recall_at_100_precision(drives + "summer", drives + "winter", match,
                                   "--frames 2400 --tolerance 1");
  };
  EXPECT_GE(at("--method seqcnnslam --ds 20"), 0.88);
  EXPECT_GE(at("--method seqcnnslam --ds 100"), 0.95);
  // To the letter, candidate ranges lose loops between two full searches.
  EXPECT_NEAR(at("--method a-seqcnnslam --ds 20"), 0.60, 0.05);
  EXPECT_NEAR(at("--method o-seqcnnslam --ds 20"), 0.765, 0.05);
}

}  // namespace
}  // namespace seqloop
