// SPDX-License-Identifier: MIT
#include "bags/bag_folder.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::bags {
namespace {

namespace fs = std::filesystem;

bool is_part(const fs::path& file) {
  return file.extension() == ".mcap" || file.extension() == ".db3";
}

std::string trimmed(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t\r'\"");
  if (start == std::string_view::npos) return {};
  return std::string(text.substr(start, text.find_last_not_of(" \t\r'\"") - start + 1));
}

/// rosbag2 numbers its files: drive_2 comes before drive_10.
bool in_order(const std::string& a, const std::string& b) {
  const auto digits_at = [](const std::string& text, std::size_t place) {
    const std::size_t end = text.find_first_not_of("0123456789", place);
    return text.substr(place, std::min(end, text.size()) - place);
  };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0;
  std::size_t k = 0;
  while (i < a.size() && k < b.size()) {
    if (is_digit(a[i]) && is_digit(b[k])) {
      const std::string one = digits_at(a, i);
      const std::string other = digits_at(b, k);
      if (one != other) return one.size() != other.size() ? one.size() < other.size() : one < other;
      i += one.size();
      k += other.size();
    } else if (a[i] != b[k]) {
      return a[i] < b[k];
    } else {
      ++i;
      ++k;
    }
  }
  return a.size() - i < b.size() - k;
}

std::vector<std::string> parts_of(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (is_part(entry->path())) names.push_back(entry->path().filename().string());
  std::ranges::sort(names, in_order);
  return names;
}

/// One file after the other; only one is open at a time while messages are read.
class BagFolder : public Bag {
 public:
  BagFolder(const fs::path& folder, const std::vector<std::string>& names,
            std::vector<std::string> notes)
      : notes_(std::move(notes)) {
    std::map<std::string, Topic> topics;
    facts_.start_ns = std::numeric_limits<std::int64_t>::max();
    for (const std::string& name : names) {
      files_.push_back(folder / name);
      const std::unique_ptr<Bag> bag = open_bag(files_.back());
      const BagFacts& facts = bag->facts();
      add_notes(name, *bag);
      std::uint64_t messages = 0;
      for (const Topic& topic : facts.topics) {
        messages += topic.messages;
        auto [found, is_new] = topics.try_emplace(topic.name, topic);
        if (!is_new) found->second.messages += topic.messages;
      }
      facts_.format = facts.format;
      if (messages == 0) continue;
      facts_.start_ns = std::min(facts_.start_ns, facts.start_ns);
      facts_.end_ns = std::max(facts_.end_ns, facts.end_ns);
    }
    facts_.start_ns = std::min(facts_.start_ns, facts_.end_ns);
    facts_.format += ", " + std::to_string(names.size()) + (names.size() == 1 ? " file" : " files");
    for (auto& [name, topic] : topics) facts_.topics.push_back(std::move(topic));
  }

  [[nodiscard]] const BagFacts& facts() const noexcept override { return facts_; }

  void choose(std::string_view topic) override {
    topic_ = topic;
    open_ = nullptr;
    next_ = 0;
  }

  [[nodiscard]] Read next(Message& message) override {
    while (true) {
      if (!open_ && !open_next(message)) return message.fault.empty() ? Read::end : Read::damaged;
      const Read read = open_->next(message);
      if (read != Read::end) return read;
      open_ = nullptr;
    }
  }

  [[nodiscard]] std::vector<std::string> notes() const override { return notes_; }

 private:
  /// @param message its fault is set where a file cannot be opened any more
  bool open_next(Message& message) {
    message = {};
    if (next_ == files_.size()) return false;
    try {
      auto bag = open_bag(files_[next_++]);
      bag->choose(topic_);
      open_ = std::move(bag);
    } catch (const SetupError& error) {
      fault_ = error.what();
      message.fault = fault_;
      return false;
    }
    return true;
  }

  void add_notes(const std::string& name, const Bag& bag) {
    for (std::string note : bag.notes()) notes_.push_back(note.insert(0, name + ": "));
  }

  BagFacts facts_;
  std::vector<fs::path> files_;
  std::vector<std::string> notes_;
  std::string topic_;
  std::unique_ptr<Bag> open_;
  std::size_t next_ = 0;
  std::string fault_;
};

}  // namespace

BagMetadata parse_metadata(const std::string& yaml) {
  BagMetadata metadata;
  std::istringstream lines(yaml);
  bool in_files = false;
  for (std::string line; std::getline(lines, line);) {
    const std::string text = trimmed(line);
    if (in_files && text.starts_with("- ")) {
      // Old bags put the folder's name in front.
      metadata.files.push_back(fs::path(trimmed(text.substr(2))).filename().string());
      continue;
    }
    in_files = text == "relative_file_paths:";
    constexpr std::string_view key = "compression_format:";
    if (text.starts_with(key)) metadata.compression = trimmed(text.substr(key.size()));
  }
  return metadata;
}

bool holds_bag(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder, error) && !parts_of(folder).empty();
}

std::unique_ptr<Bag> open_bag_folder(const fs::path& folder) {
  std::vector<std::string> notes;
  std::ifstream file(folder / "metadata.yaml", std::ios::binary);
  const BagMetadata metadata =
      parse_metadata({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
  if (!metadata.compression.empty())
    throw SetupError(Fault{folder.string(),
                           "its messages are compressed by rosbag2 (" + metadata.compression + ")",
                           "write it anew without compression_mode: ros2 bag convert"});
  std::vector<std::string> names = metadata.files;
  if (names.empty()) {
    names = parts_of(folder);
    notes.emplace_back(
        "no list of files in metadata.yaml: they are read in the order of their names");
  }
  for (const std::string& name : names)
    if (!is_part(name))
      throw SetupError(Fault{(folder / name).string(), "is neither .mcap nor .db3",
                             "if it is compressed as a whole, unpack it first (zstd -d)"});
  return std::make_unique<BagFolder>(folder, names, std::move(notes));
}

}  // namespace seqloop::bags
