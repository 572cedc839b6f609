#include "bench/exchange/igtl/message_server.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "bench/exchange/igtl/sockets.h"

namespace wobblebench::bench {

namespace {

/// Of a connection whose other side takes nothing, milliseconds.
constexpr unsigned kSilence_ms = 60000;
/// Of all clients together at the end, in units of the patience without a byte.
constexpr int kMostPatiences = 10;
/// After a failing accept(2), say for want of file descriptors.
constexpr std::chrono::milliseconds kAcceptPause{50};

void set_up(int socket) {
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  ::setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &kSilence_ms, sizeof kSilence_ms);
}

std::string reason(int error_number) {
  return std::generic_category().message(error_number);
}

}  // namespace

IgtlServer::IgtlServer(const std::string& host, int port, int most_clients)
    : listener_(listen_at({host, port})),
      wake_(make_wake()),
      address_(local_address(listener_.get())),
      most_clients_(static_cast<std::size_t>(most_clients)),
      thread_([this] { serve(); }) {}

IgtlServer::~IgtlServer() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  wake();
}

void IgtlServer::wake() const {
  ::eventfd_write(wake_.get(), 1);
}

bool IgtlServer::has_clients() const {
  const std::lock_guard lock(mutex_);
  return !clients_.empty();
}

void IgtlServer::wait_for_clients(int count) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return clients_.size() >= static_cast<std::size_t>(count); });
}

void IgtlServer::greet(const std::shared_ptr<const std::string>& message) {
  {
    // In one step, so that a client that connects meanwhile gets it, and gets it once.
    const std::lock_guard lock(mutex_);
    greeting_ = message;
    place_for_all("", message);
  }
  wake();
}

void IgtlServer::send(const std::string& place, const std::shared_ptr<const std::string>& message) {
  {
    const std::lock_guard lock(mutex_);
    place_for_all(place, message);
  }
  wake();
}

void IgtlServer::place_for_all(const std::string& place, const Message& message) {
  for (Client& client : clients_) {
    const auto found =
        std::ranges::find(client.waiting, place, &std::pair<std::string, Message>::first);
    if (found == client.waiting.end()) {
      client.waiting.emplace_back(place, message);
    } else {
      found->second = message;
      ++client.report.replaced;
    }
  }
}

void IgtlServer::serve() {
  for (;;) {
    std::vector<pollfd> watched = {{wake_.get(), POLLIN, 0}, {listener_.get(), POLLIN, 0}};
    std::vector<Client*> clients;
    {
      const std::lock_guard lock(mutex_);
      if (stops_) break;
      for (Client& client : clients_) {
        const bool writes = client.current || !client.waiting.empty();
        const int events = writes ? POLLIN | POLLOUT : POLLIN;
        watched.push_back({client.socket.get(), static_cast<short>(events), 0});
        clients.push_back(&client);
      }
    }
    ::poll(watched.data(), watched.size(), -1);
    eventfd_t wakes = 0;
    ::eventfd_read(wake_.get(), &wakes);
    for (std::size_t i = 0; i < clients.size(); ++i) work(*clients[i], watched[i + 2].revents);
    if (watched[1].revents != 0) accept_client();
    remove_ended(false);
  }
  remove_ended(true);
}

void IgtlServer::accept_client() {
  FileDescriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!socket.is_open()) {
    std::this_thread::sleep_for(kAcceptPause);
    return;
  }
  set_up(socket.get());
  const std::lock_guard lock(mutex_);
  if (clients_.size() >= most_clients_) {
    ++report_.refused;
    return;
  }
  Client& client = clients_.emplace_back();
  client.report.address = peer_address(socket.get());
  client.socket = std::move(socket);
  client.since = std::chrono::steady_clock::now();
  if (greeting_) client.waiting.emplace_back("", greeting_);
  changed_.notify_all();
}

void IgtlServer::work(Client& client, short events) {
  if ((events & (POLLIN | POLLHUP | POLLERR)) != 0) read_and_ignore(client);
  if (!client.is_over && (events & POLLOUT) != 0) write(client);
}

void IgtlServer::read_and_ignore(Client& client) {
  std::array<char, 65536> ignored;
  const ssize_t got = ::recv(client.socket.get(), ignored.data(), ignored.size(), 0);
  if (got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR))) return;
  client.is_over = true;
  client.report.ending = got == 0 ? "closed by the client" : reason(errno);
}

/// The message to go on with.
bool IgtlServer::take_next(Client& client) {
  if (client.current) return true;
  const std::lock_guard lock(mutex_);
  if (client.waiting.empty()) return false;
  client.current = std::move(client.waiting.front().second);
  client.waiting.pop_front();
  client.done = 0;
  return true;
}

/// As much as the socket takes at once, of one message: the others have their turn, too.
void IgtlServer::write(Client& client) {
  if (!take_next(client)) return;
  const std::string& bytes = *client.current;
  const ssize_t count = ::send(client.socket.get(),
                               bytes.data() + client.done,
                               bytes.size() - client.done,
                               MSG_NOSIGNAL | MSG_DONTWAIT);
  if (count < 0) {
    if (errno == EAGAIN || errno == EINTR) return;
    client.is_over = true;
    client.report.ending = reason(errno);
    return;
  }
  const std::lock_guard lock(mutex_);
  client.done += static_cast<std::size_t>(count);
  client.report.bytes += static_cast<std::uint64_t>(count);
  if (client.done < bytes.size()) return;
  ++client.report.sent;
  client.current.reset();
}

/// Keeps what is known of clients that are gone; of all: the server ends.
void IgtlServer::remove_ended(bool all) {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  for (Client& client : clients_) {
    if (!client.is_over && !all) continue;
    IgtlClientReport& report = client.report;
    if (!client.is_over) report.ending = "connected to the end";
    client.is_over = true;
    report.left = client.waiting.size() + (client.current ? 1 : 0);
    report.seconds = std::chrono::duration<double>(now - client.since).count();
    if (report_.clients.size() < kMostReported) {
      report_.clients.push_back(report);
    } else {
      ++report_.more_clients;
    }
  }
  std::erase_if(clients_, [](const Client& client) { return client.is_over; });
  changed_.notify_all();
}

bool IgtlServer::is_idle() const {
  return std::ranges::all_of(
      clients_, [](const Client& client) { return !client.current && client.waiting.empty(); });
}

std::uint64_t IgtlServer::bytes_taken() const {
  std::uint64_t bytes = 0;
  for (const Client& client : clients_) bytes += client.report.bytes;
  return bytes;
}

IgtlServerReport IgtlServer::finish(std::chrono::milliseconds patience) {
  {
    std::unique_lock lock(mutex_);
    const auto last = std::chrono::steady_clock::now() + kMostPatiences * patience;
    std::uint64_t taken = 0;
    do {
      taken = bytes_taken();
      changed_.wait_for(lock, patience, [&] { return is_idle(); });
    } while (!is_idle() && bytes_taken() > taken && std::chrono::steady_clock::now() < last);
    stops_ = true;
  }
  wake();
  thread_.join();
  return std::move(report_);
}

}  // namespace wobblebench::bench
