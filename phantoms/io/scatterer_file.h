// A user's list of point scatterers: a .csv, or an .h5 read by wobblebench-import
// (docs/decisions/0025-point-scatterers.md).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "phantoms/options.h"
#include "phantoms/point_scatterers.h"

namespace wobblebench::phantoms {

/// More rows than this are refused: they take 40 MB.
inline constexpr std::size_t kMostScattererRows = 1'000'000;

/// The scatterers of `options.scatterers`; none where it is empty. Throws InvalidPhantom
/// "scatterers = "PATH": line N, column NAME = VALUE: what is allowed", and ImportUnavailable.
[[nodiscard]] PointScatterers read_scatterers(const PhantomOptions& options);

/// Reads a list as CSV: a header line of column names, then a line a row, values separated by
/// commas, with quotes about them or without. Lines end in LF or CRLF; "#" begins a comment; empty
/// lines are skipped. A comment of column names alone is the header if rows follow it. `gain`:
/// factor on each amplitude. Throws std::invalid_argument "line N, column NAME = VALUE: what is
/// allowed".
[[nodiscard]] PointScatterers scatterers_from_csv(std::string_view text, double gain = 1);

/// The list that gives the same scatterers to the bit: in metres, with tracks where any moves.
[[nodiscard]] std::string scatterers_to_csv(const PointScatterers& points);

}  // namespace wobblebench::phantoms
