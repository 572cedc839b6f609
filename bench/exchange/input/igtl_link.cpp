#include "bench/exchange/input/igtl_link.h"

#include <sys/eventfd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/number_text.h"
#include "bench/exchange/igtl/sockets.h"
#include "bench/exchange/input/igtl_receiver.h"
#include "bench/exchange/input/igtl_volumes.h"
#include "bench/scene/scene_cost.h"

namespace wobblebench::bench {

namespace {

/// One image may take this part of the memory: its voxels are kept as bytes and as numbers, and
/// sticks are made of them.
constexpr double kImageShare = 1.0 / 16;

FileDescriptor connected(const Endpoint& server, std::chrono::milliseconds patience) try {
  return connect_to(server, patience);
} catch (const std::runtime_error& error) {
  throw hw::LinkOpenError(hw::OpenFault::missing,
                          std::string(error.what()) + "; must be a server of OpenIGTLink");
}

Endpoint endpoint_of(const std::string& server) try {
  return parse_endpoint(server, 1);
} catch (const std::invalid_argument& error) {
  throw InvalidOption("igtl", server, error.what());
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(std::llround(1000 * seconds));
}

}  // namespace

class IgtlLink::Impl {
 public:
  Impl(const std::string& server,
       const std::filesystem::path& geometry,
       const IgtlLinkOptions& options,
       const std::shared_ptr<LeftOut>& left_out);
  ~Impl() { close(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline);
  void cancel(bool on);
  void close();
  std::string loss() const;

 private:
  std::unique_ptr<ReceivedImage> first_image();
  void run();
  void receive();
  bool deliver(std::vector<std::byte> packets);
  void end(hw::ReadStatus status, const std::string& why);

  const Endpoint server_;
  const std::shared_ptr<LeftOut> left_out_;
  FileDescriptor wake_ = make_wake();
  IgtlReceiver receiver_;
  std::unique_ptr<ReceivedImage> first_;
  IgtlVolumes volumes_;

  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::deque<std::vector<std::byte>> queue_;  ///< packets of whole volumes
  std::size_t delivered_ = 0;                 ///< bytes of the first
  bool cancelled_ = false, closed_ = false;
  std::optional<hw::ReadStatus> ending_;
  std::string loss_ = "closed";
  std::jthread thread_;
};

IgtlLink::Impl::Impl(const std::string& server,
                     const std::filesystem::path& geometry,
                     const IgtlLinkOptions& options,
                     const std::shared_ptr<LeftOut>& left_out)
    : server_(endpoint_of(server)),
      left_out_(left_out),
      receiver_(connected(server_, milliseconds(options.patience_s)),
                wake_.get(),
                options.device,
                milliseconds(options.patience_s),
                static_cast<std::uint64_t>(kImageShare * available_memory_bytes()),
                left_out),
      first_(first_image()),
      volumes_(server_.text(), *first_, geometry, options, left_out),
      thread_([this] { run(); }) {}

std::unique_ptr<ReceivedImage> IgtlLink::Impl::first_image() try {
  std::unique_ptr<ReceivedImage> image = receiver_.next();
  receiver_.take_only(image->device);
  return image;
} catch (const ReceivingEnded& ended) {
  const std::string left_out = left_out_->text();
  throw hw::LinkOpenError(hw::OpenFault::gone,
                          server_.text() + ": " + ended.what() + "; must send a grey IMAGE" +
                              (left_out.empty() ? "" : ", and sent " + left_out));
}

void IgtlLink::Impl::run() {
  try {
    receive();
  } catch (const ReceivingEnded& ended) {
    end(ended.in_order() ? hw::ReadStatus::end_of_stream : hw::ReadStatus::lost, ended.what());
  } catch (const std::exception& error) {
    end(hw::ReadStatus::lost, error.what());
  }
  receiver_.close();
}

void IgtlLink::Impl::receive() {
  try {
    bool is_open = deliver(volumes_.add(*first_));
    first_.reset();
    while (is_open) is_open = deliver(volumes_.add(*receiver_.next()));
  } catch (const ReceivingEnded&) {
    deliver(volumes_.finish());
    throw;
  }
}

/// Waits for room. False: the link was closed.
bool IgtlLink::Impl::deliver(std::vector<std::byte> packets) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || queue_.size() < 2; });
  if (!packets.empty()) queue_.push_back(std::move(packets));
  changed_.notify_all();
  return !closed_;
}

void IgtlLink::Impl::end(hw::ReadStatus status, const std::string& why) {
  const std::lock_guard lock(mutex_);
  ending_ = status;
  loss_ = server_.text() + ": " + why;
  changed_.notify_all();
}

hw::ReadResult IgtlLink::Impl::read(std::span<std::byte> buffer, hw::HostTime deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(
      lock, deadline, [&] { return closed_ || cancelled_ || !queue_.empty() || ending_; });
  if (closed_) return {0, hw::ReadStatus::lost};
  if (cancelled_) return {0, hw::ReadStatus::cancelled};
  if (queue_.empty()) return {0, ending_.value_or(hw::ReadStatus::timeout)};
  const std::vector<std::byte>& packets = queue_.front();
  const std::size_t count = std::min(buffer.size(), packets.size() - delivered_);
  std::memcpy(buffer.data(), packets.data() + delivered_, count);
  delivered_ += count;
  if (delivered_ == packets.size()) {
    queue_.pop_front();
    delivered_ = 0;
    changed_.notify_all();
  }
  return {count, hw::ReadStatus::ok};
}

void IgtlLink::Impl::cancel(bool on) {
  const std::lock_guard lock(mutex_);
  cancelled_ = on;
  changed_.notify_all();
}

void IgtlLink::Impl::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  ::eventfd_write(wake_.get(), 1);
  changed_.notify_all();
}

std::string IgtlLink::Impl::loss() const {
  const std::lock_guard lock(mutex_);
  return loss_;
}

IgtlLink::IgtlLink(const std::string& server,
                   const std::filesystem::path& geometry,
                   const IgtlLinkOptions& options,
                   const std::shared_ptr<LeftOut>& left_out) {
  check_options(options);
  impl_ = std::make_unique<Impl>(server, geometry, options, left_out);
}

IgtlLink::~IgtlLink() = default;

hw::ReadResult IgtlLink::read(std::span<std::byte> buffer, hw::HostTime deadline) {
  return impl_->read(buffer, deadline);
}

void IgtlLink::cancel() {
  impl_->cancel(true);
}

void IgtlLink::resume() {
  impl_->cancel(false);
}

void IgtlLink::close() {
  impl_->close();
}

hw::LinkCapabilities IgtlLink::capabilities() const {
  return {.origin = hw::StreamOrigin::hardware, .copy_in = true, .waits_for_reader = true};
}

std::string IgtlLink::loss() const {
  return impl_->loss();
}

}  // namespace wobblebench::bench
