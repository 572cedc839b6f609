// The figures that are counted: what became of the sticks, and the work on them.
#pragma once

#include "bench/results/measure.h"
#include "hw/wire/account.h"

namespace wobblebench::bench {

namespace counts {

inline constexpr Measure kEmitted{
    "emitted", "emitted", "Sticks that the probe sent", Worse::neither};
inline constexpr Measure kDelivered{
    "delivered", "delivered", "Sticks that the program got", Worse::lower};
inline constexpr Measure kLostRingFull{
    "lost_ring_full", "lost: ring_full", "Sticks for which the ring had no slot"};
inline constexpr Measure kLostLink{"lost_link", "lost: link", "Sticks that never came"};
inline constexpr Measure kLostCorrupt{
    "lost_corrupt", "lost: corrupt", "Sticks damaged on their way"};
inline constexpr Measure kLostOutOfOrder{
    "lost_out_of_order", "lost: out_of_order", "Sticks that came after later ones"};
inline constexpr Measure kLostPercent{"lost_percent", "lost", "Of the sticks sent: lost"};
inline constexpr Measure kDuplicates{
    "duplicates", "duplicates", "Copies of sticks that are counted", Worse::neither};

inline constexpr Measure kSticks{
    "sticks", "sticks", "Sticks; of a run those of the volume that came"};
inline constexpr Measure kVolumes{"volumes", "volumes", "Volumes"};
inline constexpr Measure kSamples{"samples", "samples", "Samples of these"};
inline constexpr Measure kFetches{
    "fetches", "texture fetches", "Of all passes of a picture, with --count-work"};

// Of a stream what came and was not shown, and its queues.
inline constexpr Measure kLeft{"left_at_the_end_sticks",
                               "left at the end",
                               "Sticks of a volume that was not whole yet",
                               Worse::neither};
inline constexpr Measure kNotTaken{
    "not_taken_sticks", "not taken", "Sticks that stayed in the ring", Worse::neither};
inline constexpr Measure kLeastFreeSlots{
    "least_free_slots", "ring", "Slots of the ring that were free at least", Worse::lower};
inline constexpr Measure kMostVolumes{
    "most_volumes", "volumes waiting, most", "Volumes that waited at once"};
inline constexpr Measure kMeanVolumes{
    "mean_volumes", "volumes waiting, mean", "The same, mean over time"};
inline constexpr Measure kReaderBlocked{
    "reader_blocked_ms", "reader blocked", "The board waited so long for the renderer"};

inline constexpr const Measure* kAll[] = {&kEmitted,
                                          &kDelivered,
                                          &kLostRingFull,
                                          &kLostLink,
                                          &kLostCorrupt,
                                          &kLostOutOfOrder,
                                          &kLostPercent,
                                          &kDuplicates,
                                          &kSticks,
                                          &kVolumes,
                                          &kLeft,
                                          &kNotTaken,
                                          &kLeastFreeSlots,
                                          &kMostVolumes,
                                          &kMeanVolumes,
                                          &kReaderBlocked,
                                          &kSamples,
                                          &kFetches};

}  // namespace counts

inline void describe(const hw::BoardAccount& account, Measurements& to) {
  to.add(counts::kEmitted, account.emitted);
  to.add(counts::kDelivered, account.delivered);
  to.add(counts::kLostRingFull, account.lost.ring_full);
  to.add(counts::kLostLink, account.lost.link);
  to.add(counts::kLostCorrupt, account.lost.corrupt);
  to.add(counts::kLostOutOfOrder, account.lost.out_of_order);
  to.add(counts::kDuplicates, account.duplicates);
}

/// Of several boards.
inline void add_account(const hw::BoardAccount& account, hw::BoardAccount& sum) {
  sum.emitted += account.emitted;
  sum.delivered += account.delivered;
  sum.lost.ring_full += account.lost.ring_full;
  sum.lost.link += account.lost.link;
  sum.lost.corrupt += account.lost.corrupt;
  sum.lost.out_of_order += account.lost.out_of_order;
  sum.duplicates += account.duplicates;
}

}  // namespace wobblebench::bench
