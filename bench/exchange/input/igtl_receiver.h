// Receives the images of one device from a server of OpenIGTLink.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/file.h"
#include "bench/exchange/igtl/left_out.h"
#include "bench/exchange/igtl/received_message.h"

namespace wobblebench::bench {

/// One grey image; its voxels lie in `body`.
struct ReceivedImage {
  std::string body;
  IgtlImage image;
  std::map<std::string, std::string> metadata;
  std::uint64_t timestamp = 0;
  std::string device;
};

/// Why nothing more comes.
class ReceivingEnded : public std::runtime_error {
 public:
  ReceivingEnded(bool in_order, const std::string& why)
      : std::runtime_error(why), in_order_(in_order) {}
  /// The server closed the connection between two messages, or this side did.
  bool in_order() const { return in_order_; }

 private:
  bool in_order_;
};

class IgtlReceiver {
 public:
  /// `wake`: readable: receiving ends. Of images of more bytes than `most_bytes` none is stored.
  IgtlReceiver(FileDescriptor socket,
               int wake,
               std::string device,
               std::chrono::milliseconds patience,
               std::uint64_t most_bytes,
               std::shared_ptr<LeftOut> left_out);

  /// The next grey image of the device. Damaged ones, and all other messages, are counted and left
  /// out, and are not what the server is waited for. Throws ReceivingEnded.
  std::unique_ptr<ReceivedImage> next();
  /// From now on of this device alone.
  void take_only(const std::string& device) { device_ = device; }
  void close() { socket_.close(); }

 private:
  std::unique_ptr<ReceivedImage> take(const ReceivedHeader& header);
  std::string receive_body(std::uint64_t count);
  bool is_wanted(const ReceivedHeader& header);
  /// Bytes that came, fewer only where the server closed before the first.
  std::size_t receive(char* to, std::size_t count);
  /// For bytes, until the deadline.
  void wait() const;
  void skip(std::uint64_t count);

  FileDescriptor socket_;
  int wake_;
  std::string device_;
  std::chrono::milliseconds patience_;
  std::chrono::steady_clock::time_point deadline_;  ///< for an image, or more of it
  std::uint64_t most_bytes_;
  std::shared_ptr<LeftOut> left_out_;
};

}  // namespace wobblebench::bench
