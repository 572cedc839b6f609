#include "bench/evaluation/measures/picture_measures.h"

#include <limits>

#include "render/reference/reference.h"

namespace wobblebench::bench {

namespace {

/// The window of the similarity index; smaller images have none.
constexpr int kLeastImageSize = 11;
constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

/// Grazing surfaces may be found or not, but where they are a picture has no hole.
Image<float> with_grazing(const Truth& truth) {
  Image<float> depth_m = truth.depth_m;
  for (std::size_t i = 0; i < truth.crossing_m.pixels.size(); ++i) {
    if (truth.kind.pixels[i] == TruthKind::grazing) depth_m.pixels[i] = truth.crossing_m.pixels[i];
  }
  return depth_m;
}

}  // namespace

Image<glm::vec3> shade_truth(const Truth& truth,
                             const render::RenderOptions& options,
                             const Image<glm::vec3>& volume) {
  if (options.ray_casting.image_size < kLeastImageSize) return {};
  return render::shade_depth(with_grazing(truth), options, volume).surface;
}

PictureMeasures measure_picture(const render::Picture& picture,
                                const TrueView& view,
                                const render::RenderOptions& options,
                                const MeasureChoice& choice,
                                const Image<glm::vec3>* shaded_truth) {
  PictureMeasures measures;
  const Truth& truth = view.truth;
  measures.raw = measure_depth_error(picture.depth_m, truth, view.camera);
  measures.filtered = measure_depth_error(picture.filtered_depth_m, truth, view.camera);
  measures.regions = measure_regions(
      view.regions, truth, view.camera, picture.depth_m, measures.raw, measures.filtered);
  measures.shaded = {kUnset, kUnset};
  if (choice.shaded) {
    const Image<glm::vec3> made =
        shaded_truth ? Image<glm::vec3>() : shade_truth(truth, options, picture.volume);
    const Image<glm::vec3>& shaded = shaded_truth ? *shaded_truth : made;
    if (!shaded.pixels.empty()) measures.shaded = compare_images(picture.surface, shaded);
  }
  if (choice.distance) {
    measures.distance = surface_distance(picture.depth_m, truth, view.camera);
  }
  return measures;
}

std::string why_no_surface(const DepthError& error) {
  if (error.surface_in_view()) return "";
  const int unseen = error.outside_field + error.grazing + error.shadowed;
  if (unseen == 0) return "the phantom has none in render.volume_of_interest";
  if (error.outside_field == unseen) {
    return "the phantom's lie outside sector, fan or depth of the scan";
  }
  return "the probe cannot see the phantom's: of their pixels " +
         std::to_string(error.outside_field) + " are outside its field, " +
         std::to_string(error.grazing) + " grazing and " + std::to_string(error.shadowed) +
         " shadowed";
}

}  // namespace wobblebench::bench
