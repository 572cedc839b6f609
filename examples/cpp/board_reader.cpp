// Reads a recording or a card, and says of each volume how many sticks came and how bright they
// are. Links the board's library alone: find_package(wobblebench COMPONENTS hw).
//
//   board_reader out/recording.wbst
//   board_reader /dev/xdma0_c2h_0
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>

#include "wobblebench/hw/board/board.h"
#include "wobblebench/hw/board/volume_assembly.h"
#include "wobblebench/hw/link/xdma_link.h"
#include "wobblebench/hw/recording/file_link.h"

namespace {

using namespace wobblebench;

std::unique_ptr<hw::Link> open_link(const std::filesystem::path& path) {
  if (std::filesystem::is_regular_file(path)) return std::make_unique<hw::FileLink>(path);
  return std::make_unique<hw::XdmaLink>(path);
}

float brightest(const hw::PolarVolume& volume) {
  float most = 0;
  for (const hw::PolarFrame& frame : volume.frames()) {
    most = std::max(most, *std::max_element(frame.samples.begin(), frame.samples.end()));
  }
  return most;
}

void read(const std::filesystem::path& path) {
  hw::Board board(open_link(path));
  board.start();
  hw::VolumeAssembly assembly(board);
  while (const auto volume = assembly.next(hw::HostTime::max())) {
    const int all = volume->plan().sticks_per_volume();
    std::printf("volume %u: %d of %d sticks, brightest sample %.3f\n",
                volume->volume_index(),
                all - volume->missing_sticks(),
                all,
                static_cast<double>(brightest(*volume)));
  }
  std::printf("%llu sticks lost\n", static_cast<unsigned long long>(board.account().lost.total()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "board_reader RECORDING|DEVICE\n");
    return 2;
  }
  try {
    read(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "board_reader: %s\n", error.what());
    return 1;
  }
}
