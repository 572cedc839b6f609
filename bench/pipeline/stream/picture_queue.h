// Pictures between the thread that renders and the one that writes them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "bench/pipeline/stream/shown_picture.h"
#include "bench/pipeline/stream/stream_queues.h"

namespace wobblebench::bench {

/// Holds one picture. With `every` push() waits until it is taken; with `newest` a later picture
/// replaces it. For one thread that pushes and one that pops.
class PictureQueue {
 public:
  explicit PictureQueue(StreamPolicy policy) : policy_(policy) {}

  /// Returns the picture that will not be taken: the one that was replaced, if one was, or, once
  /// the queue is closed, `picture`.
  std::optional<ShownPicture> push(ShownPicture picture);
  /// No more pictures will come; the one here can still be popped.
  void close();
  /// The next picture, waiting for it. None: closed and empty.
  std::optional<ShownPicture> pop();

 private:
  const StreamPolicy policy_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<ShownPicture> waiting_;
  bool closed_ = false;
};

}  // namespace wobblebench::bench
