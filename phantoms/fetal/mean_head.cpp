#include "phantoms/fetal/mean_head.h"

#include <algorithm>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel.h"
#include "base/units.h"
#include "phantoms/fetal/fetal_child.h"
#include "phantoms/fetal/head_extent.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kMeanHeadWeeks = 26;  // heads of 20 to 34 weeks are within a quarter of its size
constexpr double kCell_m = 2 * kMillimetre;
constexpr double kAround_m = 30 * kMillimetre;  // of the grid about the head
// Of the origin, from that of fetal_head.h between the eyes.
constexpr glm::dvec3 kMiddle_m{0, -9 * kMillimetre, 28 * kMillimetre};

const SolvedHead& mean_head() {
  static const SolvedHead head = make_child({.gestational_age_weeks = kMeanHeadWeeks}).solved;
  return head;
}

}  // namespace

MeanHead::MeanHead() {
  const SolvedHead& mean = mean_head();
  glm::dvec3 low(0), high(0);
  for (const glm::dvec3& point : skin_points(mean.head, middle_of_skull(mean.shape))) {
    skin_m_.push_back(point - kMiddle_m);
    low = glm::min(low, skin_m_.back());
    high = glm::max(high, skin_m_.back());
    reach_m_ = std::max(reach_m_, glm::length(skin_m_.back()));
  }
  low_m_ = low - kAround_m;
  size_ = glm::ivec3((high - low + 2 * kAround_m) / kCell_m) + 2;
  distance_m_.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                     static_cast<std::size_t>(size_.z));
  parallel_rows(size_.z, [&](int z) {
    for (int y = 0; y < size_.y; ++y) {
      for (int x = 0; x < size_.x; ++x) {
        const glm::dvec3 cell = low_m_ + kCell_m * glm::dvec3(x, y, z);
        at({x, y, z}) = static_cast<float>(mean.head.skin.distance(cell + kMiddle_m));
      }
    }
  });
}

float& MeanHead::at(const glm::ivec3& cell) {
  return distance_m_[(static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size_.y) +
                      static_cast<std::size_t>(cell.y)) *
                         static_cast<std::size_t>(size_.x) +
                     static_cast<std::size_t>(cell.x)];
}

// Trilinear; beyond the grid its outermost value and the way to it.
MeanHead::Distance MeanHead::distance(const glm::dvec3& position_m) const {
  const glm::dvec3 wanted = (position_m - low_m_) / kCell_m;
  const glm::dvec3 within = glm::clamp(wanted, glm::dvec3(0), glm::dvec3(size_) - 1.001);
  const glm::ivec3 cell(within);
  const glm::dvec3 f = within - glm::dvec3(cell);
  const std::ptrdiff_t row = size_.x, layer = row * size_.y;
  const float* c = &distance_m_[static_cast<std::size_t>(cell.z * layer + cell.y * row + cell.x)];
  const auto along_x = [&](const float* p) { return (1 - f.x) * p[0] + f.x * p[1]; };
  const auto step_x = [](const float* p) { return double{p[1]} - p[0]; };
  const double a = along_x(c), b = along_x(c + row), d = along_x(c + layer),
               e = along_x(c + layer + row);
  const auto mean_yz = [&](double p, double q, double r, double s) {
    return (1 - f.z) * ((1 - f.y) * p + f.y * q) + f.z * ((1 - f.y) * r + f.y * s);
  };
  const glm::dvec3 gradient{
      mean_yz(step_x(c), step_x(c + row), step_x(c + layer), step_x(c + layer + row)),
      (1 - f.z) * (b - a) + f.z * (e - d),
      (1 - f.y) * (d - a) + f.y * (e - b)};
  return {mean_yz(a, b, d, e) + kCell_m * glm::distance(wanted, within), gradient / kCell_m};
}

Box MeanHead::turned_bounds(const glm::dmat3& rotation) const {
  const SolvedHead& mean = mean_head();
  const Box box = turned_skin(mean.head, middle_of_skull(mean.shape), rotation);
  return {box.low - rotation * kMiddle_m, box.high - rotation * kMiddle_m};
}

}  // namespace wobblebench::phantoms
