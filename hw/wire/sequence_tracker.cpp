#include "hw/wire/sequence_tracker.h"

#include <cstddef>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {
namespace {

constexpr std::size_t kRememberedGaps = 1024;

}  // namespace

std::uint64_t& SequenceTracker::counter(LossCause cause) {
  switch (cause) {
    case LossCause::ring_full:
      return account_.lost.ring_full;
    case LossCause::link:
      return account_.lost.link;
    case LossCause::corrupt:
      return account_.lost.corrupt;
    case LossCause::out_of_order:
      return account_.lost.out_of_order;
  }
  throw std::logic_error("unknown cause of loss");
}

std::optional<Gap> SequenceTracker::advance_to(std::uint64_t sequence, bool after_damage) {
  if (!next_) next_ = sequence;
  if (sequence <= *next_) return {};
  const Gap gap{*next_, sequence - *next_, after_damage ? LossCause::corrupt : LossCause::link};
  if (gap.count >= std::numeric_limits<std::uint64_t>::max() - account_.emitted) {
    throw UnreadableStream("its sequence numbers say that 2^64 sticks were emitted");
  }
  account_.emitted += gap.count;
  counter(gap.cause) += gap.count;
  next_ = sequence;
  missing_[gap.first_sequence] = {gap.count, gap.cause};
  forget_old_gaps();
  return gap;
}

bool SequenceTracker::expects(std::uint64_t sequence) {
  if (next_ == sequence) return true;
  if (!reclassify_missing(sequence)) ++account_.duplicates;
  return false;
}

bool SequenceTracker::reclassify_missing(std::uint64_t sequence) {
  auto after = missing_.upper_bound(sequence);
  if (after == missing_.begin()) return false;
  const auto [first, missing] = *std::prev(after);
  const std::uint64_t offset = sequence - first;
  if (offset >= missing.count) return false;
  missing_.erase(first);
  if (offset > 0) missing_[first] = {offset, missing.cause};
  if (offset + 1 < missing.count)
    missing_[sequence + 1] = {missing.count - offset - 1, missing.cause};
  forget_old_gaps();
  --counter(missing.cause);
  ++account_.lost.out_of_order;
  return true;
}

void SequenceTracker::forget_old_gaps() {
  while (missing_.size() > kRememberedGaps) missing_.erase(missing_.begin());
}

void SequenceTracker::deliver() {
  ++account_.emitted;
  ++account_.delivered;
  ++next_.value();
}

Gap SequenceTracker::lose(LossCause cause) {
  ++account_.emitted;
  ++counter(cause);
  return {next_.value()++, 1, cause};
}

void SequenceTracker::restart() {
  next_.reset();
  missing_.clear();
}

}  // namespace wobblebench::hw
