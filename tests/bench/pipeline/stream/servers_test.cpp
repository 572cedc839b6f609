// Servers whose clients come and go while several threads send: for the thread sanitizer.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "bench/exchange/igtl/message_server.h"
#include "bench/exchange/igtl/sockets.h"
#include "bench/exchange/input/igtl_receiver.h"
#include "bench/live/newest.h"
#include "bench/live/server/live_server.h"

namespace wobblebench::bench {

extern "C" LiveServer* wobblebench_make_live_server(const ServerOptions&, ServerCalls);

namespace {

constexpr std::chrono::seconds kPatience{20};

void send(const FileDescriptor& socket, const std::string& bytes) {
  ::send(socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

/// Takes messages of the page's server, and says that it has seen them.
int view(int port) {
  const FileDescriptor socket = connect_to({.port = port}, kPatience);
  ::fcntl(socket.get(), F_SETFL, 0);
  const std::string host = "127.0.0.1:" + std::to_string(port) + "\r\n";
  send(socket,
       "GET /socket HTTP/1.1\r\nHost: " + host + "Origin: http://" + host +
           "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n");
  int got = 0;
  for (char bytes[4096]; got < 20; ++got) {
    if (::recv(socket.get(), bytes, sizeof bytes, 0) <= 0) break;
    if (got > 0) send(socket, std::string("\x81\x84\0\0\0\0seen\x81\x83\0\0\0\0ask", 19));
  }
  return got;
}

TEST(Servers, ThePagesViewersGetWhatSeveralThreadsPublish) {
  std::atomic<int> asked = 0;
  const auto take = [&](const std::string&) {
    return ServerCalls::Answer{std::to_string(++asked), ChannelSet{true, true}};
  };
  const std::unique_ptr<LiveServer> server(wobblebench_make_live_server(
      {}, {.asset = [](auto) { return ""; }, .take = take, .channels_changed = [] {}}));
  const auto publish = [&](const int& number) {
    const auto channel = static_cast<Channel>(number % 2);
    if (!server->is_wanted(channel) || server->viewers() == 0) return;
    server->publish(channel, {std::make_shared<const std::string>("picture"), false});
  };
  NewestWorker<int> worker(publish);
  std::jthread other([&](const std::stop_token& stop) {
    for (int i = 0; !stop.stop_requested(); publish(++i)) worker.give(i);
  });
  const auto view_twice = [&] {
    for (int i = 0; i < 2; ++i) EXPECT_EQ(view(server->port()), 20);
  };
  { const std::jthread first(view_twice), second(view_twice), third(view_twice); }
  EXPECT_GT(asked, 0);
}

TEST(Servers, ClientsOfOpenIgtLinkGetWholeImages) {
  IgtlServer server("127.0.0.1", 0, 8);
  const std::string voxels(64 * 64 * 16, '\7');
  const auto image = std::make_shared<const std::string>(igtl_image(
      {.device = "Volume"},
      {.sizes = {64, 64, 16}, .steps = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, .voxels = voxels}));
  server.greet(std::make_shared<const std::string>(igtl_status({.device = "Status"}, "begins")));
  const auto left_out = std::make_shared<LeftOut>();
  const auto receive = [&] {
    for (int i = 0; i < 3; ++i) {
      const FileDescriptor wake = make_wake();
      IgtlReceiver receiver(connect_to(parse_endpoint(server.address(), 1), kPatience),
                            wake.get(),
                            "",
                            kPatience,
                            1 << 20,
                            left_out);
      for (int k = 0; k < 5; ++k) EXPECT_EQ(receiver.next()->image.voxels, voxels);
    }
  };
  {
    const auto send = [&](const std::stop_token& stop) {
      server.wait_for_clients(1);
      for (int i = 0; !stop.stop_requested(); ++i) {
        if (server.has_clients()) server.send(std::to_string(i % 2), image);
      }
    };
    const std::jthread sender(send), another(send);
    const std::jthread first(receive), second(receive), third(receive);
  }
  EXPECT_GE(server.finish(std::chrono::milliseconds(100)).clients.size(), 9u);
  EXPECT_NE(left_out->text(), "");
}

}  // namespace
}  // namespace wobblebench::bench
