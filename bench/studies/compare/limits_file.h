// What may differ between two runs: a TOML file of limits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobblebench::bench {

/// What a limit holds against its number.
enum class Allowed {
  worse_by,    ///< new less base, at most; base less new where less is worse, as of ssim
  changed_by,  ///< its magnitude: for signed figures
  ratio,       ///< new over base, at most
  equal,       ///< every digit; there is no number
};

struct ChangeLimit {
  std::string figure;
  Allowed allowed = Allowed::worse_by;
  double most = 0;  ///< in the figure's unit; of `ratio`: 1 or more; of `equal`: unused
};

/// "changed by at most 0.05 mm".
std::string text_of(const ChangeLimit& limit);

/// The limits of docs/scenes/compare.toml.
std::vector<ChangeLimit> default_change_limits();

/// Reads a file as docs/scenes/compare.toml is one. Throws UserError that names file, key, value
/// and what is allowed.
std::vector<ChangeLimit> read_change_limits(const std::filesystem::path& file);

}  // namespace wobblebench::bench
