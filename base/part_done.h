// How a long computation tells its caller how far it is.
#pragma once

#include <cstddef>
#include <functional>

namespace wobblebench {

/// Called after each part with the number of parts that are finished, and of all of them. Empty:
/// nothing is called. Parts take about the same time each; from several threads at once only where
/// the computation says so.
using PartDone = std::function<void(std::size_t done, std::size_t all)>;

/// Counts the parts of a computation, which must be as many as announced.
class PartCount {
 public:
  PartCount(std::size_t all, const PartDone& told) : all_(all), told_(told) {}
  void finish_one() {
    ++done_;
    if (told_) told_(done_, all_);
  }

 private:
  std::size_t done_ = 0;
  std::size_t all_;
  const PartDone& told_;
};

}  // namespace wobblebench
