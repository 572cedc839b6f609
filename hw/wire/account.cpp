#include "hw/wire/account.h"

#include <cstddef>
#include <iterator>
#include <stdexcept>

namespace wobblebench::hw {
namespace {

constexpr std::size_t kRememberedGaps = 1024;

}  // namespace

const char* to_string(LossCause cause) {
  switch (cause) {
    case LossCause::ring_full:
      return "ring_full";
    case LossCause::link:
      return "link";
    case LossCause::corrupt:
      return "corrupt";
    case LossCause::out_of_order:
      return "out_of_order";
  }
  return "unknown";
}

std::uint64_t& SequenceLedger::counter(LossCause cause) {
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

std::optional<Gap> SequenceLedger::advance_to(std::uint64_t sequence, bool after_damage) {
  if (!next_) next_ = sequence;
  if (sequence <= *next_) return {};
  const Gap gap{*next_, sequence - *next_, after_damage ? LossCause::corrupt : LossCause::link};
  account_.emitted += gap.count;
  counter(gap.cause) += gap.count;
  next_ = sequence;
  missed_[gap.first_sequence] = {gap.count, gap.cause};
  forget_old_gaps();
  return gap;
}

bool SequenceLedger::expects(std::uint64_t sequence) {
  if (next_ == sequence) return true;
  if (!reclassify_missed(sequence)) ++account_.duplicates;
  return false;
}

bool SequenceLedger::reclassify_missed(std::uint64_t sequence) {
  auto after = missed_.upper_bound(sequence);
  if (after == missed_.begin()) return false;
  const auto [first, missed] = *std::prev(after);
  const std::uint64_t offset = sequence - first;
  if (offset >= missed.count) return false;
  missed_.erase(first);
  if (offset > 0) missed_[first] = {offset, missed.cause};
  if (offset + 1 < missed.count) missed_[sequence + 1] = {missed.count - offset - 1, missed.cause};
  forget_old_gaps();
  --counter(missed.cause);
  ++account_.lost.out_of_order;
  return true;
}

void SequenceLedger::forget_old_gaps() {
  while (missed_.size() > kRememberedGaps) missed_.erase(missed_.begin());
}

void SequenceLedger::deliver() {
  ++account_.emitted;
  ++account_.delivered;
  ++next_.value();
}

Gap SequenceLedger::lose(LossCause cause) {
  ++account_.emitted;
  ++counter(cause);
  return {next_.value()++, 1, cause};
}

void SequenceLedger::restart() {
  next_.reset();
  missed_.clear();
}

}  // namespace wobblebench::hw
