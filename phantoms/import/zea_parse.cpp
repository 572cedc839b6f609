#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "phantoms/import/hdf5_file.h"
#include "phantoms/import/parsers.h"

namespace wobblebench::phantoms {
namespace {

using Sizes = std::vector<std::uint64_t>;

/// Whether a path of hard links leads there.
bool exists(hid_t file, const std::string& path) {
  for (std::size_t end = 0; end != std::string::npos;) {
    end = path.find('/', end + 1);
    const std::string part = path.substr(0, end);
    if (H5Lexists(file, part.c_str(), H5P_DEFAULT) <= 0) return false;
    H5L_info_t link{};
    if (H5Lget_info(file, part.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
      throw std::invalid_argument("\"" + part + "\": is a link to elsewhere");
    }
  }
  return true;
}

/// The group, or in older files the dataset, of the picture.
std::string picture_in(hid_t file) {
  if (exists(file, "tracks/track_1"))
    throw std::invalid_argument("holds several tracks; must hold one");
  for (const char* data : {"tracks/track_0/data", "data"}) {
    for (const char* name : {"image", "envelope_data"}) {
      std::string path = std::string(data) + "/" + name;
      if (exists(file, path)) return path;
    }
  }
  throw std::invalid_argument("holds neither data/image nor data/envelope_data, as zea has them");
}

Sizes sizes_of(hid_t dataset, const std::string& name) {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose, "a shape");
  constexpr int kMostRank = 5;
  std::array<hsize_t, kMostRank> sizes{};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (H5Sget_simple_extent_type(space.get()) != H5S_SIMPLE || rank < 1 || rank > kMostRank ||
      H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr) != rank) {
    throw std::invalid_argument("dataset \"" + name + "\": must have 1 to 5 dimensions");
  }
  double values = 1;
  for (int i = 0; i < rank; ++i)
    values *= static_cast<double>(sizes.at(static_cast<std::size_t>(i)));
  if (!(values >= 1)) throw std::invalid_argument("dataset \"" + name + "\": is empty");
  check_bytes(values * sizeof(float), "");
  return {sizes.begin(), sizes.begin() + rank};
}

bool is_bytes(hid_t dataset) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose, "a type");
  return H5Tget_class(type.get()) == H5T_INTEGER && H5Tget_size(type.get()) == 1 &&
         H5Tget_sign(type.get()) == H5T_SGN_NONE;
}

/// Writes whether the numbers are bytes, the sizes, slowest first, and the values as floats.
void write_numbers(hid_t file, const std::string& name, MessageWriter& out) {
  const Hdf5Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "dataset " + name);
  check_numbers(dataset.get(), name);
  const Sizes sizes = sizes_of(dataset.get(), name);
  std::uint64_t count = 1;
  for (const std::uint64_t size : sizes) count *= size;
  constexpr std::uint64_t kMostRatio = 10'000;  // more than filters make of real pictures
  const std::uint64_t stored = H5Dget_storage_size(dataset.get());
  if (count / kMostRatio > stored) {
    throw std::invalid_argument("dataset \"" + name + "\": claims " + std::to_string(count) +
                                " numbers, of which it stores " + std::to_string(stored) +
                                " bytes");
  }
  std::vector<float> values(count);
  if (H5Dread(dataset.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw std::invalid_argument("dataset \"" + name + "\": cannot be read");
  }
  out.put(std::uint32_t{is_bytes(dataset.get()) ? 1U : 0U});
  out.list(std::span<const std::uint64_t>(sizes));
  out.list(std::span<const float>(values));
}

/// A text attribute of the file; empty where there is none.
std::string description_of(hid_t file) {
  if (H5Aexists(file, "description") <= 0) return "";
  const Hdf5Handle attribute(H5Aopen(file, "description", H5P_DEFAULT), H5Aclose, "an attribute");
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose, "a type");
  const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose, "a shape");
  const bool is_one = H5Sget_simple_extent_npoints(space.get()) == 1;
  if (!is_one || H5Tis_variable_str(type.get()) <= 0) return "";
  char* text = nullptr;
  if (H5Aread(attribute.get(), type.get(), &text) < 0 || text == nullptr) return "";
  constexpr std::size_t kMostText = 10'000;
  return std::string(text).substr(0, kMostText);
}

bool is_dataset(hid_t file, const std::string& path) {
  const Hdf5Handle object(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose, "object " + path);
  return H5Iget_type(object.get()) == H5I_DATASET;
}

}  // namespace

void write_zea_message(const std::filesystem::path& path, MessageWriter& out) {
  const Hdf5Handle file = open_hdf5(path);
  const std::string picture = picture_in(file.get());
  const bool is_plain = is_dataset(file.get(), picture);
  if (!is_plain && !exists(file.get(), picture + "/values")) {
    throw std::invalid_argument("\"" + picture + "\": has no values");
  }
  out.text(picture);
  out.text(description_of(file.get()));
  write_numbers(file.get(), is_plain ? picture : picture + "/values", out);
  const std::string coordinates = picture + "/coordinates";
  const bool has_coordinates = !is_plain && exists(file.get(), coordinates);
  out.put(std::uint32_t{has_coordinates ? 1U : 0U});
  if (has_coordinates) write_numbers(file.get(), coordinates, out);
}

}  // namespace wobblebench::phantoms
