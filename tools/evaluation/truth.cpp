#include "evaluation/truth.hpp"

#include <algorithm>

#include "seqloop/fault.hpp"

namespace seqloop::evaluation {

Truth Truth::identity(std::uint64_t frames) {
  Truth truth;
  truth.identity_frames_ = frames;
  return truth;
}

Truth Truth::from_csv(const CsvTable& table) {
  const std::size_t query = table.column("query");
  const std::size_t reference = table.column("reference");
  Truth truth;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    truth.places_[table.whole(row, query)].push_back(table.whole(row, reference));
  }
  if (truth.places_.empty()) throw SetupError(Fault{"truth", "it has no rows"});
  return truth;
}

bool Truth::right(std::uint64_t query, std::uint64_t match,
                  std::uint64_t tolerance) const noexcept {
  const auto near = [&](std::uint64_t place) {
    return std::max(place, match) - std::min(place, match) <= tolerance;
  };
  if (identity_frames_) return query < *identity_frames_ && near(query);
  const auto found = places_.find(query);
  return found != places_.end() && std::ranges::any_of(found->second, near);
}

}  // namespace seqloop::evaluation
