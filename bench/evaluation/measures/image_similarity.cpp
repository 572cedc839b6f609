#include "bench/evaluation/measures/image_similarity.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace wobblebench::bench {

namespace {

constexpr int kWindow = 11;

cv::Mat luminance(const Image<glm::vec3>& image) {
  cv::Mat1d grey(image.height, image.width);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const glm::dvec3 rgb(image.at(column, row));
      grey(row, column) = 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;  // Rec. 709
    }
  }
  return grey;
}

cv::Mat windowed(const cv::Mat& image) {
  cv::Mat mean;
  cv::GaussianBlur(image, mean, {kWindow, kWindow}, 1.5);
  return mean;
}

}  // namespace

ImageSimilarity compare_images(const Image<glm::vec3>& a, const Image<glm::vec3>& b) {
  if (a.width != b.width || a.height != b.height || std::min(a.width, a.height) < kWindow) {
    throw std::invalid_argument(
        "compare_images: pictures must be of one size, 11 pixels a side or more");
  }
  const cv::Mat x = luminance(a), y = luminance(b);
  const double mse = cv::norm(x, y, cv::NORM_L2SQR) / static_cast<double>(x.total());
  const cv::Mat mx = windowed(x), my = windowed(y);
  const cv::Mat vx = windowed(x.mul(x)) - mx.mul(mx);
  const cv::Mat vy = windowed(y.mul(y)) - my.mul(my);
  const cv::Mat vxy = windowed(x.mul(y)) - mx.mul(my);
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  const cv::Mat top = (2 * mx.mul(my) + kC1).mul(2 * vxy + kC2);
  const cv::Mat bottom = (mx.mul(mx) + my.mul(my) + kC1).mul(vx + vy + kC2);
  return {cv::mean(cv::Mat(top / bottom))[0], -10 * std::log10(mse)};
}

}  // namespace wobblebench::bench
