// TCP sockets.
#pragma once

#include <chrono>
#include <string>

#include "base/file.h"

namespace wobblebench::bench {

struct Endpoint {
  std::string host = "127.0.0.1";
  int port = 0;

  std::string text() const { return host + ":" + std::to_string(port); }
};

/// "18944", "HOST:18944" or "[ADDRESS]:18944"; the host is the loopback address unless it is given.
/// Throws std::invalid_argument "must be …".
Endpoint parse_endpoint(const std::string& text, int least_port);

/// A socket that listens, non-blocking. Throws std::runtime_error with the reason.
FileDescriptor listen_at(const Endpoint& endpoint);
/// A connected socket, non-blocking. Throws std::runtime_error with the reason.
FileDescriptor connect_to(const Endpoint& endpoint, std::chrono::milliseconds patience);

/// Address and port of this side, or of the other one.
std::string local_address(int socket);
std::string peer_address(int socket);

/// A file descriptor that poll(2) finds readable after eventfd_write(). Throws std::system_error.
FileDescriptor make_wake();

}  // namespace wobblebench::bench
