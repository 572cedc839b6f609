#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

#include "base/parallel.h"
#include "base/units.h"
#include "bench/exchange/export/writers.h"
#include "bench/exchange/files/npz_file.h"

namespace wobblebench::bench {

namespace {

using Shape = std::vector<std::uint64_t>;

std::vector<float> in_mm(const Image<float>& depth_m) {
  std::vector<float> mm(depth_m.pixels.size());
  std::ranges::transform(depth_m.pixels, mm.begin(), [](float m) {
    return static_cast<float>(double{m} / kMillimetre);
  });
  return mm;
}

/// Samples of all volumes as they come, then what is small.
class NpzWriter : public ScanWriter {
 public:
  NpzWriter(const std::filesystem::path& path, const FileOptions& options, const ExportedScan& scan)
      : file_(path), scan_(scan), everything_(options.content == Content::everything) {
    file_.begin("samples", kNumpyType<float>, shape(scan.volumes));
  }

  void add(const hw::PolarVolume& volume) override {
    if (index_.empty()) first_ = volume.volume_index();
    index_.push_back(volume.volume_index());
    for (int f = 0; f < scan_.plan().acquisition().frames_per_volume; ++f) {
      const hw::PolarFrame& frame = volume.frame(f);
      const auto bytes = std::as_bytes(std::span(frame.samples));
      file_.append({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      arrived_.insert(arrived_.end(), frame.arrived.begin(), frame.arrived.end());
      for (const double angle : frame.motor_angle_rad) motor_deg_.push_back(angle / kDegree);
      add_times(volume.volume_index(), f);
    }
  }

  void finish(const ExportedPicture* picture) override {
    file_.end();
    write_geometry();
    if (scan_.labels) write_labels();
    if (picture != nullptr && everything_) write_picture(*picture);
    file_.finish();
  }

 private:
  Shape shape(std::uint64_t volumes) const {
    const hw::AcquisitionOptions& a = scan_.plan().acquisition();
    return {volumes,
            static_cast<std::uint64_t>(a.frames_per_volume),
            static_cast<std::uint64_t>(a.sticks_per_frame),
            static_cast<std::uint64_t>(a.samples_per_stick)};
  }

  void add_times(std::uint32_t volume, int frame) {
    const hw::AcquisitionPlan& plan = scan_.plan();
    for (int line = 0; line < plan.acquisition().sticks_per_frame; ++line) {
      const auto sequence = plan.sequence(
          {volume, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)});
      const auto since = plan.stick_time(sequence) - plan.stick_time(plan.first_sequence(first_));
      const double since_s = std::chrono::duration<double>(since).count();
      time_s_.push_back(scan_.knows_times ? since_s : std::nan(""));
    }
  }

  void write_geometry() {
    const hw::AcquisitionPlan& plan = scan_.plan();
    const Shape all = shape(scan_.volumes);
    const Shape sticks(all.begin(), all.end() - 1);
    std::vector<double> theta_deg, range_mm;
    for (std::uint64_t l = 0; l < all[2]; ++l) {
      theta_deg.push_back(plan.theta_rad(static_cast<int>(l)) / kDegree);
    }
    for (std::uint64_t k = 0; k < all[3]; ++k) {
      range_mm.push_back(plan.sample_range_m(static_cast<int>(k)) / kMillimetre);
    }
    file_.array<double>("theta_deg", {all[2]}, theta_deg);
    file_.array<double>("range_mm", {all[3]}, range_mm);
    file_.array<double>("motor_angle_deg", sticks, motor_deg_);
    file_.array<double>("time_s", sticks, time_s_);
    file_.array<std::uint8_t>("arrived", sticks, arrived_);
    file_.array<std::int64_t>("volume", {scan_.volumes}, index_);
    file_.number("radius_mm", plan.probe().radius_m / kMillimetre);
    file_.number("wobble_radius_mm", plan.probe().wobble_radius_m / kMillimetre);
    const auto& scale = scan_.display_scale;
    const auto known = [](bool is, double value) { return is ? value : std::nan(""); };
    file_.number("full_scale_db", known(scale.stated(), scale.full_scale_db));
    file_.number("dynamic_range_db", known(scale.knows_range(), scale.dynamic_range_db));
    file_.number("tgc_db_per_cm_mhz", known(scale.stated(), scale.tgc_db_per_cm_mhz));
    file_.texts("source", {scan_.simulated ? "simulated" : "recording of hardware"});
  }

  /// Of each sample, at the time of its stick.
  void write_labels() {
    const hw::AcquisitionPlan& plan = scan_.plan();
    const hw::ProbeGeometry geometry = plan.geometry();
    const Shape all = shape(scan_.volumes);
    const std::uint64_t samples = all[3], sticks = all[1] * all[2];
    file_.begin("labels", kNumpyType<std::uint8_t>, all);
    std::vector<std::uint8_t> labels(sticks * samples);
    for (std::uint64_t v = 0; v < scan_.volumes; ++v) {
      parallel_rows(static_cast<int>(sticks), [&](int stick) {
        const auto i = static_cast<std::uint64_t>(stick);
        const int line = static_cast<int>(i % all[2]);
        const auto frame = static_cast<std::uint32_t>(i / all[2]);
        const hw::StickIndex index{
            static_cast<std::uint32_t>(index_[v]), frame, static_cast<std::uint32_t>(line)};
        const hw::Ray ray =
            geometry.stick(plan.theta_rad(line), motor_deg_[v * sticks + i] * kDegree);
        const double time_s =
            std::chrono::duration<double>(plan.stick_time(plan.sequence(index)) - hw::DeviceTime())
                .count();
        for (std::uint64_t k = 0; k < samples; ++k) {
          const auto at = ray.at(plan.sample_range_m(static_cast<int>(k)));
          labels[i * samples + k] = scan_.labels->at_time(at, time_s);
        }
      });
      file_.append({reinterpret_cast<const char*>(labels.data()), labels.size()});
    }
    file_.end();
    file_.texts("label_names", scan_.labels->names());
  }

  void write_picture(const ExportedPicture& shown) {
    const render::Camera& camera = scan_.scene.view().camera;
    const auto side = static_cast<std::uint64_t>(camera.image_size);
    std::vector<double> origin_mm, direction;
    for (int row = 0; row < camera.image_size; ++row) {
      for (int column = 0; column < camera.image_size; ++column) {
        const hw::Ray ray = camera.ray(column, row);
        for (int i = 0; i < 3; ++i) {
          origin_mm.push_back(ray.origin[i] / kMillimetre);
          direction.push_back(ray.direction[i]);
        }
      }
    }
    file_.array<double>("ray_origin_mm", {side, side, 3}, origin_mm);
    file_.array<double>("ray_direction", {side, side, 3}, direction);
    file_.array<float>("found_depth_mm", {side, side}, in_mm(shown.picture.depth_m));
    if (!shown.truth) return;
    file_.array<float>("truth_depth_mm", {side, side}, in_mm(shown.truth->depth_m));
    std::vector<std::uint8_t> reason;
    for (const TruthKind kind : shown.truth->kind.pixels) {
      reason.push_back(static_cast<std::uint8_t>(kind));
    }
    file_.array<std::uint8_t>("truth_reason", {side, side}, reason);
  }

  NpzFile file_;
  const ExportedScan& scan_;
  bool everything_;
  std::uint32_t first_ = 0;
  std::vector<std::int64_t> index_;
  std::vector<double> motor_deg_, time_s_;
  std::vector<std::uint8_t> arrived_;
};

}  // namespace

std::unique_ptr<ScanWriter> make_npz_writer(const std::filesystem::path& path,
                                            const FileOptions& options,
                                            const ExportedScan& scan) {
  return std::make_unique<NpzWriter>(path, options, scan);
}

}  // namespace wobblebench::bench
