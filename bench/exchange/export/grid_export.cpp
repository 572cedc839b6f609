// Regular grids of samples or labels, as NRRD and MetaImage files.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/number_text.h"
#include "base/parallel.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/exchange/export/polar_sampler.h"
#include "bench/exchange/export/sample_grid.h"
#include "bench/exchange/export/writers.h"
#include "bench/exchange/files/dicom_volume.h"
#include "bench/exchange/files/meta_image.h"
#include "bench/exchange/files/nrrd.h"
#include "bench/exchange/files/out_file.h"
#include "bench/output/report_parts.h"
#include "hw/probe/beam_width.h"
#include "phantoms/label_finder.h"

namespace wobblebench::bench {

namespace {

using Fields = std::vector<std::pair<std::string, std::string>>;

constexpr double kMostVoxels = 2e9;
constexpr std::size_t kLongText = 64;  // characters of DICOM's Long String

/// Pixels of the image plane at rest: x along the array, depth from the centre of curvature.
SampleGrid plane_of(const hw::AcquisitionPlan& plan, double spacing_m) {
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const double far_m = plan.probe().radius_m + scan.depth_m, half_rad = 0.5 * scan.sector_rad;
  const double first = std::floor(plan.probe().radius_m * std::cos(half_rad) / spacing_m);
  const int columns = static_cast<int>(std::ceil(far_m * std::sin(half_rad) / spacing_m));
  const int rows = static_cast<int>(std::ceil(far_m / spacing_m) - first) + 1;
  return {{-columns * spacing_m, 0, first * spacing_m}, spacing_m, {2 * columns + 1, rows, 1}};
}

/// Samples, 0 to 1, in the file's type.
class SampleBytes {
 public:
  explicit SampleBytes(SampleType type) : type_(type) {}

  Element element() const {
    return type_ == SampleType::f32   ? Element::float32
           : type_ == SampleType::u16 ? Element::uint16
                                      : Element::uint8;
  }
  void write(std::span<const float> samples, OutFile& file) const {
    if (type_ == SampleType::f32) return file.write_values(samples);
    if (type_ == SampleType::u16)
      return file.write_values<std::uint16_t>(whole_numbers<std::uint16_t>(samples));
    file.write_values<std::uint8_t>(whole_numbers<std::uint8_t>(samples));
  }

 private:
  SampleType type_;
};

class GridWriter : public ScanWriter {
 public:
  GridWriter(ExportFormat format,
             const std::filesystem::path& path,
             const FileOptions& options,
             const ExportedScan& scan)
      : format_(format),
        content_(options.content),
        scan_(scan),
        samples_(options.type),
        grid_(content_ == Content::planes ? plane_of(scan.plan(), options.spacing_m)
                                          : grid_around(scan.plan(), options.spacing_m)),
        file_(path) {}

  void add(const hw::PolarVolume& volume) override {
    if (!first_) {
      first_ = volume.volume_index();
      begin(volume);
    }
    if (content_ == Content::polar) {
      write_polar(volume);
    } else if (content_ == Content::planes) {
      write_planes(volume);
    } else if (content_ == Content::labels) {
      write_labels([&] {
        return [this, volume = volume.volume_index()](const glm::dvec3& point_m) {
          return scan_.labels.value().at(point_m, volume);
        };
      });
    } else if (content_ == Content::parts) {
      const TissueLabels& known = scan_.labels.value();
      const phantoms::LabelFinder finder(known.subject().phantom);
      write_labels([&] {
        return [finder, &known, volume = volume.volume_index()](const glm::dvec3& point_m) {
          return finder.at(known.to_rest(point_m, volume));
        };
      });
    } else {
      write_grid(volume);
    }
  }

  void finish(const ExportedPicture*) override { file_.finish(); }

 private:
  std::uint64_t frames() const {
    return static_cast<std::uint64_t>(scan_.plan().acquisition().frames_per_volume);
  }
  Element element() const { return has_labels(content_) ? Element::uint8 : samples_.element(); }

  void begin(const hw::PolarVolume& volume) {
    if (format_ == ExportFormat::meta_image) {
      file_.write(meta_text(volume));
    } else {
      file_.write(nrrd_header_text());
    }
  }

  Fields fields() const {
    Fields fields = scan_.fields();
    fields.emplace_back("wobblebench_content",
                        content_ == Content::polar       ? "polar"
                        : content_ == Content::planes    ? "planes"
                        : content_ == Content::cartesian ? "cartesian"
                        : content_ == Content::parts     ? "parts"
                                                         : "labels");
    if (content_ == Content::planes || content_ == Content::cartesian) {
      // So that they come back as the sticks that they were made of.
      const hw::AcquisitionOptions& a = scan_.plan().acquisition();
      fields.emplace_back("wobblebench_lines", std::to_string(a.sticks_per_frame));
      fields.emplace_back("wobblebench_samples", std::to_string(a.samples_per_stick));
    }
    if (content_ == Content::cartesian) {
      fields.emplace_back("wobblebench_frames", std::to_string(frames()));
    }
    const auto add_name = [&](int label, const std::string& name) {
      fields.emplace_back("wobblebench_label_" + std::to_string(label), name);
    };
    if (content_ == Content::labels) {
      const auto& names = scan_.labels.value().names();
      for (std::size_t i = 0; i < names.size(); ++i) add_name(static_cast<int>(i), names[i]);
    } else if (content_ == Content::parts) {
      for (const auto& [label, name] : phantoms::label_names(scan_.labels->subject().phantom)) {
        add_name(label, name);
      }
    }
    return fields;
  }

  std::vector<std::uint64_t> polar_sizes() const {
    const hw::AcquisitionOptions& a = scan_.plan().acquisition();
    return {static_cast<std::uint64_t>(a.samples_per_stick),
            static_cast<std::uint64_t>(a.sticks_per_frame),
            frames()};
  }

  std::string nrrd_header_text() const {
    const bool polar = content_ == Content::polar;
    NrrdHeader header{.element = element(),
                      .sizes = polar ? polar_sizes() : grid_.sizes(),
                      .kinds = {"domain", "domain", "domain"},
                      .fields = fields()};
    header.labels = polar ? std::vector<std::string>{"sample", "line", "frame"}
                          : std::vector<std::string>{"x", "y", "z"};
    if (!polar) {
      const double step_mm = grid_.spacing_m / kMillimetre;
      header.directions_mm = {
          glm::dvec3(step_mm, 0, 0), glm::dvec3(0, step_mm, 0), glm::dvec3(0, 0, step_mm)};
      header.origin_mm = grid_.low_m / kMillimetre;
    }
    if (format_ == ExportFormat::nrrd_sequence) add_time_axis(header);
    return nrrd_text(header);
  }

  /// As 3D Slicer has it: the last axis, with the times of the volumes, or else their numbers.
  void add_time_axis(NrrdHeader& header) const {
    header.sizes.push_back(scan_.volumes);
    header.kinds.emplace_back("list");
    header.labels.emplace_back(scan_.knows_times ? "time_s" : "volume");
    if (!header.directions_mm.empty()) header.directions_mm.emplace_back();
    std::string times;
    for (std::uint32_t v = 0; v < scan_.volumes; ++v) {
      const double at =
          scan_.knows_times ? volume_time_s(scan_.plan(), first_.value(), first_.value() + v) : v;
      times.append(v > 0 ? " " : "").append(significant(at, 12));
    }
    header.fields.emplace_back("axis 3 index type", "numeric");
    header.fields.emplace_back("axis 3 index values", times);
  }

  std::string meta_text(const hw::PolarVolume& volume) const {
    MetaHeader header{.element = element(), .fields = {}};
    const double step_mm = grid_.spacing_m / kMillimetre;
    if (content_ == Content::cartesian || has_labels(content_)) {
      header.sizes = grid_.sizes();
      header.spacing = {step_mm, step_mm, step_mm};
      header.origin_mm = grid_.low_m / kMillimetre;
      header.fields = fields();
      return meta_image_text(header);
    }
    const bool planes = content_ == Content::planes;
    header.sizes = planes ? grid_.sizes() : polar_sizes();
    header.sizes[2] = scan_.volumes * frames();
    header.spacing =
        planes ? std::vector<double>{step_mm, step_mm, 1.0} : std::vector<double>{1.0, 1.0, 1.0};
    header.fields = {{"Kinds", "domain domain list"},
                     {"UltrasoundImageOrientation", planes ? "MF" : "FM"},
                     {"UltrasoundImageType", "BRIGHTNESS"}};
    for (auto& field : fields()) header.fields.push_back(std::move(field));
    if (planes) {
      header.fields.emplace_back("wobblebench_center_px",
                                 significant(-grid_.low_m.x / grid_.spacing_m, 12) + " " +
                                     significant(-grid_.low_m.z / grid_.spacing_m, 12));
    }
    header.fields.emplace_back("wobblebench_frames_per_volume", std::to_string(frames()));
    add_frame_fields(header.fields, volume);
    return meta_image_text(header);
  }

  /// Time, status and pose of each frame. The motor angles of later volumes are taken from the
  /// first: headers are written before they come.
  void add_frame_fields(Fields& all, const hw::PolarVolume& volume) const {
    std::size_t number = 0;
    for (std::uint32_t v = 0; v < scan_.volumes; ++v) {
      const std::uint32_t index = first_.value() + v;
      for (int frame = 0; frame < scan_.plan().acquisition().frames_per_volume; ++frame) {
        const double phi_rad = mean_motor_angle_rad(volume.frame(frame));
        const auto add = [&](const std::string& name, const std::string& value) {
          all.emplace_back(frame_field(number, name), value);
        };
        if (scan_.knows_times) {
          add("Timestamp", fixed(frame_time_s(scan_.plan(), first_.value(), index, frame), 9));
        }
        add("ImageStatus", "OK");
        add("MotorAngleDeg", significant(phi_rad / kDegree, 12));
        if (content_ == Content::planes) {
          add("ImageToReferenceTransform", pose_text(phi_rad));
          add("ImageToReferenceTransformStatus", "OK");
        }
        ++number;
      }
    }
  }

  /// From pixels of the frame to the probe frame, mm: 4 x 4, row by row, points as columns.
  std::string pose_text(double phi_rad) const {
    const double b_mm = scan_.plan().geometry().axis_z_m() / kMillimetre;
    const double step = grid_.spacing_m / kMillimetre;
    const double sine = std::sin(phi_rad), cosine = std::cos(phi_rad);
    const glm::dvec3 low = grid_.low_m / kMillimetre;
    const double arm = low.z - b_mm;  // of the first row, from the wobble axis
    std::string text;
    for (const double number : {step,
                                0.0,
                                0.0,
                                low.x,
                                0.0,
                                -step * sine,
                                -step * cosine,
                                -arm * sine,
                                0.0,
                                step * cosine,
                                -step * sine,
                                b_mm + arm * cosine,
                                0.0,
                                0.0,
                                0.0,
                                1.0}) {
      text.append(text.empty() ? "" : " ").append(significant(number, 12));
    }
    return text;
  }

  void write_polar(const hw::PolarVolume& volume) {
    for (const hw::PolarFrame& frame : volume.frames()) samples_.write(frame.samples, file_);
  }

  void write_planes(const hw::PolarVolume& volume) {
    const PolarSampler sampler(volume);
    const auto columns = static_cast<std::size_t>(grid_.size.x);
    std::vector<float> picture(columns * static_cast<std::size_t>(grid_.size.y));
    for (int frame = 0; frame < scan_.plan().acquisition().frames_per_volume; ++frame) {
      parallel_rows(grid_.size.y, [&](int row) {
        const double depth_m = grid_.low_m.z + row * grid_.spacing_m;
        for (std::size_t column = 0; column < columns; ++column) {
          const double x_m = grid_.low_m.x + static_cast<double>(column) * grid_.spacing_m;
          const auto sample =
              sampler.in_frame(frame, std::hypot(x_m, depth_m), std::atan2(x_m, depth_m));
          picture[static_cast<std::size_t>(row) * columns + column] =
              static_cast<float>(sample.value_or(0));
        }
      });
      samples_.write(picture, file_);
    }
  }

  void write_grid(const hw::PolarVolume& volume) {
    const PolarSampler sampler(volume);
    std::vector<float> slice(slice_size());
    for (int z = 0; z < grid_.size.z; ++z) {
      each_of_slice(z, [&](std::size_t i, const glm::dvec3& point_m) {
        slice[i] = static_cast<float>(sampler.at(point_m).value_or(0));
      });
      samples_.write(slice, file_);
    }
  }

  /// `make_label`: makes what gives the label of a point, for one thread.
  template <class MakeLabel>
  void write_labels(const MakeLabel& make_label) {
    std::vector<std::uint8_t> slice(slice_size());
    const auto columns = static_cast<std::size_t>(grid_.size.x);
    for (int z = 0; z < grid_.size.z; ++z) {
      parallel_rows(grid_.size.y, [&](int y) {
        const auto label = make_label();
        for (int x = 0; x < grid_.size.x; ++x) {
          slice[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)] =
              label(grid_.point_m(x, y, z));
        }
      });
      file_.write_values<std::uint8_t>(slice);
    }
  }

  std::size_t slice_size() const {
    return static_cast<std::size_t>(grid_.size.x) * static_cast<std::size_t>(grid_.size.y);
  }
  template <class Body>
  void each_of_slice(int z, const Body& body) const {
    parallel_rows(grid_.size.y, [&](int y) {
      for (int x = 0; x < grid_.size.x; ++x) {
        body(static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.size.x) +
                 static_cast<std::size_t>(x),
             grid_.point_m(x, y, z));
      }
    });
  }

  ExportFormat format_;
  Content content_;
  const ExportedScan& scan_;
  SampleBytes samples_;
  SampleGrid grid_;
  OutFile file_;
  std::optional<std::uint32_t> first_;  ///< volume that was exported first
};

/// The same grid as one DICOM file, which is made when all of it is there.
class DicomWriter : public ScanWriter {
 public:
  DicomWriter(const std::filesystem::path& path,
              const FileOptions& options,
              const ExportedScan& scan)
      : path_(path), grid_(grid_around(scan.plan(), options.spacing_m)), scan_(scan) {}

  void add(const hw::PolarVolume& volume) override {
    const PolarSampler sampler(volume);
    const auto sizes = grid_.sizes();
    voxels_.resize(sizes[0] * sizes[1] * sizes[2]);
    parallel_rows(grid_.size.z, [&](int z) {
      auto* voxel = voxels_.data() + static_cast<std::size_t>(z) * sizes[0] * sizes[1];
      for (int y = 0; y < grid_.size.y; ++y) {
        for (int x = 0; x < grid_.size.x; ++x) {
          const auto sample = static_cast<float>(sampler.at(grid_.point_m(x, y, z)).value_or(0));
          *voxel++ = static_cast<std::uint8_t>(std::lround(255 * std::clamp<double>(sample, 0, 1)));
        }
      }
    });
  }

  void finish(const ExportedPicture*) override {
    const hw::AcquisitionPlan& plan = scan_.plan();
    DicomVolume volume{.columns = static_cast<std::uint16_t>(grid_.size.x),
                       .rows = static_cast<std::uint16_t>(grid_.size.y),
                       .planes = static_cast<std::uint32_t>(grid_.size.z),
                       .spacing_mm = grid_.spacing_m / kMillimetre,
                       .origin_mm = grid_.low_m / kMillimetre,
                       .face_mm = plan.probe().radius_m / kMillimetre,
                       .depth_mm = plan.acquisition().depth_m / kMillimetre,
                       .focus_mm = hw::knows_array(plan.probe())
                                       ? plan.probe().transmit_focus_m / kMillimetre
                                       : 0};
    volume.duration_ms = scan_.knows_times ? 1e3 * volume_time_s(plan, 0, 1) : 0;
    volume.patient = scan_.simulated ? "SIMULATED^WOBBLEBENCH" : "UNKNOWN^WOBBLEBENCH";
    volume.description = scan_.simulated ? "SIMULATED by wobblebench" : "recording of hardware";
    const std::string version = version_line("wobblebench");
    volume.version = version.substr(0, std::min<std::size_t>(version.find('\n'), kLongText));
    volume.uid_root = "2.25." + std::to_string(content_hash());
    volume.voxels = std::move(voxels_);
    write_dicom_volume(path_, volume);
  }

 private:
  /// Equal content has equal identifiers.
  std::uint64_t content_hash() const {
    std::uint64_t hash = 1469598103934665603U;  // FNV-1a
    for (const std::uint8_t voxel : voxels_) hash = (hash ^ voxel) * 1099511628211U;
    return hash;
  }

  std::filesystem::path path_;
  SampleGrid grid_;
  const ExportedScan& scan_;
  std::vector<std::uint8_t> voxels_;
};

}  // namespace

void check_grid(const std::string& name,
                const FileOptions& options,
                const hw::AcquisitionPlan& plan) {
  if (!has_spacing(options.content)) return;
  const SampleGrid grid = options.content == Content::planes ? plane_of(plan, options.spacing_m)
                                                             : grid_around(plan, options.spacing_m);
  const double voxels = grid.voxels();
  if (voxels <= kMostVoxels) return;
  throw UserError("--to = " + name +
                  ": spacing_mm = " + significant(options.spacing_m / kMillimetre, 4) +
                  ": the grid has " + significant(voxels, 4) + " voxels; must have at most 2e9");
}

std::unique_ptr<ScanWriter> make_grid_writer(ExportFormat format,
                                             const std::filesystem::path& path,
                                             const FileOptions& options,
                                             const ExportedScan& scan) {
  if (format == ExportFormat::dicom) return std::make_unique<DicomWriter>(path, options, scan);
  return std::make_unique<GridWriter>(format, path, options, scan);
}

}  // namespace wobblebench::bench
