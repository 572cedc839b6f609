#include "phantoms/import/parsers.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "phantoms/io/scatterer_file.h"

namespace wobblebench::phantoms {
namespace {

/// A handle of the library, closed with its scope.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw std::invalid_argument("not a readable HDF5 file (" + what + ")");
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Values that lie in other files are not read: a list must not name the files of who reads it.
void check_storage(hid_t dataset, const std::string& name) {
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose, "its storage");
  if (H5Pget_external_count(creation.get()) == 0 && H5Pget_layout(creation.get()) != H5D_VIRTUAL) {
    return;
  }
  throw std::invalid_argument("dataset \"" + name + "\": its values lie in other files");
}

void check_type(hid_t dataset, const std::string& name) {
  const Handle type(H5Dget_type(dataset), H5Tclose, "a type");
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind == H5T_INTEGER || kind == H5T_FLOAT) return;
  throw std::invalid_argument("dataset \"" + name + "\": must hold numbers");
}

/// Length of a dataset of one dimension; a second one of length 1, as MATLAB writes, is allowed.
std::size_t length_of(hid_t dataset, const std::string& name) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "a shape");
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
  const Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "dataset " + name);
  check_type(dataset.get(), name);
  check_storage(dataset.get(), name);
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
    const Handle object(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "object " + name);
    if (H5Iget_type(object.get()) == H5I_DATASET) body(name);
  }
}

}  // namespace

void write_hdf5_message(const std::filesystem::path& path, MessageWriter& out) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);  // no code that a file names
  const Handle file(
      H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "it cannot be opened as one");
  for_each_dataset(file.get(),
                   [&](const std::string& name) { write_column(file.get(), name, out); });
}

}  // namespace wobblebench::phantoms
