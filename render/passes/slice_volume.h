// The volume on the GPU: pass 1 makes it, pass 2 reads it.
#pragma once

#include <memory>
#include <vector>

#include "render/gl/objects.h"
#include "render/leaping/skippable_cells.h"
#include "render/passes/frame_store.h"
#include "render/passes/slice_geometry.h"

namespace wobblebench::render {

class SliceVolume {
 public:
  virtual ~SliceVolume() = default;
  SliceVolume() = default;
  SliceVolume(const SliceVolume&) = delete;
  SliceVolume& operator=(const SliceVolume&) = delete;

  /// Pass 1 for these layers of the volume texture.
  virtual void make_layers(const std::vector<int>& layers, FrameStore& store) = 0;
  virtual const Texture& slices() const = 0;
  /// The pixels of a slice that `slices` has.
  virtual Region pixels() const = 0;

  /// Empty space, in mode fast; else null.
  virtual const SkippableCells* cells() const { return nullptr; }
  virtual const Texture* distances() { return nullptr; }
  /// Empty space depends on where the picture is seen from.
  virtual void look(const RenderOptions&) {}

  int sweep = 1;  ///< which way the motor turned: hw::AcquisitionPlan::sweep_direction
};

/// Makes volumes of one plan; what they share is made once. They must not outlive it.
class SliceVolumeMaker {
 public:
  SliceVolumeMaker(const hw::AcquisitionPlan& plan, const RenderOptions& options);
  ~SliceVolumeMaker();

  std::unique_ptr<SliceVolume> make() const;
  FrameStore make_store() const;
  const SliceGeometry& geometry() const;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace wobblebench::render
