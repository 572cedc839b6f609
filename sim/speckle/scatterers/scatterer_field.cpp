#include "sim/speckle/scatterers/scatterer_field.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <utility>

#include "sim/math/fast_math.h"
#include "sim/speckle/scatterers/scatterer_scene.h"
#include "sim/speckle/scatterers/stick_scan.h"

namespace wobblebench::sim {

namespace {

/// Searches the blocks for scatterers within a stick's beam, one by one, in double precision.
class ScattererSearch {
 public:
  ScattererSearch(const ScattererScene& scene,
                  const StickTransform& transform,
                  const TimedRay& line,
                  double to_m)
      : scene_(scene),
        beam_(scene.beam(line.ray)),
        transform_(transform),
        line_(line),
        to_m_(to_m) {}

  void collect(const TissueBlocks::Block& block, int octave, std::vector<PointEcho>& found) const {
    const Octave& octave_cells = scene_.cells.octaves[static_cast<std::size_t>(octave)];
    const std::uint32_t block_key = octave_cells.block_key(block.index);
    const double cell_m = scene_.blocks.side_m() / octave_cells.divisions;
    const glm::dvec3 corner =
        scene_.blocks.origin_m() + scene_.blocks.side_m() * glm::dvec3(block.index);
    for (int number = 0; number < octave_cells.cells(); ++number) {
      HashCell cell{octave, number};
      cell.key = hash_cell_key(block_key, static_cast<std::uint32_t>(number));
      cell.side_m = cell_m;
      cell.low_corner_m = corner + cell_m * cell_coordinates(number, octave_cells.divisions);
      const double center_m = transform_.to_beam(cell.low_corner_m + 0.5 * cell_m).x;
      cell.row = scene_.table.row(center_m);
      cell.within_m = within_row(
          static_cast<float>(center_m), static_cast<float>(scene_.table.rows_per_m()), cell.row);
      for (int i = 0; i < gain(cell).count; ++i) add(block, cell, i, found);
    }
  }

 private:
  struct HashCell {
    int octave;
    int number;  ///< in its block
    std::uint32_t key = 0;
    double side_m = 0;
    glm::dvec3 low_corner_m{0};  ///< at rest
    int row = 0;                 ///< of the beam's table, at its centre
    float within_m = 0;          ///< within_row() of its centre
  };

  const OctaveAtRow& gain(const HashCell& cell) const {
    const auto row = static_cast<std::size_t>(cell.row);
    return scene_.gains[static_cast<std::size_t>(cell.octave)].rows[row];
  }

  void add(const TissueBlocks::Block& block,
           const HashCell& cell,
           int scatterer,
           std::vector<PointEcho>& found) const {
    const glm::dvec3 rest =
        cell.low_corner_m +
        cell.side_m * scatterer_position(cell.key, static_cast<std::uint32_t>(scatterer));
    const glm::dvec3 beam = transform_.to_beam(rest);
    if (!within_beam(beam, cell)) return;
    const glm::dvec3 along = transform_.to_rest(beam + glm::dvec3(1e-4, 0, 0)) - rest;
    const ScattererEcho echo = scene_.blocks.echo_at(
        block, cell.octave, cell.number, scatterer, glm::vec3(glm::normalize(along)));
    const float amplitude =
        scatterer_sign(scatterer_bits(cell.key, static_cast<std::uint32_t>(scatterer))) *
        gain(cell).amplitude(scatterer) * echo.amplitude;
    if (amplitude == 0) return;
    found.push_back({scene_.tissue.from_rest(rest, line_.time_s), amplitude, echo.interface});
  }

  bool within_beam(const glm::dvec3& beam, const HashCell& cell) const {
    if (beam.x <= 0 || beam.x >= to_m_) return false;
    const BeamAtRow& at = beam_.rows[static_cast<std::size_t>(cell.row)];
    const double u = std::abs(beam.y * static_cast<double>(at.lateral_columns_at(cell.within_m)));
    const double v = std::abs(beam.z * static_cast<double>(at.elevation_columns_at(cell.within_m)));
    return (scene_.rim == BeamRim::ellipse ? std::hypot(u, v) : u + v) < scene_.table.columns();
  }

  const ScattererScene& scene_;
  const StickBeam& beam_;
  const StickTransform& transform_;
  const TimedRay& line_;
  double to_m_;
};

}  // namespace

/// Working memory of the threads that use a field, lent for one stick at a time.
class ScanBufferPool {
 public:
  /// Returns its buffers to the pool when it goes out of scope.
  class Lease {
   public:
    explicit Lease(ScanBufferPool& pool) : pool_(pool), buffers_(pool.take()) {}
    ~Lease() { pool_.put(std::move(buffers_)); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ScanBuffers& operator*() const { return *buffers_; }

   private:
    ScanBufferPool& pool_;
    std::unique_ptr<ScanBuffers> buffers_;
  };

 private:
  std::unique_ptr<ScanBuffers> take() {
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return std::make_unique<ScanBuffers>();
    auto buffers = std::move(idle_.back());
    idle_.pop_back();
    return buffers;
  }
  void put(std::unique_ptr<ScanBuffers> buffers) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(buffers));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<ScanBuffers>> idle_;
};

ScattererField::ScattererField(const ScannedTissue& tissue,
                               const ProbeOptics& optics,
                               const SimulationOptions& options,
                               const ScattererSettings& settings)
    : scene_(std::make_shared<ScattererScene>(tissue, optics, options, settings)),
      buffers_(std::make_shared<ScanBufferPool>()) {}

void ScattererField::add_echoes(const StickPath& path,
                                std::span<std::complex<float>> iq,
                                std::uint64_t* contributed) const {
  if (path.remaining.empty()) return;
  const ScanBufferPool::Lease buffers(*buffers_);
  const std::uint64_t count = StickScan(*scene_, path, *buffers).run(iq);
  if (contributed != nullptr) *contributed += count;
}

void ScattererField::add_points(const StickPath& path,
                                std::span<const PointEcho> points,
                                std::span<std::complex<float>> iq) const {
  if (path.remaining.empty()) return;
  const ScanBufferPool::Lease buffers(*buffers_);
  StickScan(*scene_, path, *buffers).run(points, iq);
}

std::vector<PointEcho> ScattererField::near(const TimedRay& line, double to_m) const {
  const StickTransform transform(scene_->tissue, line);
  std::vector<TouchedBlock> touched;
  find_touched_blocks(
      transform, scene_->beam(line.ray).bounds, scene_->block_grid(), to_m, touched);
  const ScattererSearch search(*scene_, transform, line, to_m);
  std::vector<PointEcho> found;
  for (const TouchedBlock& at : touched) {
    const TissueBlocks::Block block = scene_->blocks.block(at.index);
    if (scene_->blocks.anechoic(block)) continue;
    for (int i = 0; i < static_cast<int>(scene_->cells.octaves.size()); ++i) {
      search.collect(block, i, found);
    }
  }
  return found;
}

const BeamTable& ScattererField::beam() const {
  return scene_->table;
}

namespace {

constexpr double kPulseSamples = 8;  ///< a pulse extends this far beyond its scatterer's sample
/// Upper bound of the displacement of a point by rounding to float.
constexpr double kRounding_m = 1e-6;

/// A section of a line, and its vicinity.
struct Cylinder {
  glm::vec3 from;
  glm::vec3 along;  ///< unit
  float length_m;
  float radius_m;
};

/// near[i] = 1 for points within the cylinder, else 0.
WOBBLEBENCH_SIMD void find_near(const Cylinder& in,
                                const float* x,
                                const float* y,
                                const float* z,
                                int count,
                                std::uint8_t* __restrict near) {
  const float most = in.radius_m * in.radius_m;
  for (int i = 0; i < count; ++i) {
    const float dx = x[i] - in.from.x, dy = y[i] - in.from.y, dz = z[i] - in.from.z;
    const float t = dx * in.along.x + dy * in.along.y + dz * in.along.z;
    const float ax = dx - t * in.along.x, ay = dy - t * in.along.y, az = dz - t * in.along.z;
    near[i] = (t > -in.radius_m) & (t < in.length_m) & (ax * ax + ay * ay + az * az < most);
  }
}

}  // namespace

double echo_range_m(const StickPath& path) {
  const double delay_m = path.delay_m.empty() ? 0 : static_cast<double>(path.delay_m.back());
  const double to_m = (static_cast<double>(path.remaining.size()) + kPulseSamples) * path.spacing_m;
  return to_m - delay_m;
}

PointsInBeam::PointsInBeam(const ScannedTissue& tissue, const BeamTable& beam)
    : tissue_(tissue), rows_per_m_(beam.rows_per_m()) {
  for (int row = 0; row < beam.rows(); ++row) {
    const Reach& reach = reaches_.emplace_back(
        Reach{beam.lateral_reach_m(row), beam.reach_m(beam.elevation(), row)});
    widest_m_ = std::max({widest_m_, reach.lateral_m, reach.elevation_m});
  }
  const std::size_t count = tissue.points ? tissue.points->size() : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool fixed = tissue.points->fixed(i);
    (fixed ? fixed_ : moving_).push_back(static_cast<std::uint32_t>(i));
    if (!fixed) continue;
    const glm::dvec3& at = tissue.points->track(i).front().point.position_m;
    x_m_.push_back(static_cast<float>(at.x));
    y_m_.push_back(static_cast<float>(at.y));
    z_m_.push_back(static_cast<float>(at.z));
  }
  near_.resize(fixed_.size());
}

std::span<const PointEcho> PointsInBeam::find(const StickPath& path) {
  if (path.remaining.empty()) return {};
  return find(path.line, echo_range_m(path));
}

std::span<const PointEcho> PointsInBeam::find(const TimedRay& line, double to_m) {
  found_.clear();
  const Stick stick{line.ray, across_stick(line.ray), to_m, tissue_.motion.at(line.time_s)};
  if (!fixed_.empty()) find_fixed(stick);
  for (const std::uint32_t i : moving_) add_if_near(tissue_.points->at(i, line.time_s), stick);
  return found_;
}

void PointsInBeam::find_fixed(const Stick& stick) {
  if (tissue_.motion.rigid()) {
    // The axis is straight in the rest frame: only the points near it are transformed.
    const auto to_rest = [&](const glm::dvec3& probe_m) {
      return stick.now.to_rest(tissue_.placement.to_phantom(probe_m));
    };
    const glm::dvec3 from = to_rest(stick.ray.origin);
    find_near({glm::vec3(from),
               glm::vec3(glm::normalize(to_rest(stick.ray.at(1)) - from)),
               static_cast<float>(stick.to_m + kRounding_m),
               static_cast<float>(widest_m_ + kRounding_m)},
              x_m_.data(),
              y_m_.data(),
              z_m_.data(),
              static_cast<int>(fixed_.size()),
              near_.data());
  } else {
    std::ranges::fill(near_, std::uint8_t{1});
  }
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (near_[i] != 0) add_if_near(tissue_.points->track(fixed_[i]).front().point, stick);
  }
}

void PointsInBeam::add_if_near(const phantoms::PointScatterer& point, const Stick& stick) {
  const glm::dvec3 now_m = tissue_.placement.to_probe(stick.now.from_rest(point.position_m));
  const glm::dvec3 from_face = now_m - stick.ray.origin;
  const double range_m = glm::dot(from_face, stick.ray.direction);
  if (range_m <= 0 || range_m >= stick.to_m) return;
  const auto last = static_cast<double>(reaches_.size() - 1);
  const Reach& reach = reaches_[static_cast<std::size_t>(std::min(range_m * rows_per_m_, last))];
  const double u = glm::dot(from_face, stick.across.lateral) / reach.lateral_m;
  const double v = glm::dot(from_face, stick.across.elevation) / reach.elevation_m;
  if (u * u + v * v < 1) found_.push_back({now_m, static_cast<float>(point.amplitude)});
}

}  // namespace wobblebench::sim
