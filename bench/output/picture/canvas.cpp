#include "bench/output/picture/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace wobblebench::bench {

namespace {

constexpr int kSupersampling = 3;  // sheet pixels for a pixel of the picture
constexpr int kShift = 4;  // binary digits of a sheet pixel that OpenCV's lines are placed to
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontHeight =
    30;  // sheet pixels of that font at scale 1, as TextStyle::size counts

cv::Scalar to_scalar(Colour c) {
  return {255 * static_cast<double>(c.r),
          255 * static_cast<double>(c.g),
          255 * static_cast<double>(c.b)};
}

double font_scale(double size) {
  return size * kSupersampling / kFontHeight;
}

int text_thickness(double size) {
  return std::max(1, static_cast<int>(std::lround(size * kSupersampling / 14)));
}

cv::Size text_extent(const std::string& text, double size) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, font_scale(size), text_thickness(size), &baseline);
}

}  // namespace

struct Canvas::Sheet {
  cv::Mat whole;
  cv::Mat part;      ///< what is drawn on: a window of `whole`
  Point2 origin{0};  ///< of the window, picture pixels

  std::vector<cv::Point> points(const std::vector<Point2>& points) const {
    std::vector<cv::Point> result;
    for (const Point2& point : points) {
      const Point2 at = (point - origin) * static_cast<double>(kSupersampling << kShift);
      result.emplace_back(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)));
    }
    return result;
  }
  cv::Rect rect(const Box2& box) const {
    const auto at = [](double v) { return static_cast<int>(std::lround(v * kSupersampling)); };
    return cv::Rect(cv::Point(at(box.low.x), at(box.low.y)),
                    cv::Point(at(box.high.x), at(box.high.y)));
  }
};

Canvas::Canvas(int width, int height) : sheet_(std::make_unique<Sheet>()) {
  sheet_->whole =
      cv::Mat(height * kSupersampling, width * kSupersampling, CV_8UC3, cv::Scalar::all(255));
  clip_nothing();
}

Canvas::~Canvas() = default;

void Canvas::clip(const Box2& box) {
  const cv::Rect all({0, 0}, sheet_->whole.size());
  const cv::Rect window = sheet_->rect(box) & all;
  sheet_->part = sheet_->whole(window);
  sheet_->origin = Point2(window.x, window.y) / static_cast<double>(kSupersampling);
}

void Canvas::clip_nothing() {
  sheet_->part = sheet_->whole;
  sheet_->origin = Point2(0);
}

void Canvas::line(const std::vector<Point2>& points, Colour colour, double width) {
  const int thickness = std::max(1, static_cast<int>(std::lround(width * kSupersampling)));
  cv::polylines(sheet_->part,
                sheet_->points(points),
                false,
                to_scalar(colour),
                thickness,
                cv::LINE_AA,
                kShift);
}

void Canvas::fill(const std::vector<Point2>& corners, Colour colour) {
  const std::vector<std::vector<cv::Point>> outlines = {sheet_->points(corners)};
  cv::fillPoly(sheet_->part, outlines, to_scalar(colour), cv::LINE_AA, kShift);
}

void Canvas::fill(const Box2& box, Colour colour) {
  fill({box.low, {box.high.x, box.low.y}, box.high, {box.low.x, box.high.y}}, colour);
}

void Canvas::text(Point2 position, const std::string& text, const TextStyle& style) {
  // The height is that of capitals, so that words with and without descenders have one baseline.
  const cv::Size extent = text_extent(text, style.size);
  const int capital = text_extent("H", style.size).height, margin = capital;
  cv::Mat letters(capital + 2 * margin, extent.width + 2 * margin, CV_8U, cv::Scalar(0));
  cv::putText(letters,
              text,
              {margin, margin + capital},
              kFont,
              font_scale(style.size),
              cv::Scalar(255),
              text_thickness(style.size),
              cv::LINE_AA);
  const double along = style.across * extent.width, down = style.down * capital;
  Point2 corner = (position - sheet_->origin) * static_cast<double>(kSupersampling);
  if (style.upwards) {
    cv::rotate(letters, letters, cv::ROTATE_90_COUNTERCLOCKWISE);
    corner += Point2(-down - margin, along - extent.width - margin);
  } else {
    corner += Point2(-along - margin, -down - margin);
  }
  const cv::Point at(static_cast<int>(std::lround(corner.x)),
                     static_cast<int>(std::lround(corner.y)));
  const cv::Rect visible = cv::Rect(at, letters.size()) & cv::Rect({0, 0}, sheet_->part.size());
  if (visible.empty()) return;
  cv::Mat target = sheet_->part(visible);
  cv::Mat mask = letters(visible - at), inked(visible.size(), CV_8UC3, to_scalar(style.colour)),
          weight;
  cv::cvtColor(mask, weight, cv::COLOR_GRAY2RGB);
  cv::Mat ink, paper;
  cv::multiply(inked, weight, ink, 1 / 255.0);
  cv::multiply(target, cv::Scalar::all(255) - weight, paper, 1 / 255.0);
  cv::add(ink, paper, target);
}

void Canvas::picture(const Box2& box, const Image<glm::vec3>& values) {
  cv::Mat rgb(values.height, values.width, CV_32FC3);
  std::transform(values.pixels.begin(),
                 values.pixels.end(),
                 rgb.begin<cv::Vec3f>(),
                 [](const glm::vec3& pixel) { return cv::Vec3f(pixel.r, pixel.g, pixel.b); });
  cv::Mat bytes;
  rgb.convertTo(bytes, CV_8U, 255);
  const cv::Rect target = sheet_->rect(box);
  const bool shrinks = target.width < bytes.cols;
  const bool whole = target.width % bytes.cols == 0 && target.height % bytes.rows == 0;
  const bool keeps = whole || target.width >= 2 * kSupersampling * bytes.cols;
  const int way = shrinks ? cv::INTER_AREA : keeps ? cv::INTER_NEAREST : cv::INTER_LINEAR;
  cv::resize(bytes, bytes, target.size(), 0, 0, way);
  bytes.copyTo(sheet_->whole(target));
}

double Canvas::text_width(const std::string& text, double size) {
  return text_extent(text, size).width / static_cast<double>(kSupersampling);
}

Image<glm::vec3> Canvas::finish() const {
  cv::Mat small;
  cv::resize(sheet_->whole, small, sheet_->whole.size() / kSupersampling, 0, 0, cv::INTER_AREA);
  Image<glm::vec3> image(small.cols, small.rows);
  for (int row = 0; row < small.rows; ++row) {
    for (int column = 0; column < small.cols; ++column) {
      const auto& pixel = small.at<cv::Vec3b>(row, column);
      image.at(column, row) = Colour(pixel[0], pixel[1], pixel[2]) / 255.0f;
    }
  }
  return image;
}

}  // namespace wobblebench::bench
