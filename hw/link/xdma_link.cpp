#include "hw/link/xdma_link.h"

#include <chrono>

#include "base/options.h"
#include "hw/link/xdma_node.h"
#include "hw/link/xdma_reader.h"

namespace wobblebench::hw {
namespace {

/// A thread that is not inside a read ends much sooner; close() must return within 10 ms.
constexpr auto kClosePatience = std::chrono::milliseconds(5);

void check_alignment(const XdmaLinkOptions& options, std::size_t alignment) {
  if (static_cast<std::size_t>(options.transfer_kb) * 1024 % alignment == 0) return;
  throw InvalidOption(
      "transfer_kb",
      std::to_string(options.transfer_kb),
      "must be a multiple of the device's alignment, " + std::to_string(alignment) + " bytes");
}

XdmaNode open_node(const std::filesystem::path& path, const XdmaLinkOptions& options) {
  check_options(options);
  const auto patience = std::chrono::duration_cast<HostClock::duration>(
      std::chrono::duration<double>(options.busy_patience_s));
  XdmaNode node = open_xdma_node(path, options.end_of_packet, HostClock::now() + patience);
  check_alignment(options, node.alignment);
  return node;
}

}  // namespace

XdmaLink::XdmaLink(const std::filesystem::path& path, const XdmaLinkOptions& options) {
  XdmaNode node = open_node(path, options);
  kind_ = node.kind;
  transfer_bytes_ = static_cast<std::size_t>(options.transfer_kb) * 1024;
  reader_ = std::make_shared<XdmaReader>(std::move(node), path.string(), transfer_bytes_);
  thread_ = std::jthread([reader = reader_] { reader->run(); });
}

XdmaLink::~XdmaLink() {
  XdmaLink::close();
}

ReadResult XdmaLink::read(std::span<std::byte> buffer, HostTime deadline) {
  return reader_->read(buffer, deadline);
}

void XdmaLink::cancel() {
  reader_->cancel();
}

void XdmaLink::resume() {
  reader_->resume();
}

void XdmaLink::close() {
  if (!thread_.joinable()) return;
  reader_->close();
  if (reader_->wait_until_closed(HostClock::now() + kClosePatience)) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

LinkCapabilities XdmaLink::capabilities() const {
  LinkCapabilities capabilities;
  capabilities.origin =
      kind_ == XdmaNodeKind::card ? StreamOrigin::hardware : StreamOrigin::emulator;
  capabilities.waits_for_reader = kind_ == XdmaNodeKind::fifo;
  capabilities.buffer_bytes = transfer_bytes_;
  capabilities.buffers = static_cast<int>(reader_->queued_transfers());
  capabilities.buffers_per_interrupt = 1;
  return capabilities;
}

std::string XdmaLink::loss() const {
  return reader_->loss();
}

}  // namespace wobblebench::hw
