#include "bench/exchange/input/igtl_receiver.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

/// No message is longer: what is announced so is no message.
constexpr std::uint64_t kMostBodyBytes = std::uint64_t{1} << 32U;

/// Of an image: each renews the patience, so that a slow server is none that is silent.
constexpr std::uint64_t kPieceBytes = 64 << 10;

}  // namespace

IgtlReceiver::IgtlReceiver(FileDescriptor socket,
                           int wake,
                           std::string device,
                           std::chrono::milliseconds patience,
                           std::uint64_t most_bytes,
                           std::shared_ptr<LeftOut> left_out)
    : socket_(std::move(socket)),
      wake_(wake),
      device_(std::move(device)),
      patience_(patience),
      most_bytes_(most_bytes),
      left_out_(std::move(left_out)) {}

void IgtlReceiver::wait() const {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline_ - std::chrono::steady_clock::now());
  pollfd watched[] = {{socket_.get(), POLLIN, 0}, {wake_, POLLIN, 0}};
  const auto most = std::max<std::int64_t>(left.count(), 0);
  const int ready = ::poll(watched, 2, static_cast<int>(most));
  if (watched[1].revents != 0) throw ReceivingEnded(true, "closed");
  if (ready == 0 || left.count() <= 0) {
    const double seconds = std::chrono::duration<double>(patience_).count();
    throw ReceivingEnded(false, "no image came for " + significant(seconds, 3) + " s");
  }
}

std::size_t IgtlReceiver::receive(char* to, std::size_t count) {
  std::size_t done = 0;
  while (done < count) {
    wait();  // before each: a server that never pauses must not keep from ending
    const ssize_t got = ::recv(socket_.get(), to + done, count - done, MSG_DONTWAIT);
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else if (got == 0) {
      if (done == 0) return 0;
      throw ReceivingEnded(false, "the server closed the connection within a message");
    } else if (errno != EAGAIN && errno != EINTR) {
      throw ReceivingEnded(false, std::generic_category().message(errno));
    }
  }
  return done;
}

void IgtlReceiver::skip(std::uint64_t count) {
  std::array<char, 65536> ignored;
  while (count > 0) {
    const auto piece = static_cast<std::size_t>(std::min<std::uint64_t>(count, ignored.size()));
    if (receive(ignored.data(), piece) == 0) {
      throw ReceivingEnded(false, "the server closed the connection within a message");
    }
    count -= piece;
  }
}

bool IgtlReceiver::is_wanted(const ReceivedHeader& header) {
  if (header.type != "IMAGE") {
    left_out_->count(header.type + " messages");
    return false;
  }
  if (!device_.empty() && header.device != device_) {
    left_out_->count("images of other devices");
    return false;
  }
  if (header.body_bytes <= most_bytes_) return true;
  left_out_->count("images of more than " + significant(static_cast<double>(most_bytes_) / 1e6, 4) +
                   " MB");
  return false;
}

/// Memory grows with what comes, and not with what is announced.
std::string IgtlReceiver::receive_body(std::uint64_t count) {
  std::string body;
  while (body.size() < count) {
    const std::size_t before = body.size();
    deadline_ = std::chrono::steady_clock::now() + patience_;
    const auto piece = static_cast<std::size_t>(std::min(count - before, kPieceBytes));
    body.resize(before + piece);
    if (receive(body.data() + before, piece) == 0) {
      throw ReceivingEnded(false, "the server closed the connection within a message");
    }
  }
  return body;
}

std::unique_ptr<ReceivedImage> IgtlReceiver::take(const ReceivedHeader& header) {
  auto received = std::make_unique<ReceivedImage>();
  received->body = receive_body(header.body_bytes);
  ReceivedBody body = read_igtl_body(header, received->body);
  received->image = read_igtl_image(body.content);
  if (received->image.components != 1) throw IgtlRefusal("is of colours");
  received->metadata = std::move(body.metadata);
  received->timestamp = header.timestamp;
  received->device = header.device;
  return received;
}

std::unique_ptr<ReceivedImage> IgtlReceiver::next() {
  const auto deadline = std::chrono::steady_clock::now() + patience_;
  for (;;) {
    deadline_ = deadline;
    std::array<char, kIgtlHeaderBytes> bytes;
    if (receive(bytes.data(), bytes.size()) == 0) {
      throw ReceivingEnded(true, "the server closed the connection");
    }
    const auto header = read_igtl_header({bytes.data(), bytes.size()});
    if (!header) throw ReceivingEnded(false, "sends what is no message of OpenIGTLink");
    if (header->body_bytes > kMostBodyBytes) {
      throw ReceivingEnded(false,
                           "announces a message of " + std::to_string(header->body_bytes) +
                               " bytes; must be at most " + std::to_string(kMostBodyBytes));
    }
    if (!is_wanted(*header)) {
      skip(header->body_bytes);
      continue;
    }
    try {
      return take(*header);
    } catch (const IgtlRefusal& refusal) {
      left_out_->count(std::string("images: ") + refusal.what());
    }
  }
}

}  // namespace wobblebench::bench
