// SPDX-License-Identifier: MIT
#include "program/map/map_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "program/map/move_log.hpp"
#include "program/process/interruption.hpp"

namespace seqloop::program {
namespace {

// Places that are saved at once: a batch is in memory twice.
constexpr std::uint64_t most_at_once = 4096;

// Saving that takes longer is told.
constexpr std::int64_t patience_ns = 2'000'000'000;

std::int64_t steady_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::int64_t nanoseconds(double seconds) {
  constexpr double in_a_second = 1e9;
  return static_cast<std::int64_t>(std::llround(seconds * in_a_second));
}

}  // namespace

MapWriter::MapWriter(StoredMap& stored, const PlaceMap& map, const MatcherConfig& config,
                     const MapSettings& settings, JpegEncoder encode, StatisticsReader learnt)
    : stored_(&stored),
      map_(&map),
      learnt_(std::move(learnt)),
      settled_after_(config.patience + (has_keyframes(config) ? Keyframes::most_apart : 1) *
                                           (PlaceMap::most_between + config.sequence_length)),
      first_number_(map.order().next_number()),
      next_number_(first_number_),
      came_(static_cast<std::size_t>(settled_after_) +
            Keyframes::most_held_back(config.sequence_length) + MatcherConfig::most_frames_at_once +
            2),
      source_frames_(map.capacity()),
      numbers_(map.capacity(), none),
      linked_(map.capacity(), none),
      novel_(settings.novel),
      waits_(settings.waits),
      added_(map.capacity()),
      links_(map.capacity()),
      read_places_(learnt_ ? 0 : none),
      read_links_(learnt_ ? 0 : none),
      newest_(map.rows().saved_size()) {
  if (config.standardisation.on) {
    handed_.mean.resize(map.descriptor_size());
    handed_.variance.resize(map.descriptor_size());
  }
  for (std::size_t row = 0; row < map.size(); ++row) {
    numbers_[map.order().slot(row)] = map.order().number(row);
  }
  const auto batch = static_cast<std::size_t>(std::min<std::uint64_t>(most_at_once, added_.size()));
  if (settings.thumbnails && encode != nullptr) thumbnails_.emplace(encode);
  bytes_.reserve(batch * map.rows().saved_size());
  records_.reserve(batch);
  batch_links_.reserve(batch);
  removed_.reserve(batch);
  thread_ = std::thread([this, every_s = settings.save_every_s] { work(every_s); });
}

MapWriter::~MapWriter() { stop(); }

void MapWriter::stop() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void MapWriter::note(Detector& detector, std::uint64_t counted, std::uint64_t index, double time_s,
                     const Image& image, std::span<const Answer> answers, bool readable) noexcept {
  if (readable) readable_.store(true, std::memory_order_relaxed);
  for (; counted_ <= counted; ++counted_) {
    came(counted_) = {index - (counted - counted_), nanoseconds(time_s), 0.0, none};
  }
  weigh(answers);
  add_places(image);
  if (counted_ > settled_after_) settle(counted_ - settled_after_);
  hand_over_statistics(detector);
  if (waits_ && readable_.load(std::memory_order_relaxed)) wait_for_the_disk();
  const std::uint64_t done = std::min(saved_places_.load(std::memory_order_acquire),
                                      read_places_.load(std::memory_order_acquire));
  const std::uint64_t needed = places_noted_.load(std::memory_order_relaxed) - done;
  detector.keep_newest(static_cast<std::size_t>(std::max(needed, kept())));
  frames_.store(counted_, std::memory_order_release);
}

std::uint64_t MapWriter::kept() const noexcept {
  return std::clamp<std::uint64_t>(map_->capacity() / 8, 1, 1024);
}

/// Whether what began to be saved then should long be.
bool MapWriter::stalls(std::int64_t since_ns) noexcept {
  return since_ns != 0 && steady_ns() - since_ns > patience_ns;
}

/// A disk that takes nothing holds nobody up.
void MapWriter::wait_for_the_disk() noexcept {
  const std::uint64_t noted = places_noted_.load(std::memory_order_relaxed);
  while (saved_places() + kept() < noted && !failing_ && !interrupted() &&
         !stalls(saving_since_ns_.load(std::memory_order_relaxed)) && save_now()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Notes where frames were, and how sure that is.
void MapWriter::weigh(std::span<const Answer> answers) noexcept {
  for (const Answer& answer : answers) {
    comes_back_ = comes_back_ || answer.gate == Gate::match;
    if (answer.match && !std::isnan(answer.probability)) {
      came(answer.frame).probability = static_cast<double>(answer.probability);
      came(answer.frame).place = answer.match->place;
    }
  }
}

/// Notes the places that have been added since the last frame: the newest rows of the map.
/// @param image of the newest frame
void MapWriter::add_places(const Image& image) noexcept {
  const PlaceOrder& order = map_->order();
  std::uint64_t noted = places_noted_.load(std::memory_order_relaxed);
  // What came and went between two frames is not noted at all.
  std::size_t row = order.size();
  while (row > 0 && order.number(row - 1) >= next_number_) --row;
  // Several frames may have been taken at once: those to come are noted with the others.
  for (; row < order.size() && order.frame(row) < counted_; ++row) {
    next_number_ = order.number(row) + 1;
    const Came& frame = came(order.frame(row));
    const std::size_t slot = order.slot(row);
    source_frames_[slot] = frame.index;
    linked_[slot] = none;
    added_[static_cast<std::size_t>(noted % added_.size())] = {
        slot,
        {order.number(row), frame.index, frame.time_ns},
        // A place that goes leaves its slot to the one that it goes for.
        std::exchange(numbers_[slot], order.number(row))};
    // Copies for frames that never came have no picture.
    if (thumbnails_ && order.frame(row) + 1 == counted_) thumbnails_->add(image, order.number(row));
    ++noted;
  }
  places_noted_.store(noted, std::memory_order_release);
}

/// Notes what places are linked to, of frames before this one.
void MapWriter::settle(std::uint64_t end) noexcept {
  const PlaceOrder& order = map_->order();
  const std::uint64_t noted = places_noted_.load(std::memory_order_relaxed);
  std::uint64_t links = links_noted_.load(std::memory_order_relaxed);
  const std::uint64_t done = std::min(saved_links_.load(std::memory_order_acquire),
                                      read_links_.load(std::memory_order_acquire));
  for (; settled_ < noted; ++settled_) {
    const Added& added = added_[static_cast<std::size_t>(settled_ % added_.size())];
    const auto row = order.row_of_number(added.record.number);
    if (row && order.frame(*row) >= end) break;
    if (!row || links - done == links_.size()) continue;
    const Came& frame = came(order.frame(*row));
    // Of later drives' use, when all that followed is known: rows that are one place do not
    // compete.
    constexpr double enough_for_later = 0.5;
    const bool likely = frame.probability >= PlaceMap::likely;
    if (likely) last_probability_ = frame.probability;
    // What looks alike in one drive is no visit, as long as it came back to no place for sure.
    const auto alike = [&](std::uint64_t number) {
      return number >= first_number_ && !comes_back_;
    };
    std::uint64_t first = map_->first_visit(*row);
    if (alike(first)) first = added.record.number;
    double probability =
        likely ? frame.probability : std::max(frame.probability, last_probability_);
    if (first == added.record.number) {
      const auto other = order.row_of_number(frame.place);
      if (frame.probability < enough_for_later || !other) continue;
      first = map_->first_visit(*other);
      if (alike(first)) continue;
      probability = frame.probability;
    }
    linked_[added.slot] = first;
    links_[static_cast<std::size_t>(links++ % links_.size())] = {
        0, added.record.frame, added.record.number, first, probability};
  }
  links_noted_.store(links, std::memory_order_release);
}

void MapWriter::hand_over_statistics(const Detector& detector) noexcept {
  if (handed_.mean.empty() || detector.statistics().frames() == 0 ||
      handing_.load(std::memory_order_acquire) != Handing::asked) {
    return;
  }
  handed_.frames = detector.statistics().frames();
  std::ranges::copy(detector.statistics().mean(), handed_.mean.begin());
  std::ranges::copy(detector.statistics().variance(), handed_.variance.begin());
  handing_.store(Handing::ready, std::memory_order_release);
}

void MapWriter::work(double every_s) {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    // Saving takes its time, too.
    constexpr double share = 0.5;
    wake_.wait_for(lock, std::chrono::duration<double>(share * every_s),
                   [this] { return stop_ || asked_; });
    asked_ = false;
    if (!readable_.load(std::memory_order_relaxed)) continue;
    lock.unlock();
    save();
    lock.lock();
  }
}

bool MapWriter::save_now() {
  const std::scoped_lock lock(mutex_);
  asked_ = !stop_;
  wake_.notify_one();
  return asked_;
}

bool MapWriter::judge(std::uint64_t frame, std::uint64_t place, Verdict verdict) {
  const std::scoped_lock lock(mutex_);
  if (stop_) return false;
  const double said = verdict == Verdict::accepted   ? sqlite::person_accepted
                      : verdict == Verdict::rejected ? sqlite::person_rejected
                                                     : sqlite::person_silent;
  words_.push_back({0, frame, std::nullopt, place, said});
  return true;
}

std::size_t MapWriter::words() {
  const std::scoped_lock lock(mutex_);
  return words_.size();
}

/// Saves all that is noted. @return whether it could
bool MapWriter::save() {
  const std::int64_t since = steady_ns();
  saving_since_ns_.store(since, std::memory_order_relaxed);
  try {
    const std::uint64_t end = frames_.load(std::memory_order_acquire);
    const std::uint64_t places = places_noted_.load(std::memory_order_acquire);
    // One frame may bring more places than a loop that waits for the disk lets be: it is not
    // counted before they are saved.
    while (saved_frames_.load(std::memory_order_relaxed) < end || saved_places() < places ||
           left() || words() > 0) {
      save_once();
    }
    if (ending_) save_once();  // the last statistics
  } catch (const std::exception& error) {
    why_ = error.what();
    if (!failing_.exchange(true)) {
      tell(why_ + ": the run goes on, and what is missing is saved as soon as it can be");
    }
    saving_since_ns_.store(0, std::memory_order_relaxed);
    return false;
  }
  saving_since_ns_.store(0, std::memory_order_relaxed);
  const bool stalled = !ending_ && stalls(since);
  if (failing_.exchange(false) || stalled) tell("what was missing is saved");
  return true;
}

/// Whether there is more to save than places.
bool MapWriter::left() const {
  return saved_links_.load(std::memory_order_relaxed) <
             links_noted_.load(std::memory_order_acquire) ||
         (thumbnails_ && !thumbnails_->waiting(number_after_, 1).empty());
}

void MapWriter::save_once() {
  // The frames first: all places of theirs are noted then.
  std::uint64_t frames = frames_.load(std::memory_order_acquire);
  const std::uint64_t first = saved_places_.load(std::memory_order_relaxed);
  std::uint64_t last = places_noted_.load(std::memory_order_acquire);
  if (last - first > most_at_once) {
    // Not all of their places come along.
    last = first + most_at_once;
    frames = saved_frames_.load(std::memory_order_relaxed);
  }
  const PlaceMap& map = *map_;
  const std::size_t size = map.rows().saved_size();
  records_.clear();
  removed_.clear();
  bytes_.resize(static_cast<std::size_t>(last - first) * size);
  for (std::uint64_t place = first; place < last; ++place) {
    const Added& added = added_[static_cast<std::size_t>(place % added_.size())];
    map.rows().save(added.slot, std::span(bytes_).subspan(records_.size() * size, size));
    records_.push_back(added.record);
    if (added.gone != none) removed_.push_back(added.gone);
  }
  const std::uint64_t first_link = saved_links_.load(std::memory_order_relaxed);
  const std::uint64_t last_link =
      std::min(links_noted_.load(std::memory_order_acquire), first_link + most_at_once);
  batch_links_.clear();
  for (std::uint64_t link = first_link; link < last_link; ++link) {
    const sqlite::SavedLink& noted = links_[static_cast<std::size_t>(link % links_.size())];
    // Its place comes along later.
    if (noted.place && last > first && *noted.place > records_.back().number) break;
    batch_links_.push_back(noted);
  }
  const std::size_t linked = batch_links_.size();
  {
    const std::scoped_lock lock(mutex_);
    batch_links_.insert(batch_links_.end(), words_.begin(), words_.end());
  }
  const std::size_t said = batch_links_.size() - linked;
  std::vector<sqlite::SavedThumbnail> pictures;
  const std::uint64_t number_after = records_.empty() ? number_after_ : records_.back().number + 1;
  if (thumbnails_) pictures = thumbnails_->waiting(number_after, most_at_once);
  const bool ready = handing_.load(std::memory_order_acquire) == Handing::ready;
  sqlite::MapBatch batch;
  batch.frames = frames;
  batch.records = records_;
  batch.places = bytes_;
  batch.links = batch_links_;
  batch.thumbnails = pictures;
  if (ready) batch.statistics = &handed_;
  batch.removed = removed_;
  stored_->file().save(stored_->session(), batch);
  number_after_ = number_after;
  if (thumbnails_) thumbnails_->saved(pictures.size());
  saved_places_.store(last, std::memory_order_release);
  saved_links_.store(first_link + linked, std::memory_order_release);
  {
    const std::scoped_lock lock(mutex_);
    words_.erase(words_.begin(), words_.begin() + static_cast<std::ptrdiff_t>(said));
  }
  saved_frames_.store(frames, std::memory_order_release);
  if (!ready) return;
  if (learnt_) {
    learnt_(stored_->of_this_run().began_ns, {handed_.frames, handed_.mean, handed_.variance});
  }
  handing_.store(Handing::asked, std::memory_order_release);
}

std::uint64_t MapWriter::lacking() const noexcept {
  std::uint64_t lacking = 0;
  const std::uint64_t noted = places_noted_.load(std::memory_order_acquire);
  for (std::uint64_t place = saved_places(); place < noted; ++place) {
    if (added_[static_cast<std::size_t>(place % added_.size())].gone == none) ++lacking;
  }
  return lacking;
}

void MapWriter::read_newest(const SavedPlaceReader& read) {
  // The links first: their places are all noted then.
  const std::uint64_t links = links_noted_.load(std::memory_order_acquire);
  const std::uint64_t places = places_noted_.load(std::memory_order_acquire);
  for (std::uint64_t at = read_places_.load(std::memory_order_relaxed); at < places; ++at) {
    const Added& added = added_[static_cast<std::size_t>(at % added_.size())];
    map_->rows().save(added.slot, newest_);
    SavedPlace place = stored_->of_this_run();
    place.number = added.record.number;
    place.frame = added.record.frame;
    place.time_ns = added.record.time_ns;
    place.bytes = newest_;
    read(place);
  }
  read_places_.store(places, std::memory_order_release);
  for (std::uint64_t at = read_links_.load(std::memory_order_relaxed); at < links; ++at) {
    const sqlite::SavedLink& link = links_[static_cast<std::size_t>(at % links_.size())];
    SavedPlace place = stored_->of_this_run();
    place.number = *link.place;
    place.frame = link.frame;
    place.visits = link.other;
    read(place);
  }
  read_links_.store(links, std::memory_order_release);
}

std::optional<std::string> MapWriter::finish(Detector& detector, std::span<const Answer> rest) {
  stop();
  if (thumbnails_) thumbnails_->finish();
  weigh(rest);
  settle(counted_);
  handing_.store(Handing::asked, std::memory_order_relaxed);
  hand_over_statistics(detector);
  ending_ = true;
  if (!save()) {
    const bool frames_are = saved() >= frames_.load(std::memory_order_relaxed);
    return "not all of the drive is saved: " +
           std::string(frames_are ? "its frames are, and not all that was learnt of them (links, "
                                    "thumbnails, statistics); "
                                  : "") +
           why_;
  }
  if (novel_) retired_ = retire_superseded(*stored_, *map_, linked_, none);
  return move_log_into(stored_->file());
}

void MapWriter::tell(std::string text) {
  const std::scoped_lock lock(mutex_);
  told_ = std::move(text);
  has_told_.store(true, std::memory_order_release);
}

std::optional<std::string> MapWriter::trouble() {
  const std::int64_t since = saving_since_ns_.load(std::memory_order_relaxed);
  if (since != stalled_ns_ && stalls(since)) {
    stalled_ns_ = since;
    return stored_->path().string() +
           ": the disk has not taken it for two seconds: the run goes on, and what is missing is "
           "saved as soon as it can be";
  }
  if (!has_told_.load(std::memory_order_acquire)) return std::nullopt;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return std::nullopt;
  has_told_.store(false, std::memory_order_relaxed);
  return std::exchange(told_, std::nullopt);
}

}  // namespace seqloop::program
