#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "phantoms/import/hdf5_file.h"
#include "phantoms/import/parsers.h"
#include "phantoms/io/scatterer_file.h"

namespace wobblebench::phantoms {
namespace {

/// Length of a dataset of one dimension; a second one of length 1, as MATLAB writes, is allowed.
std::size_t length_of(hid_t dataset, const std::string& name) {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose, "a shape");
  std::array<hsize_t, 2> sizes{1, 1};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (H5Sget_simple_extent_type(space.get()) != H5S_SIMPLE || rank < 1 || rank > 2 ||
      H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr) != rank ||
      std::min(sizes[0], sizes[1]) > 1) {
    throw std::invalid_argument("dataset \"" + name + "\": must have one dimension");
  }
  if (std::max(sizes[0], sizes[1]) > kMostScattererRows) {
    throw std::invalid_argument("dataset \"" + name + "\": has more than " +
                                std::to_string(kMostScattererRows) + " values");
  }
  return sizes[0] * sizes[1];
}

void write_column(hid_t file, const std::string& name, MessageWriter& out) {
  const Hdf5Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "dataset " + name);
  check_numbers(dataset.get(), name);
  std::vector<double> values(length_of(dataset.get(), name));
  if (!values.empty() &&
      H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw std::invalid_argument("dataset \"" + name + "\": cannot be read");
  }
  out.text(name);
  out.list(std::span<const double>(values));
}

/// Calls body(name) for each dataset of the root group.
template <class Body>
void for_each_dataset(hid_t file, const Body& body) {
  constexpr hsize_t kMostObjects = 1000;
  H5G_info_t group{};
  if (H5Gget_info(file, &group) < 0) throw std::invalid_argument("has no readable root group");
  if (group.nlinks > kMostObjects) throw std::invalid_argument("holds more than 1000 objects");
  for (hsize_t i = 0; i < group.nlinks; ++i) {
    std::array<char, 64> text{};
    const ssize_t length = H5Lget_name_by_idx(
        file, ".", H5_INDEX_NAME, H5_ITER_INC, i, text.data(), text.size(), H5P_DEFAULT);
    const std::string name(text.data());
    if (length < 1 || !is_printable_text(name)) {
      throw std::invalid_argument("holds an object without a readable name");
    }
    H5L_info_t link{};
    if (H5Lget_info(file, name.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
      throw std::invalid_argument("\"" + name + "\": is a link, or has too long a name");
    }
    const Hdf5Handle object(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "object " + name);
    if (H5Iget_type(object.get()) == H5I_DATASET) body(name);
  }
}

}  // namespace

void write_hdf5_message(const std::filesystem::path& path, MessageWriter& out) {
  const Hdf5Handle file = open_hdf5(path);
  for_each_dataset(file.get(),
                   [&](const std::string& name) { write_column(file.get(), name, out); });
}

}  // namespace wobblebench::phantoms
