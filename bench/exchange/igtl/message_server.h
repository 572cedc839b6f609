// A server of OpenIGTLink: sends each message to all clients that are connected, and waits for
// none.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/file.h"

namespace wobblebench::bench {

struct IgtlClientReport {
  std::string address;  ///< "127.0.0.1:51234"
  double seconds = 0;   ///< that it was connected
  std::uint64_t sent = 0;
  std::uint64_t bytes = 0;
  std::uint64_t replaced = 0;  ///< by a later message of the same place: the client was too slow
  std::uint64_t left = 0;      ///< not sent when the connection ended
  std::string ending;          ///< why it did
};

struct IgtlServerReport {
  std::vector<IgtlClientReport> clients;  ///< the first kMostReported
  std::uint64_t more_clients = 0;         ///< beyond them
  std::uint64_t refused = 0;              ///< connections beyond those at once that are allowed
};

/// Messages wait, for each client, in one place a name: a later one replaces the one that waits,
/// which is counted, so that slow clients get the newest and memory is bounded. What clients send
/// is read and ignored. Functions may be called from any thread, and do not wait for a client.
class IgtlServer {
 public:
  static constexpr std::size_t kMostReported = 64;

  /// Listens at `host` (a name or an address) and `port`; 0: one that is free. Throws
  /// std::runtime_error with the reason.
  IgtlServer(const std::string& host, int port, int most_clients);
  ~IgtlServer();
  IgtlServer(const IgtlServer&) = delete;
  IgtlServer& operator=(const IgtlServer&) = delete;

  /// "127.0.0.1:18944".
  const std::string& address() const { return address_; }
  bool has_clients() const;
  void wait_for_clients(int count);
  /// What each client gets first: those that are connected now, those that connect later at once.
  void greet(const std::shared_ptr<const std::string>& message);
  void send(const std::string& place, const std::shared_ptr<const std::string>& message);

  /// Waits while clients take what waits, until none has taken a byte for `patience`, and closes.
  /// To be called once.
  IgtlServerReport finish(std::chrono::milliseconds patience);

 private:
  using Message = std::shared_ptr<const std::string>;
  struct Client {
    FileDescriptor socket;
    IgtlClientReport report;
    std::chrono::steady_clock::time_point since;
    std::deque<std::pair<std::string, Message>> waiting;  ///< by place
    Message current;
    std::size_t done = 0;  ///< bytes of `current`
    bool is_over = false;
  };

  void serve();
  void place_for_all(const std::string& place, const Message& message);  // `mutex_` is held
  void accept_client();
  void work(Client& client, short events);
  void read_and_ignore(Client& client);
  void write(Client& client);
  bool take_next(Client& client);
  void remove_ended(bool all);
  bool is_idle() const;
  std::uint64_t bytes_taken() const;
  void wake() const;

  FileDescriptor listener_, wake_;
  std::string address_;
  const std::size_t most_clients_;

  mutable std::mutex mutex_;  ///< of what follows, but for `current` and what is counted of it
  std::condition_variable changed_;
  std::list<Client> clients_;
  Message greeting_;
  IgtlServerReport report_;
  bool stops_ = false;
  std::jthread thread_;
};

}  // namespace wobblebench::bench
