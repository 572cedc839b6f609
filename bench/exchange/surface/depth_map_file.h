// Depth maps that other programs wrote: OpenEXR, TIFF, PNG, PFM, .npy and .npz.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace wobblebench::bench {

/// Which numbers of a file are the depths.
struct DepthMapChoice {
  std::string channel;  ///< of a picture, or array of an .npz; empty: "Z", else the only one
  std::string mask;     ///< likewise, not 0 where there is a surface; empty: none
  int size = 0;         ///< of the view, columns and rows; 0: any
};

/// As the file has them.
struct DepthMapFile {
  std::string format;   ///< "EXR", "TIFF", "PNG", "PFM", "npy", "npz"
  std::string channel;  ///< that was taken; empty: the file names none
  int width = 0, height = 0;
  std::vector<double> values;  ///< rows from the top
  std::vector<bool> mask;      ///< true: a surface; empty: none was asked for
  bool integers = false;
  std::optional<std::string> unit = {};                    ///< of the attribute `units`
  std::optional<std::string> projection = {};              ///< likewise
  std::optional<std::array<float, 16>> world_to_ndc = {};  ///< of the attribute `worldToNDC`
};

/// The format, by the file's first bytes, else by its name; "": none of these.
std::string depth_map_format(const std::filesystem::path& path);

/// Throws std::invalid_argument where a map is not of the view's size.
void check_map_size(int width, int height, int size);

/// Throws std::invalid_argument with one line: what is wrong with the file, or with the choice and
/// what it may be; as wobblebench::read_file() for one that cannot be read.
DepthMapFile read_depth_map(const std::filesystem::path& path, const DepthMapChoice& choice);

}  // namespace wobblebench::bench
