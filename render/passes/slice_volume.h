// The volume on the GPU, written by pass 1 and read by pass 2.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "base/image.h"
#include "render/geometry/slice_geometry.h"
#include "render/gl/objects.h"
#include "render/leaping/empty_space.h"
#include "render/reconstruction/frame_store.h"

namespace wobblebench::render {

/// The slices of one volume and, in mode fast, its skippable cells.
class SliceVolume {
 public:
  virtual ~SliceVolume() = default;
  explicit SliceVolume(const SliceGeometry& geometry) : covered_{0, geometry.frames() - 1.0} {}
  SliceVolume(const SliceVolume&) = delete;
  SliceVolume& operator=(const SliceVolume&) = delete;

  /// Pass 1 for these layers of the volume texture.
  virtual void make_layers(const std::vector<int>& layers, FrameStore& store) = 0;
  virtual const Texture& slices() const = 0;
  /// The pixels of a slice that slices() stores.
  virtual Region pixels() const = 0;

  /// A slice's stored pixels, read from the GPU.
  Image<float> download_slice(int frame) const;

  /// What rays can leap over, in mode fast; else null.
  virtual EmptySpace* empty_space() { return nullptr; }
  /// Which cells are skippable depends on the view …
  virtual void set_view(const RenderOptions&) {}
  /// … and on the settings of pass 2. Only for settings with same_slices().
  virtual void set_options(const RenderOptions&) {}

  /// The level of an iso-surface; of a rise for Detector::floor.
  virtual void set_level(double new_level) { level_ = new_level; }
  double level() const { return level_; }

  /// The part of the fan that holds data; the whole, unless told.
  virtual void set_covered(const FrameSpan& covered) { covered_ = covered; }
  const FrameSpan& covered() const { return covered_; }

  int sweep = 1;  ///< of the motor, as hw::AcquisitionPlan::sweep_direction

 private:
  double level_ = std::numeric_limits<double>::infinity();
  FrameSpan covered_;
};

/// Whether pass 1, with the reconstruction before it, makes the same of a scan by both settings,
/// and measures the levels of its echoes by both or by neither.
bool same_slices(const RenderOptions& one, const RenderOptions& other);

/// Makes the volumes of one plan, which share its scan converter and must not outlive it.
class SliceVolumeFactory {
 public:
  SliceVolumeFactory(const hw::AcquisitionPlan& plan, const RenderOptions& options);
  ~SliceVolumeFactory();

  [[nodiscard]] std::unique_ptr<SliceVolume> make() const;
  const SliceGeometry& geometry() const;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace wobblebench::render
