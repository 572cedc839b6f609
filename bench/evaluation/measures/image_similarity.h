// Similarity of two pictures: SSIM and PSNR, by OpenCV.
#pragma once

#include <glm/vec3.hpp>

#include "render/picture.h"

namespace wobblebench::bench {

/// On luminance in [0, 1]. Same size, at least 11 pixels a side (else std::invalid_argument).
struct ImageSimilarity {
  double ssim =
      0;  ///< mean structural similarity, 11 x 11 Gaussian window of sigma 1.5 (references.md [9])
  double psnr_db = 0;  ///< infinite for equal pictures
};

ImageSimilarity compare_images(const Image<glm::vec3>& a, const Image<glm::vec3>& b);

}  // namespace wobblebench::bench
