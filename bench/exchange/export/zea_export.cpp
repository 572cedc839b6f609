// HDF5 files for zea: the scan on its own polar grid, with a position for each sample.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/units.h"
#include "bench/exchange/export/writers.h"
#include "bench/exchange/files/hdf5_maps.h"

namespace wobblebench::bench {

namespace {

/// zea's axes: volumes, z, x, y. Here z are the samples of a stick, x the lines and y the frames.
class ZeaWriter : public ScanWriter {
 public:
  ZeaWriter(const std::filesystem::path& path, const ExportedScan& scan)
      : scan_(scan), file_(make_hdf5_maps(path, attributes(scan))) {
    const bool known = scan.display_scale.knows_range();
    add_map("image",
            known ? MapType::f32 : MapType::u8,
            known ? "dB" : "-",
            known ? "log-compressed echoes; 0 dB is white" : "log-compressed echoes");
    if (!scan_.labels) return;
    for (std::size_t i = 0; i < scan_.labels->names().size(); ++i) {
      if (is_used(static_cast<phantoms::MaterialIndex>(i))) used_.push_back(i);
    }
    add_map("segmentation", MapType::boolean, "-", "true material of each sample", used_names());
    add_map("sos_map", MapType::f32, "m/s", "true speed of sound");
    add_map("attenuation_map", MapType::f32, "dB/cm/MHz", "true attenuation, one way");
  }

  void add(const hw::PolarVolume& volume) override {
    write_coordinates(volume);
    write_image(volume);
    if (scan_.labels) write_truth(volume);
    ++written_;
  }
  void finish(const ExportedPicture*) override { file_->finish(); }

 private:
  static std::vector<std::pair<std::string, std::string>> attributes(const ExportedScan& scan) {
    std::string description =
        scan.simulated ? "SIMULATED by wobblebench;" : "exported by wobblebench;";
    auto fields = scan.fields();
    fields.emplace_back("wobblebench_content", "polar");
    for (const auto& [key, value] : fields) {
      description.append(" ").append(key).append(" ").append(value).append(";");
    }
    return {{"probe_name", "wobbling curvilinear"},
            {"us_machine", scan.simulated ? "wobblebench, simulated" : "unknown"},
            {"description", description}};
  }

  std::uint64_t samples() const { return size(scan_.plan().acquisition().samples_per_stick); }
  std::uint64_t lines() const { return size(scan_.plan().acquisition().sticks_per_frame); }
  std::uint64_t frames() const { return size(scan_.plan().acquisition().frames_per_volume); }
  static std::uint64_t size(int count) { return static_cast<std::uint64_t>(count); }

  bool is_used(phantoms::MaterialIndex index) const {
    const auto& phantom = scan_.scene.subject().value().phantom;
    return index == phantom.background() ||
           std::ranges::any_of(phantom.surfaces(),
                               [&](const auto& surface) { return surface.inside == index; });
  }
  std::vector<std::string> used_names() const {
    std::vector<std::string> names;
    for (const std::size_t i : used_) names.push_back(scan_.labels.value().names()[i]);
    return names;
  }

  void add_map(const std::string& name,
               MapType type,
               const std::string& unit,
               const std::string& description,
               const std::vector<std::string>& labels = {}) {
    std::vector<std::uint64_t> shape = {scan_.volumes, samples(), lines(), frames()};
    // Motor angles may differ from volume to volume.
    std::vector<std::uint64_t> coordinates = {samples(), lines(), frames(), 3};
    if (scan_.volumes > 1) coordinates.insert(coordinates.begin(), scan_.volumes);
    if (!labels.empty()) shape.push_back(labels.size());
    file_->add_map({.name = name,
                    .type = type,
                    .shape = shape,
                    .coordinates_shape = coordinates,
                    .labels = labels,
                    .unit = unit,
                    .description = description});
    names_.push_back(name);
  }

  /// body(index among samples, lines and frames, frame, line, sample).
  template <class Body>
  void each(const Body& body) const {
    parallel_rows(static_cast<int>(samples()), [&](int k) {
      std::uint64_t i = size(k) * lines() * frames();
      for (int line = 0; line < static_cast<int>(lines()); ++line) {
        for (int frame = 0; frame < static_cast<int>(frames()); ++frame) body(i++, frame, line, k);
      }
    });
  }

  void write_coordinates(const hw::PolarVolume& volume) {
    const hw::AcquisitionPlan& plan = scan_.plan();
    const hw::ProbeGeometry geometry = plan.geometry();
    position_m_.resize(samples() * lines() * frames());
    std::vector<float> flat(3 * position_m_.size());
    each([&](std::uint64_t i, int frame, int line, int k) {
      position_m_[i] =
          geometry.to_cartesian({.range_m = plan.sample_range_m(k),
                                 .theta_rad = plan.theta_rad(line),
                                 .phi_rad = volume.frame(frame).motor_angle_rad[size(line)]});
      for (int axis = 0; axis < 3; ++axis) {
        flat[3 * i + size(axis)] = static_cast<float>(position_m_[i][axis]);
      }
    });
    if (written_ > 0 && scan_.volumes == 1) return;
    for (const auto& name : names_) file_->write_coordinates(name, written_, flat);
  }

  void write_image(const hw::PolarVolume& volume) {
    const bool known = scan_.display_scale.knows_range();
    std::vector<float> db(position_m_.size());
    std::vector<std::uint8_t> grey(position_m_.size());
    each([&](std::uint64_t i, int frame, int line, int k) {
      const double sample =
          std::clamp<double>(volume.frame(frame).samples[size(line) * samples() + size(k)], 0, 1);
      db[i] = static_cast<float>((sample - 1) * scan_.display_scale.dynamic_range_db);
      grey[i] = static_cast<std::uint8_t>(std::lround(255 * sample));
    });
    file_->write_values(
        "image", written_, known ? static_cast<const void*>(db.data()) : grey.data());
  }

  void write_truth(const hw::PolarVolume& volume) {
    const auto& materials = scan_.scene.subject().value().phantom.materials();
    std::vector<std::uint8_t> segments(position_m_.size() * used_.size(), 0);
    std::vector<float> speed(position_m_.size()), attenuation(position_m_.size());
    each([&](std::uint64_t i, int, int, int) {
      const std::size_t label = scan_.labels->at(position_m_[i], volume.volume_index());
      const auto place = std::ranges::find(used_, label) - used_.begin();
      if (static_cast<std::size_t>(place) < used_.size()) {
        segments[i * used_.size() + static_cast<std::size_t>(place)] = 1;
      }
      speed[i] = static_cast<float>(materials[label].sound_speed_m_s);
      attenuation[i] = static_cast<float>(materials[label].attenuation_db_per_cm_mhz);
    });
    file_->write_values("segmentation", written_, segments.data());
    file_->write_values("sos_map", written_, speed.data());
    file_->write_values("attenuation_map", written_, attenuation.data());
  }

  const ExportedScan& scan_;
  std::unique_ptr<Hdf5Maps> file_;
  std::vector<std::string> names_;
  std::vector<std::size_t> used_;  ///< labels that the phantom has
  std::uint64_t written_ = 0;
  std::vector<glm::dvec3> position_m_;
};

}  // namespace

std::unique_ptr<ScanWriter> make_zea_writer(const std::filesystem::path& path,
                                            const FileOptions&,
                                            const ExportedScan& scan) {
  return std::make_unique<ZeaWriter>(path, scan);
}

}  // namespace wobblebench::bench
