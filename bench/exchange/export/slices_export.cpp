// The slices of pass 1: each a picture of one image plane, before the volume is rendered.
#include <cmath>

#include "base/units.h"
#include "bench/exchange/export/writers.h"
#include "bench/exchange/files/npz_file.h"
#include "render/geometry/slice_geometry.h"

namespace wobblebench::bench {

namespace {

class SlicesWriter : public ScanWriter {
 public:
  SlicesWriter(const std::filesystem::path& path, const ExportedScan& scan)
      : file_(path), scan_(scan) {}

  void add(const hw::PolarVolume& volume) override { volume_ = volume.volume_index(); }

  void finish(const ExportedPicture* picture) override {
    const render::VolumeSlices& made = picture->slices;
    write_samples(made);
    write_positions(made);
    file_.number("volume", volume_);
    file_.texts("source", {scan_.simulated ? "simulated" : "recording of hardware"});
    file_.finish();
  }

 private:
  void write_samples(const render::VolumeSlices& made) {
    const auto count = [](auto number) { return static_cast<std::uint64_t>(number); };
    file_.begin("slices",
                kNumpyType<float>,
                {count(made.slices.size()), count(made.pixels.rows), count(made.pixels.columns)});
    for (const Image<float>& slice : made.slices) {
      const auto bytes = std::as_bytes(std::span(slice.pixels));
      file_.append({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    file_.end();
  }

  void write_positions(const render::VolumeSlices& made) {
    const hw::AcquisitionPlan& plan = scan_.plan();
    const render::RenderOptions& options = scan_.scene.render();
    const render::DenseFactors factors = render::dense_factors(plan, options);
    const render::SliceGeometry geometry(plan, options.scan_conversion.slice_size, factors);
    const hw::AcquisitionPlan dense = render::dense_plan(plan, factors);
    std::vector<double> x_mm, depth_mm, motor_deg;
    for (int column = 0; column < made.pixels.columns; ++column) {
      x_mm.push_back(geometry.pixel_x_m(made.pixels.column + column) / kMillimetre);
    }
    for (int row = 0; row < made.pixels.rows; ++row) {
      depth_mm.push_back(geometry.pixel_depth_m(made.pixels.row + row) / kMillimetre);
    }
    for (int frame = 0; frame < geometry.frames(); ++frame) {
      motor_deg.push_back(dense.frame_phi_rad(frame) / kDegree);
    }
    file_.array<double>("x_mm", {x_mm.size()}, x_mm);
    file_.array<double>("depth_mm", {depth_mm.size()}, depth_mm);
    file_.array<double>("motor_angle_deg", {motor_deg.size()}, motor_deg);
    file_.number("turn", geometry.frame_skew(made.sweep) * dense.phi_step_rad());
    file_.number("axis_mm", geometry.axis_z_m() / kMillimetre);
  }

  NpzFile file_;
  const ExportedScan& scan_;
  std::uint32_t volume_ = 0;
};

}  // namespace

std::unique_ptr<ScanWriter> make_slices_writer(const std::filesystem::path& path,
                                               const ExportedScan& scan) {
  return std::make_unique<SlicesWriter>(path, scan);
}

}  // namespace wobblebench::bench
