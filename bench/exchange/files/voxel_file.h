// Files of voxels of one element type in a regular grid: what NRRD, MetaImage and raw files share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/text.h"

namespace wobblebench::bench {

enum class Element { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t element_bytes(Element element);
std::string_view element_name(Element element);  ///< "uint8"

/// Names that a format has for an element type, as "|short|int16|".
using ElementNames = std::vector<std::pair<Element, std::string_view>>;
/// In upper or lower case; none: no such name.
std::optional<Element> element_of(const ElementNames& names, std::string_view name);

/// Fields of a header, which are found in upper and in lower case.
struct AnyCase {
  bool operator()(const std::string& a, const std::string& b) const {
    return lower_case(a) < lower_case(b);
  }
};
using HeaderFields = std::map<std::string, std::string, AnyCase>;
/// The first of these that is there; null: none.
const HeaderFields::value_type* field_of(const HeaderFields& fields,
                                         std::initializer_list<const char*> names);

/// Most axes that a file may have: volumes of three axes, and time.
inline constexpr std::size_t kMostAxes = 4;

/// What a file's header says, and where its voxels are.
struct VoxelFile {
  std::filesystem::path path;                    ///< of the header
  std::filesystem::path data_path;               ///< of the voxels
  std::shared_ptr<const FileDescriptor> memory;  ///< where data_path is a file in memory
  std::uint64_t offset = 0;                      ///< in data_path, of the first voxel
  Element element = Element::uint8;
  std::optional<Element> kept_as = {};  ///< bytes in data_path, where the file's are a text
  bool big_endian = false;
  std::vector<std::uint64_t> sizes;  ///< fastest axis first
  /// mm, [axis]; one step along it. Empty: the file does not say. An axis without direction (time)
  /// is none.
  std::vector<std::optional<glm::dvec3>> directions_mm;
  std::string missing;      ///< why there are no directions, "ElementSpacing is missing"
  glm::dvec3 origin_mm{0};  ///< of the first voxel's centre
  HeaderFields fields;      ///< others by their names, as written in the file

  std::uint64_t voxels() const;
};

/// Throws UserError "PATH: what is wrong" where the voxels are not all there, or bytes are left
/// over: a truncated file, or another type or size than the header says. Voxels of a file whose
/// `offset` is 0 begin with the file.
void check_size(const VoxelFile& file);

/// `count` voxels from the first on, as they are in the file. Throws UserError "PATH: …" for NaN
/// and infinities, std::runtime_error where it cannot be read.
std::vector<float> read_voxels(const VoxelFile& file, std::uint64_t first, std::uint64_t count);
/// The same with NaN and infinities.
std::vector<float> read_numbers(const VoxelFile& file, std::uint64_t first, std::uint64_t count);

/// The number that a text is, decimal, all of it; nullopt: it is none, or not finite.
std::optional<double> number_in(std::string_view text);
/// Numbers with spaces between them. Throws UserError "PATH: FIELD = TEXT: must be N numbers".
std::vector<double> numbers_in(const std::filesystem::path& path,
                               const std::string& field,
                               const std::string& text,
                               std::size_t count);
/// A whole number from `least` on. Throws UserError likewise.
std::int64_t whole_in(const std::filesystem::path& path,
                      const std::string& field,
                      const std::string& text,
                      std::int64_t least);
/// The sizes of the axes. Throws UserError for none, more than kMostAxes, and absurd ones.
std::vector<std::uint64_t> sizes_in(const std::filesystem::path& path,
                                    const std::string& field,
                                    const std::string& text);

/// `text` without spaces at its ends.
std::string trimmed(std::string_view text);

}  // namespace wobblebench::bench
