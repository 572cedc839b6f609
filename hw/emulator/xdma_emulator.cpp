#include "hw/emulator/xdma_emulator.h"

#include <fcntl.h>
#include <stdlib.h>

#include <cerrno>
#include <exception>
#include <stdexcept>
#include <utility>

#include "base/file.h"
#include "hw/emulator/fuse_session.h"
#include "hw/emulator/xdma_card.h"
#include "hw/link/xdma_node.h"

namespace wobblebench::hw {
namespace {

/// Tries to mount. Returns the error, or an empty text.
std::string try_to_mount() {
  const FileDescriptor device(::open("/dev/fuse", O_RDWR | O_CLOEXEC));
  if (!device.is_open()) return "/dev/fuse: " + error_text(errno);
  std::string folder = (std::filesystem::temp_directory_path() / "wobblebench_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return folder + ": " + error_text(errno);
  std::string error_message;
  try {
    const XdmaEmulator emulator(folder, [] { return nullptr; });
  } catch (const std::runtime_error& error) {
    error_message = error.what();
  }
  std::error_code ignored;
  std::filesystem::remove(folder, ignored);
  return error_message;
}

}  // namespace

XdmaEmulator::XdmaEmulator(const std::filesystem::path& folder,
                           Source source,
                           const XdmaEmulatorOptions& options)
    : folder_(std::filesystem::absolute(folder)),
      card_(std::make_unique<XdmaCard>(std::move(source), options)),
      session_(std::make_unique<FuseSession>(folder_, *card_)) {}

XdmaEmulator::~XdmaEmulator() {
  card_->unplug();
  session_.reset();
}

std::filesystem::path XdmaEmulator::path() const {
  return folder_ / kNodeName;
}

void XdmaEmulator::unplug() {
  card_->unplug();
}

void XdmaEmulator::replug() {
  card_->replug();
}

void XdmaEmulator::stall(bool stalled) {
  card_->stall(stalled);
}

std::string XdmaEmulator::mount_error() {
  static const std::string error = try_to_mount();
  return error;
}

bool XdmaEmulator::can_mount() {
  return mount_error().empty();
}

}  // namespace wobblebench::hw
