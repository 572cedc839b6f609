#include "phantoms/fetal/head_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

#include "base/units.h"
#include "phantoms/options.h"

namespace wobblebench::phantoms {
namespace {

constexpr int kCount = static_cast<int>(kFaceMeasures);
using Vector = Eigen::Matrix<double, kCount, 1>;
using Matrix = Eigen::Matrix<double, kCount, kCount>;

// The parameter that changes a measure most, by a length in units of the face.
struct Knob {
  FaceMeasure measure;
  void (*turn)(HeadShape& shape, double by);
};

// In the order of the measures.
const std::array<Knob, kFaceMeasures>& knobs() {
  using M = FaceMeasure;
  using S = HeadShape;
  static const std::array<Knob, kFaceMeasures> all = {{
      {M::head_circumference,
       [](S& s, double by) {
         s.biparietal += by * s.biparietal / s.occipitofrontal;
         s.occipitofrontal += by;
       }},
      {M::cephalic_index,
       [](S& s, double by) {
         s.biparietal += by;
         s.occipitofrontal -= by;
       }},
      {M::interocular, [](S& s, double by) { s.interocular += by; }},
      {M::binocular, [](S& s, double by) { s.binocular += by; }},
      {M::facial_height,
       [](S& s, double by) {
         s.subnasale += by;
         s.upper_lip += by;
         s.menton += by;
       }},
      {M::zygomatic_width, [](S& s, double by) { s.zygoma += by; }},
      {M::cheek_to_cheek, [](S& s, double by) { s.cheek += by; }},
      {M::philtrum,
       [](S& s, double by) {
         s.upper_lip += by;
         s.menton += by;
       }},
      {M::chin, [](S& s, double by) { s.menton += by; }},
      {M::nasal_bone, [](S& s, double by) { s.nasal_bone += by; }},
      {M::prenasal_ratio,
       [](S& s, double by) {
         s.bridge += 0.6 * by;
         s.bone_bridge -= 0.5 * by;
       }},
      {M::mandible, [](S& s, double by) { s.gonion += by; }},
      {M::ear_length, [](S& s, double by) { s.ear += 0.1 * by; }},
      {M::inferior_facial_angle, [](S& s, double by) { s.chin += by; }},
      {M::nasomental_angle, [](S& s, double by) { s.nose += by; }},
      {M::frontomaxillary_angle, [](S& s, double by) { s.forehead += by; }},
      {M::ear_eye_angle, [](S& s, double by) { s.ear_height += by; }},
  }};
  return all;
}

// What a difference of a measure is divided by, so that all weigh about alike: one unit of the
// face, or what that changes.
double weight(std::string_view name, double unit_m) {
  if (name.ends_with("_mm")) return unit_m / kMillimetre;
  if (name.ends_with("_deg")) return 4;
  return name == "cephalic_index" ? 2.5 : 0.1;
}

// Of the prenasal ratio a tenth: 0.03 of it are 0.2 mm.
double allowed(std::string_view name) {
  return name == "prenasal_ratio" ? 0.1 * kMostResidual : kMostResidual;
}

}  // namespace

double face_unit_m(const FaceMeasures& measures) {
  const FaceMeasures mean = mean_face(21);
  double product = 1;
  for (const FaceMeasure each :
       {FaceMeasure::zygomatic_width, FaceMeasure::facial_height, FaceMeasure::binocular}) {
    product *= measures[each] / mean[each];
  }
  return std::cbrt(product) * kMillimetre;
}

namespace {

HeadShape first_shape(const FaceIdentity& identity) {
  HeadShape shape;
  shape.unit_m = face_unit_m(identity.measures);
  shape.traits = identity.traits;
  shape.asymmetry = identity.asymmetry;
  const double unit_mm = shape.unit_m / kMillimetre;
  const auto units = [&](FaceMeasure measure) { return identity.measures[measure] / unit_mm; };
  // Of an ellipse with this perimeter and ratio of diameters.
  const double ratio = identity.measures[FaceMeasure::cephalic_index] / 100;
  shape.occipitofrontal = units(FaceMeasure::head_circumference) / ellipse_perimeter(ratio, 1);
  shape.biparietal = ratio * shape.occipitofrontal;
  shape.interocular = units(FaceMeasure::interocular);
  shape.binocular = units(FaceMeasure::binocular);
  shape.zygoma = units(FaceMeasure::zygomatic_width) / 2;
  shape.nasal_bone = units(FaceMeasure::nasal_bone);
  // Fillets shift the extremes of the profile by about these shares.
  shape.upper_lip = shape.subnasale + 0.9 * units(FaceMeasure::philtrum);
  shape.menton = shape.upper_lip + 4.4 + 0.55 * units(FaceMeasure::chin);
  return shape;
}

class Solver {
 public:
  explicit Solver(const FaceIdentity& identity)
      : target_(identity.measures), first_(first_shape(identity)) {
    evaluate(Vector::Zero());
  }

  // Levenberg-Marquardt steps on a Jacobian that Broyden's rule keeps up with.
  void iterate(const Matrix& jacobian) {
    constexpr int kMostRounds = 45;
    constexpr double kEnough = 0.05, kLongest = 2.5;
    Matrix slope = jacobian;
    double damping = 1e-4;
    int refused = 0;
    for (int round = 0; round < kMostRounds && worst() > kEnough; ++round) {
      const Matrix normal = slope.transpose() * slope + damping * Matrix::Identity();
      Vector step = normal.ldlt().solve(slope.transpose() * residual_);
      const double longest = step.cwiseAbs().maxCoeff();
      if (longest > kLongest) step *= kLongest / longest;
      const Solver before = *this;
      evaluate(x_ + step);
      const Vector change = before.residual_ - residual_;
      slope += (change - slope * step) * step.transpose() / step.squaredNorm();
      if (residual_.norm() < before.residual_.norm()) {
        damping *= 0.3;
        refused = 0;
        continue;
      }
      *this = before;
      damping = std::max(damping, 1e-3) * 4;
      if (++refused % 3 == 0) slope = differences(), damping = 1e-4;
    }
  }

  // Changes of the weighted measures by each parameter.
  Matrix differences() const {
    constexpr double kStep = 0.1;
    Matrix slope;
    Solver trial = *this;
    for (int i = 0; i < kCount; ++i) {
      trial.evaluate(x_ + kStep * Vector::Unit(i));
      slope.col(i) = (residual_ - trial.residual_) / kStep;
    }
    return slope;
  }

  // The largest difference as a share of what is allowed, and of which measure.
  double worst() const { return share(worst_measure()); }
  std::size_t worst_measure() const {
    std::size_t found = 0;
    for (std::size_t i = 1; i < kFaceMeasures; ++i) {
      if (share(i) > share(found)) found = i;
    }
    return found;
  }
  const SolvedHead& solved() const { return solved_; }

 private:
  double share(std::size_t i) const {
    const double difference = target_.values[i] - solved_.measured.measures.values[i];
    return std::abs(difference) / allowed(face_measure_laws()[i].name);
  }

  void evaluate(const Vector& x) {
    x_ = x;
    solved_.shape = first_;
    for (std::size_t i = 0; i < kFaceMeasures; ++i) {
      knobs()[i].turn(solved_.shape, x[static_cast<int>(i)]);
    }
    solved_.head = build_head(solved_.shape);
    solved_.measured = measure_head(solved_.head, solved_.shape);
    for (std::size_t i = 0; i < kFaceMeasures; ++i) {
      const double difference = target_.values[i] - solved_.measured.measures.values[i];
      residual_[static_cast<int>(i)] =
          difference / weight(face_measure_laws()[i].name, first_.unit_m);
    }
  }

  FaceMeasures target_;
  HeadShape first_;
  Vector x_, residual_;
  SolvedHead solved_;
};

// That of the mean child, from which all start: the same for all, whichever is made first.
const Matrix& usual_jacobian() {
  static const Matrix jacobian = Solver({.weeks = 21, .measures = mean_face(21)}).differences();
  return jacobian;
}

}  // namespace

SolvedHead solve_head(const FaceIdentity& identity) {
  Solver solver(identity);
  if (solver.worst() > 0.05) solver.iterate(usual_jacobian());
  SolvedHead solved = solver.solved();
  solved.head.landmarks = solved.measured.landmarks;
  if (solver.worst() <= 1) return solved;
  const std::size_t i = solver.worst_measure();
  std::ostringstream text;
  text.precision(4);
  text << "no such face: " << face_measure_laws()[i].name << " = " << identity.measures.values[i]
       << " cannot be reached beside the other measures, only "
       << solved.measured.measures.values[i];
  throw InvalidPhantom(text.str());
}

}  // namespace wobblebench::phantoms
