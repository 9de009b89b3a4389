// SPDX-License-Identifier: MIT
// The real program, watched while it runs.
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "core/oracle.hpp"
#include "http/client.hpp"
#include "platform/pictures.hpp"
#include "program/program.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class Serve : public test::Program {
 protected:
  void SetUp() override {
    const oracle::Vectors lap = oracle::drive(11, 150, 24, 0.2F);
    files::NpyWriter writer(file("q.npy"), 24);
    for (int n = 0; n < 4; ++n) {
      for (const auto& row : lap) writer.append(row);
    }
    writer.commit();
    folder_.write("token", "0123456789abcdef\n");
  }

  /// Starts a run that is served, and waits until it is.
  void start(const std::string& arguments) {
    const std::string command = "cd '" + folder_.path().string() +
                                "' && { '" SEQLOOP_BINARY
                                "' run --exclude 20 --serve 127.0.0.1:0 --serve-token "
                                "token --out r.jsonl " +
                                arguments + "; echo $? >code.txt; } 2>err.txt </dev/null &";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const std::string sign = "serving on http://127.0.0.1:";
    for (int n = 0; n < 1200 && port_ == 0; ++n) {
      const std::string said = test::read_all(file("err.txt"));
      const std::size_t at = said.find(sign);
      if (at != std::string::npos && said.find('\n', at) != std::string::npos)
        port_ = static_cast<std::uint16_t>(std::stoi(said.substr(at + sign.size())));
      std::this_thread::sleep_for(50ms);
    }
    ASSERT_NE(port_, 0) << test::read_all(file("err.txt"));
  }

  [[nodiscard]] std::string ask(const std::string& request) const {
    http::test::Client client(port_);
    client.send(request);
    bool complete = false;
    return client.reply(complete, 30'000);
  }
  [[nodiscard]] std::string get(const std::string& path) const {
    return ask("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  [[nodiscard]] std::string post(const std::string& path, const Json& wish) const {
    const std::string body = wish.dump();
    return ask("POST " + path +
               " HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer 0123456789abcdef\r\n"
               "Content-Type: application/json\r\nContent-Length: " +
               std::to_string(body.size()) + "\r\n\r\n" + body);
  }
  static Json json(const std::string& reply) {
    return Json::parse(reply.substr(reply.find("\r\n\r\n") + 4), nullptr, false);
  }
  /// Asks until it holds.
  template <class Condition>
  bool until(Condition holds) const {
    for (int n = 0; n < 600; ++n) {
      const std::string reply = get("/api/status");
      if (!reply.starts_with("HTTP/1.1 200")) return false;  // it is over
      if (holds(json(reply))) return true;
      std::this_thread::sleep_for(50ms);
    }
    return false;
  }
  [[nodiscard]] std::string ended() const {
    // The shell makes the file before it writes.
    std::string code;
    for (int n = 0; n < 1200 && !code.ends_with('\n'); ++n) {
      std::this_thread::sleep_for(50ms);
      code = test::read_all(file("code.txt"));
    }
    return code;
  }
  /// Lines of a run, without the times that no two runs share.
  [[nodiscard]] std::vector<Json> lines(const std::string& name) const {
    std::istringstream text(test::read_all(file(name)));
    std::vector<Json> all;
    for (std::string line; std::getline(text, line);) {
      all.push_back(Json::parse(line));
      for (const char* timed : {"latency_ms", "age_ms", "deadline_missed", "missed"})
        all.back().erase(timed);
    }
    return all;
  }

  std::uint16_t port_ = 0;
};

TEST_F(Serve, ShowsTheRunAndTakesWishesWithTheToken) {
  start(
      "--source q.npy --pace live --fps 40 --budget-total 10000 --min-probability 1 "
      "--summary s.json");
  ASSERT_TRUE(until([](const Json& status) { return status["counts"]["frames"] > 5; }));
  ASSERT_TRUE(post("/api/control", {{"do", "pause"}}).starts_with("HTTP/1.1 200"));
  ASSERT_TRUE(until([](const Json& status) { return status["state"] == "paused"; }));
  EXPECT_TRUE(get("/").find("<title>SeqLoop</title>") != std::string::npos);
  EXPECT_TRUE(get("/page.js").find("'use strict'") != std::string::npos);
  EXPECT_EQ(get("/page.js").find("innerHTML"), std::string::npos) << "names are text";
  EXPECT_TRUE(get("/healthz").ends_with("\r\n\r\nok\n"));
  EXPECT_NE(get("/metrics").find("seqloop_frames_total "), std::string::npos);
  const auto answered = [&](const std::string& path, const Json& wish) {
    const std::string reply = post(path, wish);
    return reply.size() < 12 ? "nothing" : reply.substr(9, 3);
  };
  EXPECT_EQ(answered("/api/control", {{"do", "mark"}, {"name", "<door>"}}), "200");
  EXPECT_EQ(json(get("/api/marks"))[0]["name"], "<door>");
  for (const double no : {2.0, 0.0, 1e-60}) {
    EXPECT_EQ(answered("/api/control", {{"do", "threshold"}, {"min_probability", no}}), "400");
  }
  EXPECT_EQ(answered("/api/control", {{"do", 7}}), "400");
  EXPECT_EQ(answered("/api/control", {{"do", "save"}}), "409") << "there is no map in a file";
  EXPECT_EQ(answered("/api/control", Json::array()), "400");
  EXPECT_EQ(answered("/api/verdict", {{"loop", 0}, {"verdict", "rejected"}}), "404");
  EXPECT_EQ(answered("/api/other", Json::object()), "404");
  EXPECT_TRUE(get("/api/picture?of=frame&number=1").starts_with("HTTP/1.1 404")) << "no pictures";
  EXPECT_TRUE(get("/api/picture").starts_with("HTTP/1.1 400"));
  EXPECT_EQ(answered("/api/control", {{"do", "threshold"}, {"min_probability", .5}}), "200");
  const Json status = json(get("/api/status"));
  EXPECT_EQ(status["run"]["source"], "q.npy");
  EXPECT_EQ(status["run"]["method"], "o-seqcnnslam");
  EXPECT_GT(status["run"]["memory_planned"], 1000);
  EXPECT_EQ(status["run"]["decision"]["min_probability"], .5);
  EXPECT_TRUE(status["frame"].contains("latency_ms"));
  EXPECT_EQ(status["counts"]["gates"]["match"], 0);
  EXPECT_EQ(answered("/api/control", {{"do", "resume"}}), "200");
  EXPECT_TRUE(until([](const Json& now) { return now["counts"]["gates"]["match"] > 0; }))
      << "the new threshold holds";
  EXPECT_EQ(answered("/api/verdict", {{"loop", 0}, {"verdict", "accepted"}}), "200");
  for (const char* wrong : {"first=abc", "first=-1", "first=0&count=1e3"}) {
    const std::string reply = get("/api/loops?" + std::string(wrong));
    EXPECT_TRUE(reply.starts_with("HTTP/1.1 400")) << reply;
    EXPECT_TRUE(json(reply)["error"].is_string());
  }
  const Json loop = json(get("/api/loops?first=0&count=1"))["loops"][0];
  Json verdict{
      {"loop", 0}, {"frame", loop["frame"]}, {"match", loop["match"]}, {"verdict", "accepted"}};
  EXPECT_EQ(answered("/api/verdict", verdict), "200");
  for (const char* key : {"frame", "match"}) {
    Json other = verdict;
    other[key] = loop[key].get<int>() + 1;
    EXPECT_EQ(answered("/api/verdict", other), "409") << "a loop of an earlier run: " << key;
    other[key] = "none";
    EXPECT_EQ(answered("/api/verdict", other), "400") << key;
  }
  // What is no verdict takes none back.
  for (const char* word : {"", "rejectd", "Accepted"}) {
    EXPECT_EQ(answered("/api/verdict", {{"loop", 0}, {"verdict", word}}), "400") << word;
  }
  EXPECT_EQ(answered("/api/verdict", {{"loop", 0}}), "400");
  EXPECT_EQ(json(get("/api/loops?first=0&count=1"))["loops"][0]["verdict"], "accepted");
  EXPECT_NE(get("/api/truth.csv").find("query,reference\n"), std::string::npos);
  EXPECT_EQ(answered("/api/control", {{"do", "stop"}}), "200");
  EXPECT_EQ(ended(), "0\n") << test::read_all(file("err.txt"));
  const Json decision = Json::parse(test::read_all(file("s.json")))["decision"];
  EXPECT_EQ(decision["min_probability"], 1);
  ASSERT_EQ(decision["changes"].size(), 1U) << decision;
  EXPECT_EQ(decision["changes"][0]["min_probability"], .5);
  EXPECT_GT(decision["changes"][0]["frame"], 5);
}

TEST_F(Serve, TheLastEventCountsTheAnswersOfTheEnd) {
  start("--source q.npy --pace live --fps 300 --budget-total 10000 --summary s.json");
  http::test::Client page(port_);
  page.send("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  while (page.receive(60'000)) {
  }
  EXPECT_EQ(ended(), "0\n") << test::read_all(file("err.txt"));
  const std::string& events = page.received();
  const std::size_t last = events.rfind("data: ");
  ASSERT_NE(last, std::string::npos) << events;
  const std::size_t from = last + 6;
  const Json status = Json::parse(events.substr(from, events.find('\n', from) - from))["status"];
  EXPECT_EQ(status["state"], "ended");
  EXPECT_EQ(status["counts"]["gates"], Json::parse(test::read_all(file("s.json")))["gates"]);
  EXPECT_EQ(status["frame"]["newest"], lines("r.jsonl").end()[-2]["newest"]) << "it stays";
  for (const char* key : {"answers", "match", "probability"}) {
    EXPECT_FALSE(status["frame"].contains(key)) << key << " is not of this frame, but of an answer";
  }
}

TEST_F(Serve, IsWellAfterAPause) {
  start("--source q.npy --pace live --fps 40 --budget-total 10000");
  ASSERT_TRUE(until([](const Json& status) { return status["counts"]["frames"] > 5; }));
  ASSERT_TRUE(post("/api/control", {{"do", "pause"}}).starts_with("HTTP/1.1 200"));
  std::this_thread::sleep_for(11s);  // longer than it bears no frame
  ASSERT_TRUE(post("/api/control", {{"do", "resume"}}).starts_with("HTTP/1.1 200"));
  for (int n = 0; n < 20; ++n) EXPECT_TRUE(get("/healthz").ends_with("\r\n\r\nok\n")) << n;
  EXPECT_TRUE(post("/api/control", {{"do", "stop"}}).starts_with("HTTP/1.1 200"));
  EXPECT_EQ(ended(), "0\n") << test::read_all(file("err.txt"));
}

TEST_F(Serve, NamesBothPlacesThatLookAlike) {
  start(
      "--source q.npy --paper --method seqcnnslam --ds 10 --pace live --fps 60 --budget-total "
      "10000");
  http::test::Client page(port_);  // what is shown is chosen while somebody looks
  page.send("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  // From the third lap on, each place has been seen twice.
  Json status;
  ASSERT_TRUE(until([&](const Json& now) {
    status = now;
    const Json& shown = now["shown"];
    return !shown["runner_up"].is_null() && shown["frame"] > 320;
  }));
  const Json& shown = status["shown"];
  const auto apart = shown["place"].get<int>() - shown["runner_up"].get<int>();
  EXPECT_NE(apart, 0);
  EXPECT_EQ(json(get("/api/pictures?frame=4&place=2&runner_up=1")),
            Json::parse(R"({"frame": [], "place": [], "runner_up": []})"));
  EXPECT_TRUE(post("/api/control", {{"do", "stop"}}).starts_with("HTTP/1.1 200"));
  EXPECT_EQ(ended(), "0\n") << test::read_all(file("err.txt"));
  std::size_t named = 0;
  bool dropped = false;
  for (const Json& line : lines("r.jsonl")) {
    dropped = dropped || line["dropped"] > 0;
    for (const Json& answer : line["answers"]) {
      named += answer.contains("runner_up");
      EXPECT_TRUE(!answer.contains("runner_up") || answer["status"] == "not_unique") << answer;
    }
  }
  EXPECT_GT(named, 0U);
  // A machine that is too busy to keep up makes shorter laps.
  EXPECT_TRUE(dropped || apart % 150 == 0) << shown;
}

TEST_F(Serve, AMapThatLastsIsSavedWhenAskedAndKeepsWhatAPersonSaid) {
  ASSERT_EQ(run("match --query q.npy --map m.seqloop --session monday --out m.csv").exit_code, 0);
  start(
      "--source q.npy --pace live --fps 60 --map m.seqloop --session tuesday --save-every-s 3600");
  ASSERT_TRUE(until([](const Json& status) { return status["loops"]["listed"] > 1; }));
  Json status = json(get("/api/status"));
  ASSERT_EQ(status["run"]["sessions"].size(), 2U);
  EXPECT_EQ(status["run"]["sessions"][0], Json::parse(R"({"name": "monday", "first": 0})"));
  EXPECT_EQ(status["run"]["sessions"][1], Json::parse(R"({"name": "tuesday", "first": 600})"));
  EXPECT_EQ(status["map"]["saved"], 0);
  ASSERT_TRUE(post("/api/control", {{"do", "save"}}).starts_with("HTTP/1.1 200"));
  EXPECT_TRUE(until([](const Json& now) { return now["map"]["saved"] > 20; }));
  for (const char* word : {"accepted", "rejected"}) {
    ASSERT_TRUE(post("/api/verdict", {{"loop", 0}, {"verdict", word}}).starts_with("HTTP/1.1 200"));
  }
  ASSERT_TRUE(
      post("/api/verdict", {{"loop", 1}, {"verdict", "accepted"}}).starts_with("HTTP/1.1 200"));
  const Json loops = json(get("/api/loops?first=0&count=2"))["loops"];
  EXPECT_TRUE(post("/api/control", {{"do", "stop"}}).starts_with("HTTP/1.1 200"));
  EXPECT_EQ(ended(), "0\n") << test::read_all(file("err.txt"));
  ASSERT_EQ(run("map check m.seqloop").exit_code, 0);
  ASSERT_EQ(run("map export m.seqloop --out out").exit_code, 0);
  const std::string links = test::read_all(file("out/links.csv"));
  std::size_t at = 0;
  for (const auto& [loop, word] : {std::pair{0U, 2}, std::pair{0U, -1}, std::pair{1U, 2}}) {
    const std::string line = "2," + loops[loop]["frame"].dump() + ",1,0," +
                             loops[loop]["match"].dump() + "," + std::to_string(word) + "\n";
    at = links.find(line, at);
    EXPECT_NE(at, std::string::npos) << line << links;
  }
}

TEST_F(Serve, AnswersAreTheSameWhoeverLooks) {
  ASSERT_EQ(run("run --source q.npy --exclude 20 --out alone.jsonl").exit_code, 0);
  start("--source q.npy");
  std::vector<std::unique_ptr<http::test::Client>> clients;
  for (int n = 0; n < 10; ++n) {
    clients.push_back(std::make_unique<http::test::Client>(port_));
    clients.back()->send(n % 3 == 0   ? "GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n"
                         : n % 3 == 1 ? "GET /api/history HTTP/1.1\r\nHost: localhost\r\n\r\n"
                                      : "rubbish\r\n\r\n");
  }
  EXPECT_EQ(ended(), "0\n") << test::read_all(file("err.txt"));
  EXPECT_EQ(lines("r.jsonl"), lines("alone.jsonl"));
}

TEST_F(Serve, ShowsPlacesOfEarlierSessions) {
  if (SEQLOOP_MAPS == 0) GTEST_SKIP() << "this build keeps no maps in files";
  test::write_pictures(folder_, "drive", 40);
  ASSERT_EQ(run("run --source drive --map m.seqloop --out first.jsonl").exit_code, 0);
  start("--source drive --map m.seqloop --pace live --fps 20 --budget-total 10000");
  const std::string picture = get("/api/picture?of=place&number=7");
  EXPECT_TRUE(picture.starts_with("HTTP/1.1 200")) << picture.substr(0, 300);
  EXPECT_NE(picture.find("\r\n\r\n\xFF\xD8"), std::string::npos) << "JPEG";
  EXPECT_EQ(json(get("/api/pictures?place=7"))["place"], Json({6, 7, 8}));
  EXPECT_TRUE(get("/api/picture?of=place&number=9999").starts_with("HTTP/1.1 404"));
  ASSERT_TRUE(until([](const Json& status) { return status["counts"]["frames"] > 5; }));
  EXPECT_TRUE(get("/api/picture?of=frame&number=0").starts_with("HTTP/1.1 200"))
      << "the drive's own";
  EXPECT_EQ(ended(), "0\n") << test::read_all(file("err.txt"));
  EXPECT_EQ(run("map check m.seqloop").exit_code, 0) << "who looks damages nothing";
}

TEST_F(Serve, TellsWhatIsWrongBeforeAnyWork) {
  const auto refused = [&](const std::string& flags, const char* part) {
    const test::Outcome outcome = run("run --source q.npy --out x.jsonl " + flags);
    EXPECT_EQ(outcome.exit_code, 2) << flags;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_FALSE(exists("x.jsonl"));
  };
  refused("--serve robot:80", "no IP address");
  refused("--serve 192.0.2.1:8321", "cannot be listened on");
  refused("--serve 127.0.0.1:0 --serve-token gone", "gone cannot be read");
  folder_.write("short", "abc\n");
  refused("--serve 127.0.0.1:0 --serve-token short", "holds no token");
  refused("--serve 127.0.0.1:0 --serve-token /dev/zero", "holds no token");
  refused("--serve-token token", "nothing is served");
  refused("--serve robot:80 --serve-token gone --map none/m.seqloop", "no IP address");
  refused("--serve robot:80 --serve-token gone --map none/m.seqloop", "gone cannot be read");
  refused("--serve robot:80 --serve-token gone --map none/m.seqloop", "its folder does not exist");
}

}  // namespace
}  // namespace seqloop
