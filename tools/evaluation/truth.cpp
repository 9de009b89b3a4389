#include "evaluation/truth.hpp"

#include <algorithm>

#include "seqloop/fault.hpp"

namespace seqloop::evaluation {

Truth Truth::identity(std::uint64_t frames) {
  Truth truth;
  for (std::uint64_t frame = 0; frame < frames; ++frame) truth.places_[frame] = {frame};
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
  const auto found = places_.find(query);
  if (found == places_.end()) return false;
  return std::ranges::any_of(found->second, [&](std::uint64_t place) {
    return std::max(place, match) - std::min(place, match) <= tolerance;
  });
}

}  // namespace seqloop::evaluation
