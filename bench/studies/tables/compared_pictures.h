// Pictures of one recording from two contexts, a GPU's and llvmpipe's: how far apart they are, and
// whether the rounding of a GPU's texture filter explains it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "bench/studies/tables/paper.h"
#include "hw/probe/polar_volume.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// Most by which a sample on a ray may be off on a GPU, for samples in [0, 1]. A GPU rounds the
/// fraction of a linear filter to 8 bits (docs/references.md [28]), which moves a value by at most
/// 1/512 of the difference between neighbours, in each of two axes in pass 1 and in pass 2.
inline constexpr double kFilterError = 4.0 / 512;

/// Of one setting. `cast_m` is z of pass 2, before small pieces are left out. A ray ends where its
/// samples first pass a level (iso), or their Difference a threshold (paper); with no sample off by
/// more than kFilterError, z lies between those of the levels so far below and above: `nearest_m`
/// and `farthest_m`. Not of a ray that begins in tissue, which may leave it and enter again.
struct ComparedPicture {
  std::string settings;  ///< as StageTimes::settings
  Image<float> nearest_m, cast_m, farthest_m;
  Image<glm::vec3> surface;
};

/// The volume by the paper's and by the default settings, mode fast.
std::vector<ComparedPicture> render_compared(const hw::PolarVolume& volume,
                                             render::GlContext& context,
                                             const TableRun& run);

/// An .npy file of float32, [setting, layer, row, column]; layers: the three z, red, green, blue.
std::string compared_bytes(const std::vector<ComparedPicture>& pictures);
/// Throws std::invalid_argument with one line for what is no such file.
std::vector<ComparedPicture> read_compared(std::string_view bytes);

/// CRC-32C of all samples.
std::uint32_t samples_crc(const hw::PolarVolume& volume);

/// This context's picture against another's.
struct PictureAgreement {
  std::string settings;
  int pixels = 0;        ///< with a surface in both
  double z_rms_mm = 0;   ///< over those
  double z_p999_mm = 0;  ///< 99.9 % differ by less
  double z_largest_mm = 0;
  double found_in_one_share = 0;  ///< of all pixels
  double unexplained_share = 0;   ///< of all pixels: z beyond nearest_m and farthest_m
  double light_rms = 0;           ///< linear RGB in [0, 1], all pixels
  double light_largest = 0;
};

/// Most of the pixels that may be unexplained: a ray that touches the edge of the cone may end
/// before or behind it.
inline constexpr double kMostUnexplained = 1e-3;

/// Throws std::invalid_argument for pictures of other sizes.
std::vector<PictureAgreement> compare_pictures(const std::vector<ComparedPicture>& here,
                                               const std::vector<ComparedPicture>& other);

}  // namespace wobblebench::bench
