// SPDX-License-Identifier: MIT
// What a loop hands over to whoever watches it, and what these make of it.
#include "program/watch/watch.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/allocation_guard.hpp"
#include "core/matcher.hpp"
#include "expect_setup_error.hpp"
#include "program/watch/metrics.hpp"
#include "program/watch/picture_store.hpp"
#include "program/watch/report_page.hpp"
#include "program/watch/run_view.hpp"
#include "without_system_calls.hpp"

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

Answer match_at(std::uint64_t frame, std::size_t place) {
  Answer answer;
  answer.frame = frame;
  answer.gate = Gate::match;
  answer.probability = 0.995F;
  answer.match = Match{place, 0.5F, 0.7F, 1.0, place};
  return answer;
}

/// A loop that is watched, frame by frame.
class WatchedLoop {
 public:
  WatchedLoop() : summary_(Budget{}, false), pixels_(320 * 200, 7) {}

  void frame(std::uint64_t number) {
    answers_[0] = match_at(number, static_cast<std::size_t>(number / 2));
    ProcessedFrame processed;
    processed.report.newest = number;
    processed.report.gate = Gate::match;
    processed.report.answers = answers_;
    processed.frame.time_s = static_cast<double>(number) / 10.0;
    processed.frame.image = {pixels_.data(), 320, 200, 320, PixelFormat::gray8};
    processed.fault = "";
    processed.times.grab = 300us;
    processed.times.match = 3ms;
    processed.times.total = 3300us;
    publish(processed, number);
  }

  /// A frame of a detector.
  void frame(const FrameReport& report) {
    ProcessedFrame processed;
    processed.report = report;
    processed.frame.image = {pixels_.data(), 320, 200, 320, PixelFormat::gray8};
    processed.times.total = 1ms;
    publish(processed, report.newest);
  }

  std::unique_ptr<Watch> watch = std::make_unique<Watch>();

 private:
  void publish(const ProcessedFrame& processed, std::uint64_t number) {
    const LoopState state{};
    summary_.add(processed, state);
    watch->publish(processed, state, summary_, {40, number / 2},
                   std::chrono::milliseconds(10 * number));
  }

  RunSummary summary_;
  std::vector<std::uint8_t> pixels_;
  std::array<Answer, 1> answers_;
};

TEST(Watch, HandingOverTakesNoMemoryEvenWhereNobodyTakesIt) {
  if (!AllocationGuard::works()) GTEST_SKIP() << "a sanitizer's heap cannot be counted";
  WatchedLoop loop;
  loop.frame(0);
  const AllocationGuard guard;
  for (std::uint64_t n = 1; n < 10'000; ++n) loop.frame(n);
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(loop.watch->unseen(), (10'000U - 512U) + (10'000U - 8'192U))
      << "counted, not waited for";
  auto* const volatile heap = new int(1);  // and the guard sees one
  delete heap;
  EXPECT_EQ(guard.count(), 1U);
}

TEST(Watch, AFrameThatIsWatchedMakesNoSystemCall) {
  if (const char* const why = test::system_calls_cannot_be_forbidden()) GTEST_SKIP() << why;
  const oracle::Vectors lap = oracle::drive(31, 150, 40, 0.2F);
  MatcherConfig config;
  config.use = Use::close_loops;
  config.exclude = 30;
  PlaceMap map(config, {600, 40});
  Detector detector(config, map);
  WatchedLoop loop;
  loop.watch->wishes.pictures = true;
  EXPECT_EQ(test::status_without_system_calls([&] {
              std::size_t matched = 0;
              for (std::size_t n = 0; n < 500; ++n) {
                const FrameReport report = detector.step(lap[n % lap.size()]);
                matched += report.match.has_value();
                loop.frame(report);
              }
              return matched > 100 && loop.watch->pictures().front() != nullptr;
            }),
            0);
}

TEST(Watch, WhatIsTakenIsWhatWasHandedOver) {
  WatchedLoop loop;
  for (std::uint64_t n = 0; n < 20; ++n) loop.frame(n);
  for (std::uint64_t n = 0; n < 20; ++n) {
    const Snapshot* snapshot = loop.watch->frames().front();
    ASSERT_NE(snapshot, nullptr);
    EXPECT_EQ(snapshot->frame.report.newest, n);
    EXPECT_EQ(snapshot->counts.frames, n + 1);
    EXPECT_EQ(snapshot->map.places, 40U);
    EXPECT_EQ(snapshot->map.saved, n / 2);
    EXPECT_EQ(snapshot->counts.at[static_cast<std::size_t>(Gate::match)], n + 1);
    EXPECT_EQ(snapshot->counts.stages[2].in[5], n + 1) << "3 ms is in the bucket up to 5 ms";
    EXPECT_EQ(snapshot->frame.frame.image.data, nullptr) << "which is the loop's own";
    EXPECT_TRUE(snapshot->frame.report.answers.empty());
    loop.watch->frames().pop();
    ASSERT_EQ(loop.watch->answers().front()->frame, n);
    loop.watch->answers().pop();
    ASSERT_EQ(loop.watch->pictures().front()->number, n);
    EXPECT_EQ(loop.watch->pictures().front()->width, 160);
    EXPECT_EQ(loop.watch->pictures().front()->height, 100);
    loop.watch->pictures().pop();
  }
  EXPECT_EQ(loop.watch->frames().front(), nullptr);
}

TEST(Watch, PicturesAreThoseThatAreKeptAndForWhoLooks) {
  WatchedLoop loop;
  loop.watch->wishes.every = 16;
  const auto numbers = [&](std::uint64_t from, std::uint64_t to) {
    std::vector<std::uint64_t> all;
    for (std::uint64_t n = from; n < to; ++n) loop.frame(n);
    for (; loop.watch->pictures().front() != nullptr; loop.watch->pictures().pop())
      all.push_back(loop.watch->pictures().front()->number);
    return all;
  };
  EXPECT_EQ(numbers(0, 40), (std::vector<std::uint64_t>{0, 16, 32}));
  loop.watch->wishes.pictures = true;  // ten a second, and a frame takes 10 ms
  EXPECT_EQ(numbers(40, 70), (std::vector<std::uint64_t>{42, 48, 58, 64}));
}

TEST(Shrink, TakesEveryNthPixel) {
  std::vector<std::uint8_t> pixels(std::size_t{641} * 3 * 480);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i % 251);
  const auto small = std::make_unique<SmallPicture>();
  ASSERT_TRUE(shrink({pixels.data(), 641, 480, 641 * 3, PixelFormat::bgr8}, 5, *small));
  EXPECT_EQ(small->width, 128);  // of 641, every 5th
  EXPECT_EQ(small->height, 96);
  for (const auto& [x, y] : {std::pair{0, 0}, std::pair{127, 95}, std::pair{64, 3}}) {
    const std::size_t from = static_cast<std::size_t>((y * 5 + 2) * 641 * 3 + (x * 5 + 2) * 3);
    EXPECT_EQ(small->pixels[static_cast<std::size_t>(y * 128 + x) * 3 + 1], pixels[from + 1]);
  }
  EXPECT_FALSE(shrink({}, 5, *small));
  ASSERT_TRUE(shrink({pixels.data(), 1, 480, 3, PixelFormat::gray8}, 5, *small) == false ||
              small->width == 1);
}

TEST(PictureStore, ThinsOutEvenlyAndFindsNeighbours) {
  SmallPicture picture;
  picture.width = 10;
  picture.height = 10;
  PictureStore store(1000);  // ten of them
  EXPECT_TRUE(store.around(3).empty());
  for (picture.number = 0; picture.number < 100; ++picture.number) store.add(picture);
  EXPECT_EQ(store.every(), 16U);
  EXPECT_EQ(store.around(0), (std::vector<std::uint64_t>{0, 16}));
  EXPECT_EQ(store.around(39), (std::vector<std::uint64_t>{16, 32, 48}));
  EXPECT_EQ(store.around(1000), (std::vector<std::uint64_t>{80, 96}));
  EXPECT_EQ(store.newest(), 99U);
  EXPECT_TRUE(store.jpeg(99).starts_with("\xFF\xD8"));
  EXPECT_TRUE(store.jpeg(17).empty());
}

TEST(RunView, HoldsALongRunInBoundedMemory) {
  RunView view(Json{{"source", "a"}});
  const auto snapshot = std::make_unique<Snapshot>();
  constexpr std::uint64_t frames = 100'000;
  for (std::uint64_t n = 0; n < frames; ++n) {
    snapshot->frame.report.newest = n;
    snapshot->frame.frame.time_s = static_cast<double>(n);
    view.take(*snapshot, 0.0);
    view.take(match_at(n, static_cast<std::size_t>(n / 2)));
  }
  const Json history = view.history();
  EXPECT_EQ(history["frames"].size(), RunView::most_frames);
  EXPECT_LE(history["answers"].size(), RunView::most_answers + 2'000);
  EXPECT_GE(history["answers"].size(), RunView::most_answers / 2);
  EXPECT_EQ(history["answers"].back()[0], frames - 1);
  const Json loops = view.loops(99'990, 100);
  EXPECT_EQ(loops["count"], frames);
  ASSERT_EQ(loops["loops"].size(), 10U);
  EXPECT_EQ(loops["loops"][9]["frame"], frames - 1);
  EXPECT_EQ(loops["loops"][9]["time_s"], frames - 1);
  EXPECT_EQ(view.loops(200'000, 10)["loops"].size(), 0U);
  const Json event = view.event(frames - 3, frames - 2);
  EXPECT_EQ(event["frames"].size(), 3U);
  EXPECT_EQ(event["answers"].size(), 2U);
}

TEST(RunView, VerdictsBecomeATruth) {
  RunView view(Json::object());
  for (std::uint64_t n = 0; n < 4; ++n) view.take(match_at(10 * n, static_cast<std::size_t>(n)));
  EXPECT_TRUE(view.judge(1, Verdict::accepted));
  EXPECT_TRUE(view.judge(2, Verdict::rejected));
  EXPECT_TRUE(view.judge(3, Verdict::accepted));
  EXPECT_FALSE(view.judge(4, Verdict::accepted));
  EXPECT_EQ(view.truth_csv(), "query,reference\n10,1\n30,3\n");
  EXPECT_TRUE(view.judge(3, Verdict::none));
  EXPECT_EQ(view.truth_csv(), "query,reference\n10,1\n");
  EXPECT_EQ(view.loops(2, 1)["loops"][0]["verdict"], "rejected");
}

TEST(RunView, NamesOfMarksEndWithAWholeCharacter) {
  RunView view(Json::object());
  view.take(*std::make_unique<Snapshot>(), 0.0);
  const std::string most(RunView::most_name, 'a');
  EXPECT_TRUE(view.mark(most + "b"));
  for (const char* door : {"\u00FC", "\u20AC", "\U0001F6AA"}) {
    for (std::size_t before = most.size() - 4; before < most.size(); ++before) {
      EXPECT_TRUE(view.mark(most.substr(0, before) + door + door));
    }
  }
  const Json marks = view.marks();
  EXPECT_EQ(marks[0]["name"], most);
  EXPECT_EQ(marks[1]["name"], most.substr(4) + "\u00FC\u00FC");
  EXPECT_EQ(marks[4]["name"], most.substr(1)) << "no half of it";
  EXPECT_NO_THROW(static_cast<void>(marks.dump())) << "which takes UTF-8 alone";
}

TEST(RunView, LoopsWithOtherRobotsAreNamedByRobot) {
  RunView view(Json::object());
  const auto snapshot = std::make_unique<Snapshot>();
  view.take(*snapshot, 0.0);
  EXPECT_FALSE(view.status().contains("fleet")) << "alone";
  snapshot->map.of_others = 70;
  view.take(*snapshot, 0.1);
  view.take(match_at(10, 1));
  const auto loop = std::make_unique<OtherLoop>();
  for (const char* robot : {"anna", "bert", "anna"}) {
    loop->answer = match_at(20, 5);
    loop->robot.assign({robot});
    loop->session.assign({"monday"});
    view.take(*loop);
  }
  const Json status = view.status();
  EXPECT_EQ(status["fleet"], (Json{{"places", 70}, {"loops", 3}}));
  EXPECT_EQ(status["loops"]["count"], 4);
  EXPECT_EQ(status["last_match"]["match"], 1) << "of the own map";
  const Json loops = view.loops(0, 10)["loops"];
  ASSERT_EQ(loops.size(), 4U);
  EXPECT_FALSE(loops[0].contains("robot"));
  EXPECT_EQ(loops[2]["robot"], "bert");
  EXPECT_EQ(loops[3]["robot"], "anna");
  EXPECT_EQ(loops[3]["session"], "monday");
  EXPECT_EQ(loops[3]["match"], 5);
  EXPECT_FALSE(view.judge(2, Verdict::accepted)) << "it is in no map here";
  EXPECT_EQ(view.truth_csv(), "query,reference\n");
}

TEST(Watch, LoopsWithOtherRobotsAreHandedOver) {
  WatchedLoop loop;
  std::vector<OtherLoop> loops(600);
  for (std::size_t n = 0; n < loops.size(); ++n) {
    loops[n].answer.frame = n;
    loops[n].robot.assign({"anna"});
  }
  loop.watch->publish(loops);
  EXPECT_EQ(loop.watch->unseen(), 600U - 512U) << "counted, not waited for";
  EXPECT_EQ(loop.watch->loops().front()->robot.view(), "anna");
}

TEST(RunView, TellsTroublesOnceAndTheNewestOfThem) {
  RunView view(Json::object());
  const auto snapshot = std::make_unique<Snapshot>();
  EXPECT_TRUE(view.status()["troubles"].empty());
  EXPECT_FALSE(view.status()["map"].contains("saved")) << "of a map in memory nothing is";
  for (std::uint64_t n = 0; n < 100; ++n) {
    snapshot->frame.report.newest = n;
    snapshot->fault.assign({n < 50 ? "torn" : ""});
    snapshot->remark.assign({n == 60 || n > 70 ? fmt::format("odd {}", n) : ""});
    view.take(*snapshot, 0.0);
  }
  const Json troubles = view.status()["troubles"];
  ASSERT_EQ(troubles.size(), RunView::most_troubles);
  EXPECT_EQ(troubles.back(), Json::parse(R"({"frame": 99, "times": 1, "text": "odd 99"})"));
  RunView torn(Json{{"sessions", Json::array()}});
  snapshot->fault.assign({"torn"});
  for (int n = 0; n < 3; ++n) torn.take(*snapshot, 0.0);
  EXPECT_EQ(torn.status()["troubles"][0]["times"], 3);
  EXPECT_EQ(torn.status()["map"]["saved"], 0);
}

TEST(RunView, ASilenceIsOneTroubleOfNoFrame) {
  RunView view(Json::object());
  const auto snapshot = std::make_unique<Snapshot>();
  const auto take = [&](Gate gate, std::uint64_t newest, const std::string& fault) {
    snapshot->frame.report.gate = gate;
    snapshot->frame.report.newest = newest;
    snapshot->fault.assign({fault});
    view.take(*snapshot, 0.0);
  };
  take(Gate::frame_error, 7, "torn");
  for (int n = 0; n < 30; ++n) take(Gate::no_frame, 0, fmt::format("away for {} s", n));
  EXPECT_EQ(view.status()["troubles"], Json::parse(R"([{"frame": 7, "times": 1, "text": "torn"},
    {"frame": null, "times": 30, "text": "away for 29 s"}])"));
  take(Gate::frame_error, 8, "torn");
  take(Gate::frame_error, 9, "torn");
  EXPECT_EQ(view.status()["troubles"].back(),
            Json::parse(R"({"frame": 9, "times": 2, "text": "torn"})"));
}

TEST(RunView, IsIllWithoutFramesAndOverItsBudget) {
  RunView view(Json::object());
  const auto snapshot = std::make_unique<Snapshot>();
  EXPECT_EQ(view.trouble(100.0), "");
  view.take(*snapshot, 100.0);
  EXPECT_EQ(view.trouble(109.0), "");
  snapshot->frame.report.gate = Gate::no_frame;
  view.take(*snapshot, 111.0);
  EXPECT_EQ(view.trouble(111.0), "no frame for 11 seconds");
  snapshot->frame.report.gate = Gate::match;
  snapshot->state.overloaded = true;
  view.take(*snapshot, 112.0);
  view.take(*snapshot, 123.0);
  EXPECT_EQ(view.trouble(123.0), "over the budget for 11 seconds");
  snapshot->state.overloaded = false;
  view.take(*snapshot, 124.0);
  EXPECT_EQ(view.trouble(124.0), "");
}

TEST(RunView, APauseIsNoTrouble) {
  RunView view(Json::object());
  const auto snapshot = std::make_unique<Snapshot>();
  view.pause(50.0);
  EXPECT_EQ(view.trouble(100.0), "") << "no frame has been due";
  snapshot->frame.report.gate = Gate::match;
  snapshot->state.overloaded = true;
  view.take(*snapshot, 100.0);
  view.pause(130.0);
  EXPECT_EQ(view.trouble(130.1), "");
  EXPECT_EQ(view.trouble(141.0), "no frame for 11 seconds") << "after it, the camera is gone";
  view.take(*snapshot, 141.0);
  EXPECT_EQ(view.trouble(141.0), "") << "over the budget since now";
}

TEST(Metrics, BucketsAddUp) {
  WatchedLoop loop;
  for (std::uint64_t n = 0; n < 20; ++n) loop.frame(n);
  const Snapshot* last = nullptr;
  for (int n = 0; n < 20; ++n) {
    last = loop.watch->frames().front();
    if (n < 19) loop.watch->frames().pop();
  }
  const std::string text = metrics(*last, {"seqloop 1 (abc)", 50, 1000, 2000, 3, 1, 9, false});
  for (const char* line :
       {"seqloop_frames_total 20\n", "seqloop_matches_total 20\n", "seqloop_healthy 0\n",
        "seqloop_stage_seconds_bucket{stage=\"match\",le=\"0.002\"} 0\n",
        "seqloop_stage_seconds_bucket{stage=\"match\",le=\"0.005\"} 20\n",
        "seqloop_stage_seconds_bucket{stage=\"match\",le=\"+Inf\"} 20\n",
        "seqloop_stage_seconds_count{stage=\"match\"} 20\n", "seqloop_places 40\n",
        "seqloop_build_info{version=\"seqloop 1 (abc)\"} 1\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
}

TEST(ReportPage, HoldsTheRunAndNoMarkupOfOthers) {
  const std::string answer =
      R"({"frame":1,"status":"match","match":0,"probability":0.995,"score":0.5,"uniqueness":0.6,)"
      R"("velocity":1.0,"head":0})";
  const std::string line =
      R"({"frame":null,"newest":2,"time_s":0.2,"status":"warming_up","match":null,"answers":[)" +
      answer +
      R"(],"now":null,"k":1,"candidates":2,"distances":3,"full_search":false,"map_full":false,)"
      R"("deadline_missed":true,"overloaded":false,"dropped":1,"lost":0,"sequence":7,)"
      R"("latency_ms":{"grab":1.0,"describe":2.0,"match":3.0,"total":6.0},"age_ms":0.0})";
  std::string next = line;
  next.replace(next.find("\"newest\":2"), 10, "\"newest\":3");
  std::istringstream lines(line + "\n" + next + "\n");
  const std::string page = report_page(lines, "r.jsonl", {{"source", "</script><b>"}});
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_NE(page.find("\"frames\":2"), std::string::npos);
  EXPECT_NE(page.find("\"match\":2"), std::string::npos) << "gates";
  EXPECT_EQ(page.find("src=\"/"), std::string::npos) << "nothing is fetched";
  std::istringstream none("");
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)report_page(none, "r", {}); }), "empty"));
  std::istringstream twice(line + "\n" + line + "\n");
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)report_page(twice, "r", {}); }), "r:2"));
  std::istringstream other(line + "\n{}\n");
  EXPECT_TRUE(test::says(test::setup_error([&] { (void)report_page(other, "r", {}); }), "r:2"));
}

}  // namespace
}  // namespace seqloop::program
