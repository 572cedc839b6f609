#include "phantoms/fetal/fetal_surroundings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <utility>

#include "base/units.h"

namespace wobblebench::phantoms {
namespace {

TubePoint ball(double scale, double x, double y, double z, double radius) {
  return {scale * kMillimetre * glm::dvec3(x, y, z), scale * kMillimetre * radius};
}

Ellipsoid ellipsoid(double scale, glm::dvec3 center, glm::dvec3 radii) {
  return {scale * kMillimetre * center, scale * kMillimetre * radii};
}

// Radius of the default probe's face: the interfaces are centred on the origin of its sticks.
constexpr double kFaceRadius_m = 40 * kMillimetre;

// Of the cord at 21 weeks, mm: a diameter of 10.6 (Raio 1999: 11.3).
constexpr double kStrandOffset = 2.5, kStrandRadius = 2.8;

// The bodies end this far behind the foremost point of the face, where its curved rim has left the
// tissue.
constexpr double kRim_m = 16 * kMillimetre;

// Sum of two plane waves of unit amplitude, wavelength about 40 mm.
double waves(double phase, double x, double y) {
  constexpr double k = 2 * kPi / (40 * kMillimetre);
  return std::sin(k * x + 0.6 * k * y + phase) + std::sin(0.7 * k * y - 0.4 * k * x + 2 * phase);
}

}  // namespace

CsgBody make_body(double s) {
  CsgBody body;
  body.begin(Part::neck);
  body.unite(Tube{{ball(s, 0, 6, 44, 13), ball(s, 0, 34, 42, 14)}}, 0);
  body.begin(Part::body);
  body.unite(ellipsoid(s, {0, 56, 38}, {25, 27, 21}), 8 * s * kMillimetre);
  const Tube shoulder{{ball(s, 12, 37, 44, 9), ball(s, 26, 40, 40, 8.5), ball(s, 34, 62, 34, 7)}};
  body.unite_pair(shoulder, 6 * s * kMillimetre);
  return body;
}

CsgBody make_hand(double s) {
  CsgBody hand;
  hand.begin(Part::arm);
  hand.unite(Tube{{ball(s, 34, 62, 34, 7), ball(s, 37, 55, 12, 5.4), ball(s, 28.5, 32, 6, 4.2)}},
             0);
  // Back of the hand, then the fingers curled towards the palm, index to little finger.
  hand.begin(Part::hand);
  hand.unite(ellipsoid(s, {25.5, 24, 4}, {6, 7, 4.2}), 3.5 * s * kMillimetre);
  const glm::dvec2 knuckle[] = {{19.8, 20.2}, {23.0, 17.8}, {26.5, 17.4}, {29.6, 19.2}};
  const double length[] = {0.95, 1.05, 1.0, 0.82};
  for (int finger = 0; finger < 4; ++finger) {
    const double x = knuckle[finger].x, y = knuckle[finger].y, l = length[finger];
    const std::vector<TubePoint> bones = {ball(s, x + 0.3, y + 4, 3.5, 2.2),
                                          ball(s, x, y - 1.5 * l, -0.5, 2.05),
                                          ball(s, x - 0.4, y - 0.5 * l, -4.6 * l, 1.9),
                                          ball(s, x - 0.8, y + 4.6 * l, -5.2 * l, 1.75),
                                          ball(s, x - 0.6, y + 6.0 * l, -2.5, 1.6)};
    hand.unite(smooth_tube(bones, 4), 0.6 * s * kMillimetre);
  }
  const std::vector<TubePoint> thumb = {ball(s, 24, 30, 2, 2.6),
                                        ball(s, 19.2, 28, -2.0, 2.3),
                                        ball(s, 18.0, 24.1, -4.4, 2.0),
                                        ball(s, 20.2, 21.6, -6.0, 1.7)};
  hand.unite(smooth_tube(thumb, 4), 0.9 * s * kMillimetre);
  return hand;
}

std::vector<Tube> hand_before(double s, double weeks) {
  // In units of the 21-week fetus. Knuckles from the index to the little finger, which point up and
  // to the other side of the face.
  const double little = (0.9079 * weeks - 7.804) / s;
  const double ratio[] = {1.18, 1.3, 1.22, 1.0};
  const glm::dvec2 knuckle[] = {{9.5, 17.5}, {7.0, 21.0}, {6.6, 24.8}, {7.6, 28.4}};
  const glm::dvec2 along[] = {{-0.86, -0.51}, {-0.96, -0.28}, {-1.0, -0.05}, {-0.98, 0.2}};
  std::vector<Tube> tubes;
  for (int finger = 0; finger < 4; ++finger) {
    const double length = little * ratio[finger];
    const glm::dvec2 from = knuckle[finger], to = from + length * along[finger],
                     middle = 0.5 * (from + to);
    tubes.push_back(smooth_tube({ball(s, from.x, from.y, -14, 2.1),
                                 ball(s, middle.x, middle.y, -14.4, 1.9),
                                 ball(s, to.x, to.y, -13.2, 1.6)},
                                4));
    tubes.push_back(Tube{{ball(s, from.x, from.y, -14, 2.3), ball(s, 20, 29.5, -12.5, 3.0)}});
  }
  tubes.push_back(Tube{{ball(s, 18, 26, -12.5, 2.4),
                        ball(s, 14.5, 17.5, -13.5, 2.0),
                        ball(s, 11, 11.5, -13.5, 1.7)}});
  tubes.push_back(smooth_tube({ball(s, 20, 29.5, -12.5, 3.6),
                               ball(s, 29, 38, -8, 4.2),
                               ball(s, 38, 54, 6, 5.2),
                               ball(s, 36, 62, 30, 6.5)},
                              4));
  return tubes;
}

CsgBody united_hand(const std::vector<Tube>& tubes, double fillet_m) {
  CsgBody hand;
  for (const Tube& tube : tubes) {
    hand.begin(&tube == &tubes.back() ? Part::arm : Part::hand);
    hand.unite(tube, hand.empty() ? 0 : fillet_m);
  }
  return hand;
}

Tube cord_beside(double s) {
  return smooth_tube({ball(s, -50, 70, 34, 1),
                      ball(s, -44, 56, 12, 1),
                      ball(s, -33, 42, 6, 1),
                      ball(s, -31, 27, 8, 1),
                      ball(s, -40, 14, 14, 1),
                      ball(s, -52, 8, 26, 1),
                      ball(s, -56, 4, 44, 1)},
                     8);
}

Tube cord_across(double s) {
  return smooth_tube({ball(s, -52, 40, 40, 1),
                      ball(s, -42, 30, 10, 1),
                      ball(s, -24, 20, -10, 1),
                      ball(s, -4, 10, -15, 1),
                      ball(s, 16, 0, -11, 1),
                      ball(s, 34, -12, 4, 1),
                      ball(s, 48, -22, 34, 1)},
                     8);
}

Tube shifted(const Tube& tube, const glm::dvec3& by_m) {
  std::vector<TubePoint> points = tube.points();
  for (TubePoint& point : points) point.center += by_m;
  return Tube(std::move(points));
}

namespace {

// f(centre, radius) over points of the tubes, four a segment.
template <class Function>
void for_points(const std::vector<Tube>& tubes, const Function& f) {
  constexpr int kPieces = 4;
  for (const Tube& tube : tubes) {
    for (std::size_t i = 0; i + 1 < tube.points().size(); ++i) {
      const TubePoint &a = tube.points()[i], &b = tube.points()[i + 1];
      for (int piece = 0; piece <= kPieces; ++piece) {
        const double t = double(piece) / kPieces;
        f(a.center + t * (b.center - a.center), a.radius_m + t * (b.radius_m - a.radius_m));
      }
    }
  }
}

}  // namespace

double place_before(const std::function<double(const glm::dvec3&)>& distance,
                    const std::vector<Tube>& tubes,
                    double thicker_m,
                    double gap_m) {
  const auto gap = [&](double shift) {
    double least = std::numeric_limits<double>::infinity();
    for_points(tubes, [&](const glm::dvec3& center, double radius) {
      const double here = distance(center + glm::dvec3(0, 0, shift)) - radius - thicker_m;
      least = std::min(least, here);
    });
    return least;
  };
  double near = 60 * kMillimetre, far = -60 * kMillimetre;
  while (near - far > 1e-6) {
    const double middle = 0.5 * (near + far);
    (gap(middle) < gap_m ? near : far) = middle;
  }
  return far;
}

double most_outside(const std::function<double(const glm::dvec3&)>& distance,
                    const std::vector<Tube>& tubes,
                    double thicker_m) {
  double most = -std::numeric_limits<double>::infinity();
  for_points(tubes, [&](const glm::dvec3& center, double radius) {
    most = std::max(most, distance(center) + radius + thicker_m);
  });
  return most;
}

double placenta_distance(const glm::dvec3& position, double s, double thickness_m) {
  const double unit = s * kMillimetre, radius = 55 * unit, beyond = 2 * kMillimetre;
  const glm::dvec3 from_axis = position - cavity_size(s).center_m;
  const double across2 = (position.x * position.x + position.y * position.y) / (radius * radius);
  const double rim = std::sqrt(std::max(1 - across2, 0.0));
  const double wall = cavity_distance(position, s);
  // Within the wall's own tissue too, so that no two surfaces coincide.
  return std::max({wall - beyond,
                   -wall - thickness_m * rim,
                   from_axis.z + 10 * unit,
                   (std::sqrt(across2) - 1) * radius});
}

UmbilicalCord::Strand UmbilicalCord::divided(const Tube& tube) {
  constexpr std::size_t kSegments = 3;
  Strand strand;
  for (std::size_t from = 0; from + 1 < tube.points().size(); from += kSegments) {
    const std::size_t to = std::min(from + kSegments, tube.points().size() - 1);
    const Tube piece({tube.points().begin() + from, tube.points().begin() + to + 1});
    strand.push_back({piece, piece.bound()});
  }
  return strand;
}

double UmbilicalCord::radius_m(double s) {
  return (kStrandOffset + kStrandRadius) * s * kMillimetre;
}

UmbilicalCord::UmbilicalCord(double s, const Tube& path) {
  constexpr int kStrands = 3;
  // One coil: 24.9 mm at 20 weeks (Predanic 2005), the same at later ages (Qin 2002).
  constexpr double pitch = 25 * kMillimetre;
  const double offset = kStrandOffset * s * kMillimetre, radius = kStrandRadius * s * kMillimetre;
  std::vector<std::vector<TubePoint>> wound(kStrands);
  double along = 0;
  for (std::size_t i = 0; i < path.points().size(); ++i) {
    const glm::dvec3 here = path.points()[i].center;
    const glm::dvec3 next = path.points()[std::min(i + 1, path.points().size() - 1)].center;
    const glm::dvec3 last = path.points()[i == 0 ? 0 : i - 1].center;
    const glm::dvec3 tangent = glm::normalize(next - last);
    const glm::dvec3 side = glm::normalize(glm::cross(tangent, glm::dvec3(0.3, 0.2, -1)));
    const glm::dvec3 up = glm::cross(tangent, side);
    for (int strand = 0; strand < kStrands; ++strand) {
      const double turn = 2 * kPi * (along / pitch + double(strand) / kStrands);
      wound[strand].push_back(
          {here + offset * (std::cos(turn) * side + std::sin(turn) * up), radius});
    }
    along += glm::distance(here, next);
  }
  for (auto& points : wound) strands_.push_back(divided(Tube(std::move(points))));
  bound_ = path.bound();
  bound_.radius_m += offset + radius;
}

double UmbilicalCord::strand_distance(const Strand& strand, const glm::dvec3& position) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Piece& piece : strand) {
    const double lower_bound = glm::distance(position, piece.bound.center) - piece.bound.radius_m;
    if (lower_bound < nearest) nearest = std::min(nearest, piece.tube.distance(position));
  }
  return nearest;
}

UmbilicalCord::Strand UmbilicalCord::near(const Strand& strand, const Ball& ball) {
  constexpr double kRounding_m = 1e-9;
  const double farthest = strand_distance(strand, ball.center) + ball.radius_m + kRounding_m;
  Strand local;
  for (const Piece& piece : strand) {
    if (piece.tube.within(ball).least > farthest) continue;
    local.push_back({piece.tube.near(ball), piece.bound});
  }
  return local;
}

UmbilicalCord UmbilicalCord::near(const Ball& ball) const {
  UmbilicalCord local = *this;
  for (Strand& strand : local.strands_) strand = near(strand, ball);
  return local;
}

double UmbilicalCord::distance(const glm::dvec3& position) const {
  const double lower_bound = glm::distance(position, bound_.center) - bound_.radius_m;
  if (lower_bound > 10 * kMillimetre) return lower_bound;
  double cord = strand_distance(strands_[0], position);
  for (std::size_t i = 1; i < strands_.size(); ++i) {
    cord = smooth_union(cord, strand_distance(strands_[i], position), 1.0 * kMillimetre);
  }
  return cord;
}

CavitySize cavity_size(double s) {
  return {s * kMillimetre * glm::dvec3(0, 12, 28), s * kMillimetre * glm::dvec3(68, 86, 64)};
}

double cavity_distance(const glm::dvec3& position, double s) {
  const CavitySize size = cavity_size(s);
  const glm::dvec3 p = position - size.center_m;
  // Wall: (x/a)^4 + (y/b)^4 + (z/c)^4 = 1, displaced by waves along x and y; distance = level over
  // its gradient's magnitude.
  const glm::dvec3 u = p / size.radii_m, cubes = u * u * u;
  const double norm = std::sqrt(std::sqrt(glm::dot(cubes, u)));
  const double unit = s * kMillimetre, kx = 1 / (27 * unit), ky = 1 / (30 * unit);
  const double wave_x = kx * p.x + 0.4, wave_y = ky * p.y - 0.7;
  const double height = 0.03;
  const double level = norm - 1 - height * std::sin(wave_x) * std::cos(wave_y);
  const double steep = 1 / std::max(norm * norm * norm, 1e-6);
  const glm::dvec3 gradient =
      steep * cubes / size.radii_m - height * glm::dvec3(kx * std::cos(wave_x) * std::cos(wave_y),
                                                         -ky * std::sin(wave_x) * std::sin(wave_y),
                                                         0);
  return level / std::max(glm::length(gradient), 0.25 / size.radii_m.y);
}

MaternalLayer::MaternalLayer(double thickness_m, const glm::dvec3& face_m) : face_m_(face_m) {
  // Skin: 2 mm, at most a fifth of the whole. Fat: 60 % of the rest. All assumed.
  const double skin_m = std::min(2 * kMillimetre, thickness_m / 5);
  skin_ = interface(skin_m);
  fat_ = interface(skin_m + 0.6 * (thickness_m - skin_m));
  muscle_ = interface(thickness_m);
}

MaternalLayer::Interface MaternalLayer::interface(double depth_m) const {
  const double along = kFaceRadius_m + depth_m;
  const double curvature_radius = kFaceRadius_m + 4 * depth_m;
  const double across = std::sqrt(curvature_radius * along);
  const double phase = depth_m / (6 * kMillimetre);
  // Undulation of at most 0.5 mm times waves(): slopes up to 0.16.
  return {{face_m_ - glm::dvec3(0, 0, kFaceRadius_m), {across, across, along}},
          std::min(0.02 * depth_m, 0.5 * kMillimetre),
          phase,
          waves(phase, 0, 0)};
}

double MaternalLayer::distance(const Interface& interface, const glm::dvec3& p) const {
  const glm::dvec3 arm = p - face_m_;
  const double offset =
      interface.undulation_m * (waves(interface.phase, arm.x, arm.y) - interface.wave_at_axis);
  return std::max(interface.mean.distance(p) - offset, -kRim_m - arm.z);
}

Box MaternalLayer::bounds() const {
  const glm::dvec3 half = muscle_.mean.radii_m + 5 * kMillimetre;
  return {face_m_ - glm::dvec3(half.x, half.y, kRim_m + 5 * kMillimetre),
          face_m_ + glm::dvec3(half.x, half.y, half.z - kFaceRadius_m)};
}

}  // namespace wobblebench::phantoms
