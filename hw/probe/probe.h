// The geometry of a convex probe whose image plane wobbles about an axis behind its face, and
// probes by name. Frame of reference ("probe frame", docs/units.md): origin at the centre of
// curvature of the face with the motor at rest, x along the array, z into the body, y the direction
// of the sweep with the sign that makes x, y, z right-handed.
#pragma once

#include <glm/vec3.hpp>
#include <string_view>

#include "base/options.h"
#include "base/units.h"

namespace wobblebench::hw {

/// Geometry and bandwidth of the probe. Defaults: the paper's settings where it gives them, else
/// acquisition notes in docs/references.md.
struct ProbeOptions {
  double radius_m = 40e-3;  ///< radius of curvature of the face, "a"
  /// The wobble axis lies this far behind the face, "w"; beyond a, behind the centre of curvature.
  double wobble_radius_m = 27e-3;
  double center_frequency_hz = 3.5e6;
  double fractional_bandwidth = 0.6;  ///< -6 dB bandwidth over centre frequency
  /// In the image plane, dynamic focus. At 4 the beams of the default 64 sticks nearly meet at 6
  /// cm.
  double f_number = 4.0;
  double transmit_focus_m = 75e-3;  ///< fixed, in the image plane, range from the face
  /// Along the face. No rule ties them to the sector: sticks may lie beyond the last element.
  int elements = 128;
  double pitch_m = 0.42e-3;  ///< of the elements along the face; 128 fill the default sector
  /// Aperture across the image plane. Of scans of unknown probes it and `elements` are 0, which no
  /// user can give (hw/probe/beam_width.h).
  double element_height_m = 13.5e-3;
  double elevation_focus_m = 75e-3;  ///< fixed focus across the image plane, range from the face

  friend bool operator==(const ProbeOptions&, const ProbeOptions&) = default;
};

template <OptionsOf<ProbeOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.real("radius_mm", o.radius_m, kMillimetre, 1, 200);
  v.real("wobble_radius_mm", o.wobble_radius_m, kMillimetre, 0, 200);
  v.real("center_frequency_mhz", o.center_frequency_hz, kMegahertz, 0.5, 20);
  v.real("fractional_bandwidth", o.fractional_bandwidth, 1, 0.1, 1.5);
  v.real("f_number", o.f_number, 1, 0.5, 10);
  v.real("transmit_focus_mm", o.transmit_focus_m, kMillimetre, 5, 400);
  v.integer("elements", o.elements, 1, 1024);
  v.real("pitch_mm", o.pitch_m, kMillimetre, 0.05, 2);
  v.real("element_height_mm", o.element_height_m, kMillimetre, 1, 50);
  v.real("elevation_focus_mm", o.elevation_focus_m, kMillimetre, 5, 300);
}

/// Throws InvalidOption for a field out of range, and for an aperture that is not known.
void validate(const ProbeOptions& options);

/// A point in the probe's polar coordinates.
struct PolarPoint {
  double range_m = 0;    ///< along the stick from the face; 0 on the face
  double theta_rad = 0;  ///< stick angle in the image plane, positive towards +x
  double phi_rad = 0;    ///< motor angle of the image plane, positive towards -y
};

/// The axis of a stick, probe frame, m: origin on the face, unit direction.
struct Ray {
  glm::dvec3 origin{0};
  glm::dvec3 direction{0, 0, 1};
  glm::dvec3 at(double distance_m) const { return origin + distance_m * direction; }
};

/// Closed-form conversions both ways on the two-centre torus of a convex wobbler:
///   x = r sin(theta), y = -(r cos(theta) - b) sin(phi), z = b (1 - cos(phi)) + r cos(theta)
///   cos(phi)
/// with r = a + range and b = a - w (as public readers of GE Kretz volumes decode them).
///
/// @code
/// const hw::ProbeGeometry geometry{hw::ProbeOptions{}};
/// const hw::PolarPoint point{.range_m = 0.06, .theta_rad = 10 * kDegree, .phi_rad = 0};
/// const glm::dvec3 position_m = geometry.to_cartesian(point);
/// const hw::PolarPoint same = geometry.to_polar(position_m);
/// const hw::Ray axis = geometry.stick(same.theta_rad, same.phi_rad);
/// const glm::dvec3 also_m = axis.at(same.range_m);
/// if (also_m == position_m) return;
/// @endcode
class ProbeGeometry {
 public:
  /// Throws InvalidOption.
  explicit ProbeGeometry(const ProbeOptions& options);

  glm::dvec3 to_cartesian(const PolarPoint& point) const;

  /// Inverse of to_cartesian(), unique for |theta|, |phi| < 90 deg. On the wobble axis phi is
  /// undefined; returns 0.
  PolarPoint to_polar(const glm::dvec3& position_m) const;

  /// Axis of the stick at these angles.
  Ray stick(double theta_rad, double phi_rad) const;

  double radius_m() const { return a_; }
  double wobble_radius_m() const { return a_ - b_; }
  /// z of the wobble axis, b = a - w.
  double axis_z_m() const { return b_; }

 private:
  double a_;
  double b_;
};

enum class ProbePreset {
  standard,       ///< "default": the defaults of ProbeOptions
  c5_2v,          ///< "c5-2v"
  curvilinear_60  ///< "curvilinear-60"
};

/// A probe's options and their sources.
struct ProbePresetData {
  /// Source of the values; after "assumed:" those that the source does not give.
  std::string_view source;
  ProbeOptions probe;
  double sector_rad;
};

const ProbePresetData& probe_preset(ProbePreset preset);

/// Probe options that start from a preset: where a visitor sets `preset`, that preset's values are
/// the defaults of the keys that follow.
///
/// @code
/// const hw::ProbePresetData& data = hw::probe_preset(hw::ProbePreset::c5_2v);
/// hw::NamedProbeOptions probe;
/// static_cast<hw::ProbeOptions&>(probe) = data.probe;
/// probe.preset = hw::ProbePreset::c5_2v;
/// probe.f_number = 2.5;
/// hw::validate(probe);
/// @endcode
struct NamedProbeOptions : ProbeOptions {
  ProbePreset preset = ProbePreset::standard;
};

template <OptionsOf<NamedProbeOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  [[maybe_unused]] const ProbePreset before = o.preset;
  v.choice("preset",
           o.preset,
           {{"default", ProbePreset::standard},
            {"c5-2v", ProbePreset::c5_2v},
            {"curvilinear-60", ProbePreset::curvilinear_60}});
  if constexpr (!std::is_const_v<O>) {
    if (o.preset != before) static_cast<ProbeOptions&>(o) = probe_preset(o.preset).probe;
  }
  v.constant("preset_source", probe_preset(o.preset).source);
  using Base = std::conditional_t<std::is_const_v<O>, const ProbeOptions, ProbeOptions>;
  describe(static_cast<Base&>(o), v);
}

}  // namespace wobblebench::hw
