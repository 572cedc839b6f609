// What the parsers of HDF5 files share. Only for phantoms/import.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "base/text.h"

namespace wobblebench::phantoms {

/// A handle of the library, closed with its scope. Throws std::invalid_argument for one that could
/// not be had.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw std::invalid_argument("not a readable HDF5 file (" + what + ")");
  }
  ~Hdf5Handle() { close_(id_); }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Opens a file; code that it names is not loaded, and the library prints nothing.
inline Hdf5Handle open_hdf5(const std::filesystem::path& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);
  return {
      H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "it cannot be opened as one"};
}

/// Names the compression that this machine's library cannot undo.
inline void check_filters(hid_t creation, const std::string& name) {
  for (int i = 0; i < H5Pget_nfilters(creation); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    char filter[64] = "";
    const H5Z_filter_t id = H5Pget_filter2(creation,
                                           static_cast<unsigned>(i),
                                           &flags,
                                           &values,
                                           nullptr,
                                           sizeof filter,
                                           filter,
                                           &config);
    if (id >= 0 && H5Zfilter_avail(id) > 0) continue;
    filter[sizeof filter - 1] = '\0';
    const bool is_named = filter[0] != '\0' && is_printable_text(filter);
    throw std::invalid_argument("dataset \"" + name + "\": is stored by filter " +
                                std::to_string(id) +
                                (is_named ? " (" + std::string(filter) + ")" : "") +
                                ", which is not read; gzip is (h5repack -f GZIP=4)");
  }
}

/// Throws std::invalid_argument where a dataset holds no numbers, or its values lie in other files:
/// a list must not name the files of who reads it.
inline void check_numbers(hid_t dataset, const std::string& name) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose, "a type");
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) {
    throw std::invalid_argument("dataset \"" + name + "\": must hold numbers");
  }
  const Hdf5Handle creation(H5Dget_create_plist(dataset), H5Pclose, "its storage");
  check_filters(creation.get(), name);
  if (H5Pget_external_count(creation.get()) == 0 && H5Pget_layout(creation.get()) != H5D_VIRTUAL) {
    return;
  }
  throw std::invalid_argument("dataset \"" + name + "\": its values lie in other files");
}

}  // namespace wobblebench::phantoms
