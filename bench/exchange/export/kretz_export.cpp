// GE/Kretz volumes.
#include <algorithm>
#include <cmath>

#include "bench/exchange/export/writers.h"
#include "bench/exchange/files/kretz.h"
#include "bench/exchange/files/out_file.h"

namespace wobblebench::bench {

namespace {

class KretzWriter : public ScanWriter {
 public:
  KretzWriter(const std::filesystem::path& path, const ExportedScan& scan)
      : scan_(scan), file_(path) {}

  void add(const hw::PolarVolume& volume) override {
    file_.write(
        kretz_text(description(volume),
                   scan_.simulated ? "SIMULATED BY WOBBLEBENCH" : "EXPORTED BY WOBBLEBENCH"));
    std::vector<std::uint8_t> voxels;
    for (const hw::PolarFrame& frame : volume.frames()) {
      voxels.resize(frame.samples.size());
      std::ranges::transform(frame.samples, voxels.begin(), [](float sample) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp<double>(sample, 0, 1)));
      });
      file_.write_values<std::uint8_t>(voxels);
    }
  }
  void finish(const ExportedPicture*) override { file_.finish(); }

 private:
  KretzScan description(const hw::PolarVolume& volume) const {
    const hw::AcquisitionPlan& plan = scan_.plan();
    const hw::AcquisitionOptions& a = plan.acquisition();
    KretzScan kretz{.file = {.sizes = {static_cast<std::uint64_t>(a.samples_per_stick),
                                       static_cast<std::uint64_t>(a.sticks_per_frame),
                                       static_cast<std::uint64_t>(a.frames_per_volume)}},
                    .resolution_m = plan.sample_spacing_m(),
                    .first_m = plan.probe().radius_m + plan.sample_range_m(0),
                    .axis_m = plan.geometry().axis_z_m()};
    for (int line = 0; line < a.sticks_per_frame; ++line) {
      kretz.line_rad.push_back(plan.theta_rad(line));
    }
    for (const hw::PolarFrame& frame : volume.frames()) {
      kretz.frame_rad.push_back(mean_motor_angle_rad(frame));
    }
    return kretz;
  }

  const ExportedScan& scan_;
  OutFile file_;
};

}  // namespace

std::unique_ptr<ScanWriter> make_kretz_writer(const std::filesystem::path& path,
                                              const FileOptions&,
                                              const ExportedScan& scan) {
  return std::make_unique<KretzWriter>(path, scan);
}

}  // namespace wobblebench::bench
