#include "bench/pipeline/stream/picture_queue.h"

#include <utility>

namespace wobblebench::bench {

std::optional<ShownPicture> PictureQueue::push(ShownPicture picture) {
  std::unique_lock lock(mutex_);
  if (policy_ == StreamPolicy::every) {
    changed_.wait(lock, [&] { return closed_ || !waiting_; });
  }
  if (closed_) return picture;
  std::optional<ShownPicture> replaced = std::exchange(waiting_, std::move(picture));
  changed_.notify_all();
  return replaced;
}

void PictureQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::optional<ShownPicture> PictureQueue::pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || waiting_; });
  auto picture = std::exchange(waiting_, std::nullopt);
  changed_.notify_all();
  return picture;
}

}  // namespace wobblebench::bench
