// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiment/report/result.hpp"

namespace seqloop::experiment {

using Chosen = std::vector<const Result*>;
using Names = std::vector<std::string>;  ///< of settings, or `pair`, `method`, `descriptor`
using Key = std::vector<std::string>;    ///< the values under such names

/// The results that every filter lets through, in their order. They have to outlive the choice.
[[nodiscard]] Chosen choose(const std::vector<Result>& results, const std::vector<Filter>& where);

/// `nothing to show: no result has method A or B`, for a choice that is empty.
[[nodiscard]] std::string nothing_to_show(const std::vector<Filter>& where);

/// Every setting that any of the results has, in the order in which they appear.
[[nodiscard]] Names setting_names(const Chosen& results);

[[nodiscard]] Key key_of(const Result& result, const Names& names);

[[nodiscard]] std::map<Key, Chosen> grouped(const Chosen& results, const Names& names);

/// The different keys, sorted name by name: numbers by size, words as they appear first.
[[nodiscard]] std::vector<Key> keys_of(const Chosen& results, const Names& names);

/// Settings, `method` or `descriptor` in which results differ that have the same key.
[[nodiscard]] Names unnamed_differences(const Chosen& results, const Names& names);

/// A key in words: `SeqCNNSLAM pool5 ds 40`; a setting without a value is left out.
[[nodiscard]] std::string in_words(const Names& names, const Key& key);

}  // namespace seqloop::experiment
