#include "bench/exchange/files/foreign_names.h"

#include <string>
#include <string_view>

#include "base/file.h"
#include "base/text.h"

namespace wobblebench::bench {

namespace {

struct KnownFormat {
  ForeignFormat format;
  std::string_view first;    ///< bytes, in lower case: MetaImage is a text
  std::string_view endings;  ///< of names
};

}  // namespace

ForeignFormat foreign_format(const std::filesystem::path& path) {
  using enum ForeignFormat;
  static constexpr KnownFormat kFormats[] = {{none, "wbst", ""},
                                             {meta_image, "objecttype", "|.mha|.mhd|"},
                                             {meta_image, "ndims", ""},
                                             {nrrd, "nrrd", "|.nrrd|.nhdr|"},
                                             {kretz, "kretzfile", "|.vol|"},
                                             {zea, "\x89hdf\r\n\x1a\n", "|.hdf5|.h5|"},
                                             {exr, "v/1\x01", "|.exr|"},
                                             {tiff, {"ii*\0", 4}, "|.tif|.tiff|"},
                                             {tiff, {"mm\0*", 4}, ""},
                                             {png, "\x89png", "|.png|"},
                                             {pfm, "pf\n", "|.pfm|"},
                                             {npy, "\x93numpy", "|.npy|"},
                                             {npz, "pk\x03\x04", "|.npz|"},
                                             {dicom, {}, "|.dcm|"},
                                             {raw, {}, "|.raw|.img|"}};
  constexpr std::size_t kDicomAt = 128;
  const std::string ending = "|" + lower_case(path.extension().string()) + "|";
  std::error_code error;
  ForeignFormat named = none;
  for (const KnownFormat& known : kFormats) {
    if (known.endings.find(ending) != std::string_view::npos) named = known.format;
  }
  if (named == raw || !std::filesystem::is_regular_file(path, error)) return named;
  const std::string bytes = lower_case(read_file(path, kDicomAt + 4));
  for (const KnownFormat& known : kFormats) {
    if (!known.first.empty() && bytes.starts_with(known.first)) return known.format;
  }
  return bytes.size() > kDicomAt && bytes.ends_with("dicm") ? dicom : named;
}

}  // namespace wobblebench::bench
