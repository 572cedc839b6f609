#include "bench/exchange/igtl/sockets.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <system_error>

namespace wobblebench::bench {

namespace {

constexpr int kMostPort = 65535, kBacklog = 16;

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Addresses addresses_of(const Endpoint& endpoint, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error =
      ::getaddrinfo(endpoint.host.c_str(), std::to_string(endpoint.port).c_str(), &hints, &found);
  if (error != 0) throw std::runtime_error(endpoint.text() + ": " + ::gai_strerror(error));
  return {found, &::freeaddrinfo};
}

FileDescriptor socket_for(const addrinfo& address) {
  return FileDescriptor(
      ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol));
}

/// The first address at which `use` succeeds; it returns 0 or errno.
FileDescriptor first_of(const Endpoint& endpoint,
                        int flags,
                        const std::function<int(int socket, const addrinfo&)>& use) {
  const Addresses addresses = addresses_of(endpoint, flags);
  int error = EADDRNOTAVAIL;
  for (const addrinfo* at = addresses.get(); at != nullptr; at = at->ai_next) {
    FileDescriptor socket = socket_for(*at);
    error = socket.is_open() ? use(socket.get(), *at) : errno;
    if (error == 0) return socket;
  }
  throw std::runtime_error(endpoint.text() + ": " + std::generic_category().message(error));
}

int finish_connecting(int socket, std::chrono::milliseconds patience) {
  pollfd watched{socket, POLLOUT, 0};
  const int ready = ::poll(&watched, 1, static_cast<int>(patience.count()));
  if (ready <= 0) return ready == 0 ? ETIMEDOUT : errno;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

using NameOf = int(int, sockaddr*, socklen_t*);

std::string address_text(int socket, NameOf* name_of) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  char host[NI_MAXHOST], port[NI_MAXSERV];
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  if (name_of(socket, any, &size) != 0) return "?";
  constexpr int kNumbers = NI_NUMERICHOST | NI_NUMERICSERV;
  if (::getnameinfo(any, size, host, sizeof host, port, sizeof port, kNumbers) != 0) return "?";
  const bool is_long = address.ss_family == AF_INET6;
  std::string text = is_long ? "[" : "";
  return text.append(host).append(is_long ? "]:" : ":").append(port);
}

}  // namespace

Endpoint parse_endpoint(const std::string& text, int least_port) {
  Endpoint endpoint;
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  if (colon != std::string::npos) endpoint.host = text.substr(0, colon);
  if (endpoint.host.starts_with('[') && endpoint.host.ends_with(']')) {
    endpoint.host.pop_back();
    endpoint.host.erase(0, 1);
  }
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), endpoint.port);
  const bool is_whole = error == std::errc() && end == port.data() + port.size();
  if (is_whole && endpoint.port >= least_port && endpoint.port <= kMostPort &&
      !endpoint.host.empty()) {
    return endpoint;
  }
  throw std::invalid_argument("must be PORT or HOST:PORT, with a port from " +
                              std::to_string(least_port) + " to " + std::to_string(kMostPort));
}

FileDescriptor listen_at(const Endpoint& endpoint) {
  return first_of(endpoint, AI_PASSIVE, [](int socket, const addrinfo& address) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (::bind(socket, address.ai_addr, address.ai_addrlen) != 0) return errno;
    return ::listen(socket, kBacklog) == 0 ? 0 : errno;
  });
}

FileDescriptor connect_to(const Endpoint& endpoint, std::chrono::milliseconds patience) {
  return first_of(endpoint, 0, [&](int socket, const addrinfo& address) {
    if (::connect(socket, address.ai_addr, address.ai_addrlen) == 0) return 0;
    return errno == EINPROGRESS ? finish_connecting(socket, patience) : errno;
  });
}

std::string local_address(int socket) {
  return address_text(socket, &::getsockname);
}

std::string peer_address(int socket) {
  return address_text(socket, &::getpeername);
}

FileDescriptor make_wake() {
  FileDescriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
  return wake;
}

}  // namespace wobblebench::bench
