// Lists of point scatterers as CSV.
#pragma once

#include <string>
#include <string_view>

#include "phantoms/point_scatterers.h"

namespace wobblebench::phantoms {

/// A header line of column names (phantoms/io/scatterer_table.h), then a line a row, values
/// separated by commas. Lines end in LF or CRLF; "#" begins a comment; empty lines are skipped.
/// `gain`: factor on each amplitude. Throws std::invalid_argument "line N, column NAME = VALUE:
/// what is allowed".
[[nodiscard]] PointScatterers scatterers_from_csv(std::string_view text, double gain = 1);

/// The list that gives the same scatterers to the bit: in metres, with tracks where any moves.
[[nodiscard]] std::string scatterers_to_csv(const PointScatterers& points);

}  // namespace wobblebench::phantoms
