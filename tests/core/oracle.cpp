// SPDX-License-Identifier: MIT
#include "core/oracle.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "seqloop/detail/fixed_distance.hpp"
#include "seqloop/detail/quantised.hpp"

namespace seqloop::oracle {
namespace {

using Int = std::int64_t;
constexpr double none = std::numeric_limits<double>::infinity();

double distance(Difference kind, const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  if (kind == Difference::mean_absolute) {
    for (std::size_t d = 0; d < a.size(); ++d) {
      sum += std::abs(static_cast<double>(a[d]) - static_cast<double>(b[d]));
    }
    return sum / static_cast<double>(a.size());
  }
  for (std::size_t d = 0; d < a.size(); ++d) {
    const double difference = static_cast<double>(a[d]) - static_cast<double>(b[d]);
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

std::vector<Forms> forms(const Vectors& descriptors) {
  return {descriptors.begin(), descriptors.end()};
}

struct Scored {
  double score = none;
  const Line* line = nullptr;
};

class Matcher {
 public:
  Matcher(const Vectors& reference, const Vectors& query, const MatcherConfig& config)
      : closing_(reference.empty()),
        r_(forms(closing_ ? query : reference)),
        q_(forms(query)),
        config_(config),
        ds_(static_cast<Int>(config.sequence_length)),
        h_(ds_ / 2),
        scale_(1.0 / (unit(config) * static_cast<double>(ds_ + 1))),
        k_(static_cast<Int>(config.candidates == Candidates::ranges     ? config.k
                            : config.candidates == Candidates::adaptive ? config.initial_k
                                                                        : 0)) {
    for (const Forms& row : r_) {
      d_.emplace_back();
      for (const Forms& column : q_) d_.back().push_back(difference(config, row, column));
    }
    if (config.enhance) enhance();
  }

  std::vector<Answer> run() {
    std::vector<Answer> answers;
    const auto frames = static_cast<Int>(q_.size());
    for (Int n = h_; n - h_ + ds_ < frames; ++n) {
      if (const auto answer = at(n)) answers.push_back(*answer);
    }
    return answers;
  }

 private:
  /// Contrast enhancement of the whole matrix, column by column.
  void enhance() {
    const auto half = static_cast<Int>(config_.rwindow / 2);
    const auto rows = static_cast<Int>(r_.size());
    const auto n = static_cast<double>(2 * half + 1);
    const std::vector<std::vector<double>> plain = d_;
    for (std::size_t column = 0; column < q_.size(); ++column) {
      for (Int row = 0; row < rows; ++row) {
        std::vector<double> around;
        for (Int r = std::max<Int>(0, row - half); r <= std::min(rows - 1, row + half); ++r) {
          around.push_back(plain[static_cast<std::size_t>(r)][column]);
        }
        const auto count = static_cast<double>(around.size());
        double mean = 0.0;
        for (const double value : around) mean += value / count;
        double variance = 0.0;
        for (const double value : around) variance += (value - mean) * (value - mean);
        double& cell = d_[static_cast<std::size_t>(row)][column];
        const double deviation = count > 1.0 ? std::sqrt(variance / (count - 1.0)) : 0.0;
        // Below this it is this function's own rounding.
        cell = (deviation > 1e-12 ? (cell - mean) / deviation : 0.0) + (n - 1.0) / std::sqrt(n);
      }
    }
  }

  Scored score(Int n, Int q, Int rows) const {
    Scored best;
    for (const Line& line : lines_) {
      double sum = 0.0;
      for (Int i = 0; i <= ds_; ++i) {
        const Int row = q + line.rows[static_cast<std::size_t>(i)];
        if (row < 0 || row >= rows) {
          sum = none;
          break;
        }
        sum += d_[static_cast<std::size_t>(row)][static_cast<std::size_t>(n - h_ + i)];
      }
      const double mean = sum * scale_;
      if (mean < best.score) best = {mean, &line};
    }
    return best;
  }

  double change_degree(Int n) const {
    if (n < 11) return 1.0;
    const auto q = [&](Int i) -> const Forms& { return q_[static_cast<std::size_t>(i)]; };
    double above = 0.0;
    double below = 0.0;
    for (Int i = n - 10; i <= n - 1; ++i) {
      above += difference(config_, q(n), q(i)) / unit(config_);
      below += difference(config_, q(n - 1), q(i - 1)) / unit(config_);
    }
    if (below == 0.0) return above == 0.0 ? 1.0 : none;
    return above / below;
  }

  std::optional<Answer> at(Int n) {
    const Int rows = closing_ ? std::max<Int>(0, n - static_cast<Int>(config_.exclude))
                              : static_cast<Int>(r_.size());
    const bool all = config_.candidates == Candidates::all;
    const bool full = all || t_.empty() || matched_ % static_cast<Int>(config_.reinit) == 0;
    const Int half = static_cast<Int>(config_.num) / 2;

    std::set<Int> candidates;
    if (full) {
      for (Int q = 0; q < rows; ++q) candidates.insert(q);
    } else {
      for (Int k = 0; k < k_ && k < static_cast<Int>(t_.size()); ++k) {
        const Int centre = t_[static_cast<std::size_t>(k)];
        for (Int q = centre - half; q <= centre + half; ++q) {
          if (q >= 0 && q < rows) candidates.insert(q);
        }
      }
    }

    std::map<Int, Scored> scored;
    for (const Int q : candidates) {
      const Scored row = score(n, q, rows);
      if (row.score < none) scored[q] = row;
    }
    if (scored.empty()) {
      t_.clear();
      return std::nullopt;
    }
    std::vector<Int> sorted;
    for (const auto& [q, row] : scored) sorted.push_back(q);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](Int a, Int b) { return scored[a].score < scored[b].score; });
    const Int best = sorted.front();

    double runner_up = none;
    std::optional<Int> elsewhere;
    for (const auto& [q, row] : scored) {
      if (2 * std::abs(q - best) > static_cast<Int>(config_.rwindow)) {
        if (row.score < runner_up) elsewhere = q;
        runner_up = std::min(runner_up, row.score);
      }
    }
    if (runner_up == none) runner_up = last_full_runner_up_;
    if (full) last_full_runner_up_ = runner_up;

    const auto [score, line] = scored[best];
    const Answer answer{n,
                        best,
                        score,
                        runner_up == none ? std::nan("") : score / runner_up,
                        static_cast<double>(line->m) / static_cast<double>(ds_),
                        best + line->rows.back(),
                        static_cast<Int>(scored.size()),
                        k_,
                        elsewhere};

    if (config_.candidates == Candidates::adaptive && !full) {
      const double cd = change_degree(n);
      if (cd >= 0.9 && cd <= 1.1) {
        Int iml = 1;
        while (std::abs(best - t_[static_cast<std::size_t>(iml - 1)]) > half) ++iml;
        record_.push_back(iml);
        if (record_.size() == 10) {
          k_ = *std::max_element(record_.begin(), record_.end());
          record_.clear();
        }
      } else {
        k_ = static_cast<Int>(config_.initial_k);
        record_.clear();
      }
    }
    t_ = sorted;
    ++matched_;
    return answer;
  }

  bool closing_;
  std::vector<Forms> r_;
  std::vector<Forms> q_;
  const MatcherConfig& config_;
  std::vector<Line> lines_ = lines(config_);
  Int ds_;
  Int h_;
  double scale_;
  Int k_;
  Int matched_ = 0;
  double last_full_runner_up_ = none;
  std::vector<Int> t_;
  std::vector<Int> record_;
  std::vector<std::vector<double>> d_;
};

}  // namespace

Forms::Forms(std::vector<float> descriptor)
    : values(std::move(descriptor)), bytes(values.size()), sketch{} {
  inverse_length = seqloop::inverse_length(quantise(values, bytes).squared_norm);
  std::vector<SketchedValue> chosen(sketched_values(sketch.size()));
  choose_sketched_values(bytes.size(), chosen);
  std::vector<std::uint8_t> both(2 * bytes.size());
  with_negative(bytes, both);
  seqloop::sketch(both, chosen, sketch);
}

double difference(const MatcherConfig& config, const Forms& a, const Forms& b) {
  switch (config.arithmetic) {
    case Arithmetic::float32:
      return distance(config.difference, a.values, b.values);
    case Arithmetic::int8: {
      std::int32_t dot = 0;
      for (std::size_t d = 0; d < a.bytes.size(); ++d) dot += a.bytes[d] * b.bytes[d];
      return fixed_distance(dot, a.inverse_length, b.inverse_length);
    }
    case Arithmetic::sketch: {
      std::size_t bits = 0;
      for (std::size_t word = 0; word < sketch_words; ++word) {
        bits += std::bitset<64>(a.sketch[word] ^ b.sketch[word]).count();
      }
      return static_cast<double>(bits);
    }
  }
  return none;
}

double unit(const MatcherConfig& config) {
  switch (config.arithmetic) {
    case Arithmetic::float32:
      return 1.0;
    case Arithmetic::int8:
      return 32'767.0;
    case Arithmetic::sketch:
      return 1'024.0;
  }
  return 0.0;
}

std::vector<Line> lines(const MatcherConfig& config) {
  const auto ds = static_cast<Int>(config.sequence_length);
  std::vector<Line> lines;
  for (Int m = 0; m <= 20 * ds; ++m) {
    const auto v = static_cast<double>(m);
    const auto length = static_cast<double>(ds);
    if (v < config.vmin * length - 1e-9 || v > config.vmax * length + 1e-9) continue;
    lines.push_back({m, {0}});
    if (ds == 0) continue;
    lines.back().rows.clear();
    for (Int i = 0; i <= ds; ++i) {
      lines.back().rows.push_back(static_cast<Int>(std::floor(
          static_cast<long double>(2 * m * (i - ds / 2) + ds) / static_cast<long double>(2 * ds))));
    }
  }
  return lines;
}

std::vector<Answer> match(const Vectors& reference, const Vectors& query,
                          const MatcherConfig& config) {
  return Matcher(reference, query, config).run();
}

Vectors drive(std::uint32_t seed, std::size_t frames, std::size_t size, float noise) {
  // The walk of one seed is the same whatever the noise: two drives of it pass the same places.
  std::mt19937 walk(seed);
  std::mt19937 blur(seed + 1000003U + static_cast<std::uint32_t>(noise * 1000.0F));
  std::normal_distribution<float> normal;
  Vectors drive;
  std::vector<float> place(size, 0.0F);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    for (float& value : place) value = 0.8F * value + normal(walk);
    std::vector<float> seen = place;
    for (float& value : seen) value += noise * normal(blur);
    double squares = 0.0;
    for (const float value : seen)
      squares += static_cast<double>(value) * static_cast<double>(value);
    for (float& value : seen)
      value = static_cast<float>(static_cast<double>(value) / std::sqrt(squares));
    drive.push_back(seen);
  }
  return drive;
}

}  // namespace seqloop::oracle
