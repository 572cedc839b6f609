// The library that live_server.cpp loads: Boost.Beast on one thread. All that viewers share is
// touched on that thread alone, but for the newest messages, which publish() leaves under a lock.
#include <fcntl.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/user_error.h"
#include "bench/live/server/live_server.h"
#include "bench/live/server/request_check.h"

namespace wobblebench::bench {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Error = beast::error_code;
using Request = http::request<http::empty_body>;

template <class Socket>
void close_on_exec(Socket& socket) {
  ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
}

constexpr std::chrono::seconds kRequestTimeout{10};
/// A viewer that answers no ping for so long is gone.
constexpr std::chrono::seconds kViewerTimeout{30};
constexpr int kMostConnections = 64;
constexpr std::uint32_t kMostHeaderBytes = 8192;
constexpr std::string_view kSeen = "seen";

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// What viewers and connections need of the server.
struct Shared {
  ServerOptions options;
  ServerCalls calls;
  ServedAs served_as;
  std::mutex mutex;  ///< of `newest`
  std::array<LiveMessage, kChannels> newest;
  std::array<std::atomic<int>, kChannels> wanted{};
  std::atomic<int> viewers = 0;
  int connections = 0;
  asio::io_context context{1};  ///< last: destroying it destroys what waits, viewers among them
};

/// One page: a WebSocket. Lives as long as an operation on it is pending.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(Shared& shared, Tcp::socket socket)
      : shared_(shared), socket_(std::move(socket)), pause_(shared.context) {
    ++shared_.viewers;
    want({true, true, true, false, false, true, true, false, false});
  }
  ~Viewer() {
    want({});
    --shared_.viewers;
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  void accept(const Request& request) {
    websocket::stream_base::timeout timeout{kRequestTimeout, kViewerTimeout, true};
    socket_.set_option(timeout);
    socket_.read_message_max(shared_.options.most_message_bytes);
    socket_.async_accept(request, [self = shared_from_this()](Error error) {
      if (error) return;
      self->is_open_ = true;
      self->offer_all();
      self->read();
    });
  }

  /// The newest message of a channel is there.
  void offer(std::size_t channel) {
    if (!wants_[channel]) return;
    {
      const std::lock_guard lock(shared_.mutex);
      waiting_[channel] = shared_.newest[channel];
    }
    write();
  }

 private:
  void want(const ChannelSet& wants) {
    for (std::size_t i = 0; i < kChannels; ++i) {
      shared_.wanted[i] += static_cast<int>(wants[i]) - static_cast<int>(wants_[i]);
      if (!wants[i]) waiting_[i] = {};
    }
    wants_ = wants;
  }
  void offer_all() {
    for (std::size_t i = 0; i < kChannels; ++i) offer(i);
  }

  void read() {
    in_.clear();
    socket_.async_read(in_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->close();
      self->hold_back();
    });
  }

  /// Messages beyond the rate wait until the second is over.
  void hold_back() {
    const auto now = std::chrono::steady_clock::now();
    if (now - second_ >= std::chrono::seconds(1)) {
      second_ = now;
      messages_ = 0;
    }
    if (++messages_ <= shared_.options.most_messages_per_s) return take();
    pause_.expires_at(second_ + std::chrono::seconds(1));
    pause_.async_wait([self = shared_from_this()](Error error) {
      if (!error) self->take();
    });
  }

  /// The next message is read when the answer to this one is written.
  void take() {
    const std::string message = beast::buffers_to_string(in_.data());
    if (message == kSeen) {
      in_flight_ = false;
      write();
      return read();
    }
    ServerCalls::Answer answer = shared_.calls.take(message);
    if (answer.channels) {
      want(*answer.channels);
      offer_all();
      shared_.calls.channels_changed();
    }
    if (answer.text.empty()) return read();
    answer_ = {std::make_shared<const std::string>(std::move(answer.text)), true};
    write();
  }

  /// Sends the answer that waits, or else the next channel in turn.
  void write() {
    if (!is_open_ || is_writing_) return;
    if (answer_.bytes) return send(std::exchange(answer_, {}), true);
    if (in_flight_) return;
    for (std::size_t i = 1; i <= kChannels; ++i) {
      const std::size_t channel = (last_ + i) % kChannels;
      if (!waiting_[channel].bytes) continue;
      last_ = channel;
      in_flight_ = true;
      return send(std::exchange(waiting_[channel], {}), false);
    }
  }

  void send(LiveMessage message, bool is_answer) {
    is_writing_ = true;
    socket_.text(message.is_text);
    const auto buffer = asio::buffer(*message.bytes);
    socket_.async_write(buffer,
                        [self = shared_from_this(), kept = std::move(message.bytes), is_answer](
                            Error error, std::size_t) {
                          self->is_writing_ = false;
                          if (error) return self->close();
                          if (is_answer) self->read();
                          self->write();
                        });
  }

  void close() {
    is_open_ = false;
    want({});
    Error ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }

  Shared& shared_;
  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer pause_;
  beast::flat_buffer in_;
  ChannelSet wants_{};
  std::array<LiveMessage, kChannels> waiting_;
  LiveMessage answer_;
  bool is_open_ = false;
  bool is_writing_ = false;
  bool in_flight_ = false;  ///< a message that the page has not seen yet
  std::size_t last_ = 0;    ///< channel
  std::chrono::steady_clock::time_point second_{};
  int messages_ = 0;  ///< in this second
};

using Viewers = std::vector<std::weak_ptr<Viewer>>;

/// One HTTP request, and its answer or a viewer.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Shared& shared, Viewers& viewers, Tcp::socket socket)
      : shared_(shared), viewers_(viewers), stream_(std::move(socket)) {
    ++shared_.connections;
    parser_.header_limit(kMostHeaderBytes);
    parser_.body_limit(0);
  }
  ~Connection() { --shared_.connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    stream_.expires_after(kRequestTimeout);
    http::async_read(
        stream_, buffer_, parser_, [self = shared_from_this()](Error error, std::size_t) {
          if (!error) self->answer();
        });
  }

 private:
  void answer() {
    const Request& request = parser_.get();
    const bool is_socket = websocket::is_upgrade(request);
    const std::string_view target = view(request.target());
    const std::string refusal = why_refused({.host = view(request[http::field::host]),
                                             .origin = view(request[http::field::origin]),
                                             .target = target,
                                             .is_socket = is_socket},
                                            shared_.served_as);
    if (!refusal.empty()) return reply(http::status::forbidden, "text/plain", refusal);
    if (is_socket && path_of(target) == "/socket") return become_viewer();
    if (request.method() != http::verb::get) {
      return reply(http::status::method_not_allowed, "text/plain", "only GET");
    }
    serve(path_of(target));
  }

  void become_viewer() {
    if (shared_.viewers >= shared_.options.most_viewers) {
      return reply(http::status::service_unavailable, "text/plain", "too many viewers");
    }
    stream_.expires_never();
    const auto viewer = std::make_shared<Viewer>(shared_, stream_.release_socket());
    std::erase_if(viewers_, [](const auto& other) { return other.expired(); });
    viewers_.push_back(viewer);
    viewer->accept(parser_.get());
  }

  void serve(std::string_view path) {
    const std::string_view name = path == "/" ? "live.html" : path.substr(1);
    const std::string_view asset = shared_.calls.asset(name);
    if (asset.empty()) return reply(http::status::not_found, "text/plain", "not found");
    const std::string_view type = name.ends_with(".html")  ? "text/html"
                                  : name.ends_with(".css") ? "text/css"
                                                           : "text/javascript";
    reply(http::status::ok, type, asset);
  }

  void reply(http::status status, std::string_view type, std::string_view body) {
    response_.result(status);
    response_.body() = body;
    response_.keep_alive(false);
    const std::string content_type = std::string(type) + "; charset=utf-8";
    response_.set(http::field::content_type, content_type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy",
                  "default-src 'none'; script-src 'self'; style-src 'self'; img-src blob: data:; "
                  "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors "
                  "'none'");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.prepare_payload();
    http::async_write(stream_, response_, [self = shared_from_this()](Error, std::size_t) {
      Error ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    });
  }

  Shared& shared_;
  Viewers& viewers_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
};

class BeastServer : public LiveServer {
 public:
  BeastServer(const ServerOptions& options, ServerCalls calls)
      : acceptor_(shared_.context), retry_(shared_.context) {
    shared_.options = options;
    shared_.calls = std::move(calls);
    bind();
    shared_.served_as = {options.token, options.names};
    accept();
    thread_ = std::thread([this] { shared_.context.run(); });
  }
  ~BeastServer() override {
    shared_.context.stop();
    thread_.join();
  }
  BeastServer(const BeastServer&) = delete;
  BeastServer& operator=(const BeastServer&) = delete;

  int port() const override { return acceptor_.local_endpoint().port(); }
  int viewers() const override { return shared_.viewers; }
  bool is_wanted(Channel channel) const override {
    return shared_.wanted[static_cast<std::size_t>(channel)] > 0;
  }
  void publish(Channel channel, LiveMessage message) override {
    const auto index = static_cast<std::size_t>(channel);
    {
      const std::lock_guard lock(shared_.mutex);
      shared_.newest[index] = std::move(message);
    }
    asio::post(shared_.context, [this, index] {
      for (const auto& known : viewers_) {
        if (const auto viewer = known.lock()) viewer->offer(index);
      }
    });
  }

 private:
  void bind() {
    Error error;
    const auto address = asio::ip::make_address(shared_.options.address, error);
    if (error) {
      throw UserError("--listen = " + shared_.options.address + ": must be an IP address");
    }
    const Tcp::endpoint endpoint(address, static_cast<unsigned short>(shared_.options.port));
    acceptor_.open(endpoint.protocol(), error);
    close_on_exec(acceptor_);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (!error) return;
    const std::string port = std::to_string(shared_.options.port);
    throw UserError("--listen = " + shared_.options.address + ", --port = " + port + ": " +
                    error.message());
  }

  void accept() {
    acceptor_.async_accept([this](Error error, Tcp::socket socket) {
      if (error) return accept_later();
      close_on_exec(socket);
      socket.set_option(Tcp::no_delay(true), error);
      if (shared_.connections < kMostConnections) {
        std::make_shared<Connection>(shared_, viewers_, std::move(socket))->read();
      }
      accept();
    });
  }

  /// The system has no descriptors left, say.
  void accept_later() {
    retry_.expires_after(std::chrono::milliseconds(100));
    retry_.async_wait([this](Error error) {
      if (!error) accept();
    });
  }

  Shared shared_;
  Tcp::acceptor acceptor_;
  asio::steady_timer retry_;
  Viewers viewers_;
  std::thread thread_;
};

}  // namespace

/// For the caller to own.
extern "C" LiveServer* wobblebench_make_live_server(const ServerOptions& options,
                                                    ServerCalls calls) {
  return new BeastServer(options, std::move(calls));
}

}  // namespace wobblebench::bench
