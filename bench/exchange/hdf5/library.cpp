// The library that bench/exchange/files/hdf5_maps.cpp loads.
#include <hdf5.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "bench/exchange/files/hdf5_maps.h"

namespace wobblebench::bench {

namespace {

constexpr unsigned kCompression = 4;

/// A handle of the library, closed with its scope.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closer)(hid_t), const std::string& path) : id_(id), close_(closer) {
    if (id < 0) throw std::runtime_error(path + ": HDF5 cannot write it");
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;
  hid_t get() const { return id_; }
  /// 0 or more where it could be closed.
  herr_t close() { return close_(std::exchange(id_, -1)); }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

class ZeaFile : public Hdf5Maps {
 public:
  ZeaFile(const std::filesystem::path& path,
          const std::vector<std::pair<std::string, std::string>>& attributes)
      : path_(path.string()),
        file_(H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, path_),
        data_(make_groups()) {
    for (const auto& [name, text] : attributes) add_attribute(file_.get(), name, text);
  }

  void add_map(const Hdf5Map& map) override {
    const Handle group = make_group(data_.get(), map.name);
    maps_[map.name] = map;
    make_dataset(group.get(), "values", type_of(map.type), map.shape);
    if (!map.coordinates_shape.empty()) {
      make_dataset(group.get(), "coordinates", H5T_NATIVE_FLOAT, map.coordinates_shape, "m");
    }
    add_texts(group.get(), "unit", {map.unit}, true);
    add_texts(group.get(), "description", {map.description}, true);
    if (!map.labels.empty()) add_texts(group.get(), "labels", map.labels, false);
  }

  void write_values(const std::string& map, std::uint64_t volume, const void* values) override {
    const Hdf5Map& of = maps_.at(map);
    write(map + "/values", type_of(of.type), of.shape, volume, values);
  }
  void write_coordinates(const std::string& map,
                         std::uint64_t volume,
                         std::span<const float> coordinates_m) override {
    write(map + "/coordinates",
          H5T_NATIVE_FLOAT,
          maps_.at(map).coordinates_shape,
          volume,
          coordinates_m.data());
  }

  void finish() override {
    check(H5Fflush(file_.get(), H5F_SCOPE_LOCAL));
    check(data_.close());
    check(file_.close());
  }

 private:
  void check(herr_t result) const {
    if (result < 0) throw std::runtime_error(path_ + ": HDF5 cannot write it: is the disk full?");
  }

  Handle make_group(hid_t in, const std::string& name) const {
    return {H5Gcreate2(in, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path_};
  }
  Handle make_groups() const {
    const Handle tracks = make_group(file_.get(), "tracks");
    const Handle track = make_group(tracks.get(), "track_0");
    return make_group(track.get(), "data");
  }

  /// A boolean as h5py has it: an enumeration of FALSE and TRUE.
  hid_t type_of(MapType type) {
    if (type == MapType::f32) return H5T_NATIVE_FLOAT;
    if (type == MapType::u8) return H5T_NATIVE_UINT8;
    return boolean_.get();
  }
  Handle make_boolean() const {
    Handle type(H5Tenum_create(H5T_NATIVE_INT8), H5Tclose, path_);
    const signed char no = 0, yes = 1;
    check(H5Tenum_insert(type.get(), "FALSE", &no));
    check(H5Tenum_insert(type.get(), "TRUE", &yes));
    return type;
  }
  Handle text_type() const {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path_);
    check(H5Tset_size(type.get(), H5T_VARIABLE));
    check(H5Tset_cset(type.get(), H5T_CSET_UTF8));
    return type;
  }

  void add_attribute(hid_t to, const std::string& name, const std::string& text) const {
    const Handle type = text_type();
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, path_);
    const Handle attribute(
        H5Acreate2(to, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose,
        path_);
    const char* value = text.c_str();
    check(H5Awrite(attribute.get(), type.get(), &value));
  }

  void describe(hid_t dataset, const std::string& unit) const {
    add_attribute(dataset, "unit", unit);
    add_attribute(dataset, "description", "");
  }

  void add_texts(hid_t group,
                 const std::string& name,
                 const std::vector<std::string>& texts,
                 bool is_scalar) const {
    const Handle type = text_type();
    const hsize_t count = texts.size();
    const Handle space(
        is_scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose, path_);
    const Handle dataset(
        H5Dcreate2(
            group, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose,
        path_);
    std::vector<const char*> values;
    for (const auto& text : texts) values.push_back(text.c_str());
    check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    describe(dataset.get(), "-");
  }

  /// In chunks of planes of the first axes, compressed.
  void make_dataset(hid_t group,
                    const std::string& name,
                    hid_t type,
                    const std::vector<std::uint64_t>& shape,
                    const std::string& unit = "-") const {
    const std::vector<hsize_t> sizes(shape.begin(), shape.end());
    const Handle space(
        H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose, path_);
    std::vector<hsize_t> chunk = sizes;
    chunk[0] = 1;
    if (sizes.size() > 3) chunk[1] = std::min<hsize_t>(sizes[1], 32);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path_);
    check(H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data()));
    check(H5Pset_deflate(creation.get(), kCompression));
    const Handle dataset(
        H5Dcreate2(
            group, name.c_str(), type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
        H5Dclose,
        path_);
    describe(dataset.get(), unit);
  }

  /// One volume: a slab along the first axis, or all of what has no volumes.
  void write(const std::string& name,
             hid_t type,
             const std::vector<std::uint64_t>& shape,
             std::uint64_t volume,
             const void* values) const {
    const Handle dataset(H5Dopen2(data_.get(), name.c_str(), H5P_DEFAULT), H5Dclose, path_);
    const Handle space(H5Dget_space(dataset.get()), H5Sclose, path_);
    std::vector<hsize_t> start(shape.size(), 0), count(shape.begin(), shape.end());
    const bool has_volumes = name.ends_with("values") || shape.size() == 5;
    if (has_volumes) {
      start[0] = volume;
      count[0] = 1;
    }
    check(H5Sselect_hyperslab(
        space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
    const Handle memory(
        H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose, path_);
    check(H5Dwrite(dataset.get(), type, memory.get(), space.get(), H5P_DEFAULT, values));
  }

  std::string path_;
  Handle file_;
  Handle data_;
  Handle boolean_ = make_boolean();
  std::map<std::string, Hdf5Map> maps_;
};

}  // namespace

}  // namespace wobblebench::bench

extern "C" wobblebench::bench::Hdf5Maps* wobblebench_make_hdf5_maps(
    const std::filesystem::path& path,
    const std::vector<std::pair<std::string, std::string>>& attributes) {
  // Errors are told by exceptions.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return new wobblebench::bench::ZeaFile(path, attributes);
}
