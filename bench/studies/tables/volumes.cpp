#include "bench/studies/tables/volumes.h"

#include <stdexcept>

#include "base/user_error.h"
#include "bench/pipeline/stream/stream.h"
#include "bench/studies/tables/paper.h"

namespace wobblebench::bench {

namespace {

hw::AcquisitionPlan narrowed(const hw::AcquisitionPlan& plan, int frames) {
  hw::AcquisitionOptions acquisition = plan.acquisition();
  acquisition.frames_per_volume = frames;
  acquisition.fan_rad = plan.phi_step_rad() * (frames - 1);
  return {plan.probe(), acquisition};
}

KeptVolume take_volume(std::unique_ptr<hw::Link> link, const std::string& board_text) {
  hw::Board board(std::move(link));
  const auto [configuration, before] = first_configuration(board, board_text);
  const StreamSource source{.board = board,
                            .plan = configuration.plan,
                            .name = board_text,
                            .configuration = configuration,
                            .before_configuration = before,
                            .dynamic_range_db = {}};
  NoRenderer none;
  const StreamResult result = stream_one_volume(source, none);
  const int missing = result.kept->volume.missing_sticks();
  if (!result.reader.ending.empty() && missing > 0) {
    throw UserError("--board = " + board_text + ": " + result.reader.ending + ": " +
                    std::to_string(missing) + " sticks of the volume are missing");
  }
  return *result.kept;
}

std::string note_of(const hw::PolarVolume& volume) {
  std::string note =
      "From one recorded volume: a row of fewer frames is rendered from its middle frames, over a "
      "fan that is narrower in proportion, where the paper spreads fewer frames over the same fan.";
  if (volume.missing_sticks() > 0) {
    note += " Sticks that are missing in it: " + std::to_string(volume.missing_sticks()) + ".";
  }
  return note;
}

}  // namespace

hw::PolarVolume middle_frames(const hw::PolarVolume& volume, int count) {
  const int all = static_cast<int>(volume.frames().size());
  if (count < 2 || count > all) {
    throw std::out_of_range(std::to_string(count) + " frames of a volume of " +
                            std::to_string(all));
  }
  hw::PolarVolume middle(narrowed(volume.plan(), count));
  const int first = (all - count) / 2;
  // By half a frame where an odd number of frames is left out.
  const double turn_rad = volume.plan().frame_phi_rad(first) - middle.plan().frame_phi_rad(0);
  for (int frame = 0; frame < count; ++frame) {
    hw::PolarFrame turned = volume.frame(first + frame);
    for (double& phi_rad : turned.motor_angle_rad) phi_rad -= turn_rad;
    middle.place_frame(frame, turned, volume.scale());
  }
  return middle;
}

TableVolumes recorded_volumes(std::unique_ptr<hw::Link> link, const std::string& board) {
  TableVolumes volumes;
  volumes.board = hw::to_string(link->capabilities().origin);
  const KeptVolume kept = [&] {
    try {
      return take_volume(std::move(link), board);
    } catch (const NothingCame& error) {
      throw UserError(error.what());
    }
  }();
  const hw::PolarVolume& volume = kept.volume;
  volumes.knows_times = kept.configuration.knows_times;
  const int frames = static_cast<int>(volume.frames().size());
  const int needed = reference_row().frames;
  if (frames < needed) {
    throw UserError("--board = " + board + ": has " + std::to_string(frames) +
                    " frames a volume; the tables need " + std::to_string(needed));
  }
  volumes.note = note_of(volume);
  for (const int count : frame_counts()) {
    volumes.by_frames.emplace(count, middle_frames(volume, count));
  }
  volumes.motor = hw::motor_deviation(volumes.by_frames.at(needed));
  return volumes;
}

}  // namespace wobblebench::bench
