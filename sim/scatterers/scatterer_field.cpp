#include "sim/scatterers/scatterer_field.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sim/scatterers/hash_cell_queue.h"
#include "sim/scatterers/stick_scan.h"

namespace wobblebench::sim {

namespace {

/// Scatterers of one octave within one parcel, in double precision.
class ParcelSearch {
 public:
  ParcelSearch(const ScattererScene& scene,
               const StickView& view,
               const Sightline& line,
               double to_m)
      : scene_(scene), view_(view), line_(line), to_m_(to_m) {}

  void collect(const TissueParcels::Parcel& parcel,
               int octave,
               std::vector<PointEcho>& found) const {
    const Octave& process = scene_.cells.octaves[static_cast<std::size_t>(octave)];
    const std::uint32_t parcel_key = process.parcel_key(parcel.index);
    const double cell_m = scene_.parcels.side_m() / process.divisions;
    const glm::dvec3 corner =
        scene_.parcels.origin_m() + scene_.parcels.side_m() * glm::dvec3(parcel.index);
    for (int number = 0; number < process.cells(); ++number) {
      HashCell cell{octave, number};
      cell.key = hash_cell_key(parcel_key, static_cast<std::uint32_t>(number));
      cell.side_m = cell_m;
      cell.low_corner_m = corner + cell_m * cell_place(number, process.divisions);
      cell.row = scene_.table.row(view_.to_beam(cell.low_corner_m + 0.5 * cell_m).x);
      for (int i = 0; i < heard(cell).heard; ++i) take(parcel, cell, i, found);
    }
  }

 private:
  struct HashCell {
    int octave;
    int number;  ///< in its parcel
    std::uint32_t key = 0;
    double side_m = 0;
    glm::dvec3 low_corner_m{0};  ///< at rest
    int row = 0;                 ///< of the beam, at its middle
  };

  const OctaveAtRow& heard(const HashCell& cell) const {
    const auto row = static_cast<std::size_t>(cell.row);
    return scene_.gains[static_cast<std::size_t>(cell.octave)].rows[row];
  }

  void take(const TissueParcels::Parcel& parcel,
            const HashCell& cell,
            int scatterer,
            std::vector<PointEcho>& found) const {
    const glm::dvec3 rest =
        cell.low_corner_m +
        cell.side_m * scatterer_place(cell.key, static_cast<std::uint32_t>(scatterer));
    const glm::dvec3 beam = view_.to_beam(rest);
    if (!within_beam(beam, cell.row)) return;
    const glm::dvec3 ahead = view_.to_rest(beam + glm::dvec3(1e-4, 0, 0)) - rest;
    const float amplitude =
        heard(cell).amplitude(scatterer) *
        scene_.parcels.amplitude_at(
            parcel, cell.octave, cell.number, scatterer, glm::vec3(glm::normalize(ahead)));
    if (amplitude == 0) return;
    found.push_back({scene_.subject.from_rest(rest, line_.time_s), amplitude});
  }

  bool within_beam(const glm::dvec3& beam, int row) const {
    if (beam.x <= 0 || beam.x >= to_m_) return false;
    const double u = std::abs(beam.y) / scene_.table.reach_m(scene_.table.lateral(), row);
    const double v = std::abs(beam.z) / scene_.table.reach_m(scene_.table.elevation(), row);
    return (scene_.rim == BeamRim::ellipse ? std::hypot(u, v) : u + v) < 1;
  }

  const ScattererScene& scene_;
  const StickView& view_;
  const Sightline& line_;
  double to_m_;
};

}  // namespace

ScattererField::ScattererField(const ScannedTissue& subject,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options,
                               const ScattererModel& model)
    : scene_(std::make_shared<ScattererScene>(subject, plan, options, model)) {}

namespace {

/// Nothing in it outlives a stick but its size.
ScanBuffers& buffers_of_thread() {
  thread_local ScanBuffers buffers;
  return buffers;
}

}  // namespace

void ScattererField::add_echoes(const StickPath& way,
                                std::span<std::complex<float>> iq,
                                std::uint64_t* seen) const {
  if (way.left.empty()) return;
  const std::uint64_t found = StickScan(*scene_, way, buffers_of_thread()).run(iq);
  if (seen != nullptr) *seen += found;
}

void ScattererField::add_points(const StickPath& way,
                                std::span<const PointEcho> points,
                                std::span<std::complex<float>> iq) const {
  if (way.left.empty()) return;
  StickScan(*scene_, way, buffers_of_thread()).run(points, iq);
}

std::vector<PointEcho> ScattererField::near(const Sightline& line, double to_m) const {
  const StickView view(scene_->subject, line);
  std::vector<TouchedParcel> touched;
  find_touched(view, scene_->tube, scene_->lattice(), to_m, touched);
  const ParcelSearch search(*scene_, view, line, to_m);
  std::vector<PointEcho> found;
  for (const TouchedParcel& at : touched) {
    const TissueParcels::Parcel parcel = scene_->parcels.parcel(at.index);
    if (scene_->parcels.silent(parcel)) continue;
    for (int i = 0; i < static_cast<int>(scene_->cells.octaves.size()); ++i) {
      search.collect(parcel, i, found);
    }
  }
  return found;
}

double ScattererField::point_spread_m3(double range_m) const {
  return scene_->table.area_m2(scene_->table.row(range_m)) * scene_->pulse_m;
}

}  // namespace wobblebench::sim
