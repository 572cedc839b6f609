#include "bench/exchange/files/foreign_names.h"

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "bench/exchange/files/voxel_file.h"

namespace wobblebench::bench {

namespace {

using std::string_view_literals::operator""sv;

/// In lower case: MetaImage is a text.
constexpr std::pair<std::string_view, ForeignFormat> kFirstBytes[] = {
    {"wbst"sv, ForeignFormat::none},
    {"nrrd"sv, ForeignFormat::nrrd},
    {"objecttype"sv, ForeignFormat::meta_image},
    {"ndims"sv, ForeignFormat::meta_image},
    {"kretzfile"sv, ForeignFormat::kretz},
    {"\x89hdf\r\n\x1a\n"sv, ForeignFormat::zea},
    {"\x93numpy"sv, ForeignFormat::numpy},
    {"pk\x03\x04"sv, ForeignFormat::numpy}};

constexpr std::size_t kDicomAt = 128;

std::string first_bytes(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return "";
  return read_file(path, kDicomAt + 4);
}

ForeignFormat format_of_name(const std::string& extension) {
  static const std::map<std::string, ForeignFormat> formats = {{".mha", ForeignFormat::meta_image},
                                                               {".mhd", ForeignFormat::meta_image},
                                                               {".nrrd", ForeignFormat::nrrd},
                                                               {".nhdr", ForeignFormat::nrrd},
                                                               {".raw", ForeignFormat::raw},
                                                               {".img", ForeignFormat::raw},
                                                               {".vol", ForeignFormat::kretz},
                                                               {".hdf5", ForeignFormat::zea},
                                                               {".h5", ForeignFormat::zea},
                                                               {".npy", ForeignFormat::numpy},
                                                               {".npz", ForeignFormat::numpy},
                                                               {".dcm", ForeignFormat::dicom}};
  const auto found = formats.find(extension);
  return found == formats.end() ? ForeignFormat::none : found->second;
}

}  // namespace

ForeignFormat foreign_format(const std::filesystem::path& path) {
  const ForeignFormat named = format_of_name(lower_case(path.extension().string()));
  if (named == ForeignFormat::raw) return named;  // which may begin with anything
  const std::string bytes = lower_case(first_bytes(path));
  for (const auto& [first, format] : kFirstBytes) {
    if (bytes.starts_with(first)) return format;
  }
  if (bytes.ends_with("dicm") && bytes.size() == kDicomAt + 4) return ForeignFormat::dicom;
  return named;
}

}  // namespace wobblebench::bench
