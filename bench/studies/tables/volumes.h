// The volumes that the tables render: one for each number of frames.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hw/link/link.h"
#include "hw/probe/motor_deviation.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

struct TableVolumes {
  std::map<int, hw::PolarVolume> by_frames;
  std::string board;                 ///< origin of the sticks
  std::vector<std::string> effects;  ///< effects of the simulator that made them
  hw::MotorDeviation motor;          ///< of the reference row, where it was recorded
  bool knows_times = true;           ///< of its sticks
  std::string note;                  ///< how they differ from what the rows ask for; a sentence
};

/// The `count` middle frames of a volume as a volume of their own, whose fan is narrower in
/// proportion. Where an odd number of frames is left out, the fan's middle moves by half a frame.
/// `count` is 2 at least, and the volume's frames at most.
hw::PolarVolume middle_frames(const hw::PolarVolume& volume, int count);

/// Volumes from the first whole volume of the link. `board`: what the user wrote, for messages.
/// Throws UserError where the volume has fewer frames than the tables need or is incomplete at the
/// end of the stream, or there is none.
TableVolumes recorded_volumes(std::unique_ptr<hw::Link> link, const std::string& board);

}  // namespace wobblebench::bench
