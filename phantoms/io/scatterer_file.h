// A user's list of point scatterers: a .csv, or an .h5 read by wobblebench-import.
#pragma once

#include <filesystem>
#include <string_view>

#include "phantoms/options.h"
#include "phantoms/point_scatterers.h"

namespace wobblebench::phantoms {

/// The scatterers of `options.scatterers`; none where it is empty. Throws InvalidPhantom
/// "scatterers = "PATH": line N, column NAME = VALUE: what is allowed", and ImportUnavailable.
[[nodiscard]] PointScatterers read_scatterers(const PhantomOptions& options);

/// The list of a message, of which nothing is trusted. Throws std::invalid_argument.
[[nodiscard]] PointScatterers scatterers_from_message(std::string_view message, double gain);

}  // namespace wobblebench::phantoms
