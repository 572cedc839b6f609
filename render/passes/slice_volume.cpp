#include "render/passes/slice_volume.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "render/geometry/ray_sampling.h"
#include "render/leaping/empty_space.h"
#include "render/passes/fast_scan_converter.h"
#include "render/passes/scan_converter.h"
#include "render/reconstruction/reconstruction.h"

namespace wobblebench::render {
namespace {

/// Whether a detector asks how steeply the values of a cell change (SkippableCells).
bool needs_slopes(const RenderOptions& options) {
  return options.ray_casting.detector == Detector::paper;
}

class PlainVolume : public SliceVolume {
 public:
  PlainVolume(ScanConverter& converter, const SliceGeometry& geometry, const RenderOptions& options)
      : SliceVolume(geometry), converter_(converter), slices_(geometry, options.scan_conversion) {}

  void make_layers(const std::vector<int>& layers, FrameStore& store) override {
    for (int slice : layers) converter_.convert(store.filtered(slice), slices_.layer(slice));
  }
  const Texture& slices() const override { return slices_.texture(); }
  Region pixels() const override {
    return {0, 0, slices().extent().width, slices().extent().height};
  }

 private:
  ScanConverter& converter_;
  Slices slices_;
};

class FastVolume : public SliceVolume {
 public:
  FastVolume(FastScanConverter& converter,
             const SliceGeometry& geometry,
             const hw::AcquisitionPlan& plan,
             const RenderOptions& options,
             CellBoundsPass& cell_bounds)
      : SliceVolume(geometry),
        converter_(converter),
        geometry_(geometry),
        plan_(plan),
        slices_(geometry, options),
        empty_space_(SkippableCells(plan, geometry, options, slices_.region()), cell_bounds) {}

  void make_layers(const std::vector<int>& layers, FrameStore& store) override {
    converter_.convert(
        layers, store, slices_, [this](const Texture& made, const std::vector<LayerGroup>& groups) {
          empty_space_.update_bounds(made, groups);
        });
  }
  const Texture& slices() const override { return slices_.texture(); }
  Region pixels() const override { return slices_.region(); }
  EmptySpace* empty_space() override { return &empty_space_; }
  void set_view(const RenderOptions& options) override { empty_space_.set_view(options); }
  void set_options(const RenderOptions& options) override {
    empty_space_.set_cells({plan_, geometry_, options, slices_.region()});
    empty_space_.set_covered(covered());
  }
  void set_level(double new_level) override {
    SliceVolume::set_level(new_level);
    empty_space_.set_level(new_level);
  }
  void set_covered(const FrameSpan& covered) override {
    SliceVolume::set_covered(covered);
    empty_space_.set_covered(covered);
  }

 private:
  FastScanConverter& converter_;
  const SliceGeometry& geometry_;
  const hw::AcquisitionPlan& plan_;
  SlicePairs slices_;
  EmptySpace empty_space_;
};

}  // namespace

Image<float> SliceVolume::download_slice(int frame) const {
  const int last_layer = std::max(slices().extent().depth - 1, 0);
  const int layer = std::min(frame, last_layer), channel = frame - layer;
  const auto stride = static_cast<std::size_t>(channels(slices().format()));
  const std::vector<float> texels = slices().download_layer(layer);
  Image<float> slice(pixels().columns, pixels().rows);
  for (std::size_t i = 0; i < slice.pixels.size(); ++i) {
    slice.pixels[i] = texels.at(stride * i + static_cast<std::size_t>(channel));
  }
  return slice;
}

bool same_slices(const RenderOptions& one, const RenderOptions& other) {
  const auto same = [&](const auto& value_of) { return value_of(one) == value_of(other); };
  const auto region = [](const RenderOptions& o) {
    return std::pair(o.ray_casting.stop_at_box, o.ray_casting.stop_at_box ? kernel_radius_m(o) : 0);
  };
  const auto edge_of_sticks = [](const RenderOptions& o) {
    const bool has_edges = o.reconstruction.sticks == Sticks::aligned || has_stick_levels(o);
    return has_edges ? o.ray_casting.edge : EdgeSign::rising;
  };
  const auto stick_levels = [](const RenderOptions& o) {
    return has_stick_levels(o) ? o.ray_casting.below_tissue_db : 0;
  };
  return one.pipeline == other.pipeline && one.reconstruction == other.reconstruction &&
         one.scan_conversion == other.scan_conversion &&
         one.volume_of_interest == other.volume_of_interest && same(slice_weights) &&
         same([](const RenderOptions& o) { return frame_weights(o.ray_casting); }) &&
         same(needs_levels) && same(needs_slopes) && same(region) && same(edge_of_sticks) &&
         same(stick_levels);
}

struct SliceVolumeFactory::Shared {
  Shared(const hw::AcquisitionPlan& acquisition_plan, const RenderOptions& render_options)
      : plan(dense_plan(acquisition_plan, dense_factors(acquisition_plan, render_options))),
        options(render_options),
        geometry(acquisition_plan,
                 options.scan_conversion.slice_size,
                 dense_factors(acquisition_plan, options)) {
    if (options.pipeline.mode == PipelineMode::fast) {
      fast.emplace(geometry, plan, options);
      cell_bounds.emplace(make_macrocell_grid(geometry, pixels_that_rays_read(geometry, options)),
                          needs_slopes(options));
    } else {
      plain.emplace(geometry, plan, options);
    }
  }

  hw::AcquisitionPlan plan;  ///< of the sticks and those between them
  RenderOptions options;
  SliceGeometry geometry;
  std::optional<ScanConverter> plain;
  std::optional<FastScanConverter> fast;
  std::optional<CellBoundsPass> cell_bounds;
};

SliceVolumeFactory::SliceVolumeFactory(const hw::AcquisitionPlan& plan,
                                       const RenderOptions& options)
    : shared_(std::make_unique<Shared>(plan, options)) {}

SliceVolumeFactory::~SliceVolumeFactory() = default;

std::unique_ptr<SliceVolume> SliceVolumeFactory::make() const {
  Shared& s = *shared_;
  if (s.fast) {
    return std::make_unique<FastVolume>(*s.fast, s.geometry, s.plan, s.options, *s.cell_bounds);
  }
  return std::make_unique<PlainVolume>(*s.plain, s.geometry, s.options);
}

const SliceGeometry& SliceVolumeFactory::geometry() const {
  return shared_->geometry;
}

}  // namespace wobblebench::render
