#include "bench/exchange/surface/depth_map_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "base/file.h"
#include "base/near_name.h"
#include "bench/exchange/files/foreign_names.h"
#include "bench/exchange/files/npy.h"
#include "bench/exchange/files/npz_reader.h"
#include "bench/exchange/files/voxel_file.h"
#include "bench/output/encoders.h"

namespace wobblebench::bench {

namespace {

constexpr int kMostSide = 16384;

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Index of the wanted name; of "Z", or the only one, where none is wanted.
std::size_t index_of(const std::vector<std::string>& names, const std::string& wanted) {
  const std::string name = wanted.empty() ? (names.size() == 1 ? names.front() : "Z") : wanted;
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  if (wanted.empty()) {
    throw std::invalid_argument("holds " + joined(names) + ": --channel must name its depths");
  }
  throw std::invalid_argument("holds no \"" + wanted + "\"; it has " + joined(names) +
                              did_you_mean(wanted, names));
}

std::vector<bool> mask_of(const std::vector<double>& values) {
  std::vector<bool> mask;
  mask.reserve(values.size());
  for (const double value : values) mask.push_back(value != 0 && !std::isnan(value));
  return mask;
}

template <class Value>
std::optional<Value> attribute(const std::vector<std::pair<std::string, Value>>& attributes,
                               const std::string& name) {
  for (const auto& [key, value] : attributes) {
    if (key == name) return value;
  }
  return std::nullopt;
}

std::vector<double> channel_values(const DecodedPicture& picture, std::size_t channel) {
  std::vector<double> values;
  const std::size_t step = picture.channels.size();
  values.reserve(picture.values.size() / step);
  for (std::size_t i = channel; i < picture.values.size(); i += step) {
    values.push_back(picture.values[i]);
  }
  return values;
}

DepthMapFile read_picture(const std::filesystem::path& path,
                          const std::string& format,
                          const DepthMapChoice& choice) {
  const DecodedPicture picture = encoders().decode(path, kMostSide);
  const std::size_t channel = index_of(picture.channels, choice.channel);
  DepthMapFile map{.format = format,
                   .channel = picture.channels[channel],
                   .width = picture.width,
                   .height = picture.height,
                   .values = channel_values(picture, channel),
                   .mask = {},
                   .integers = picture.integers,
                   .unit = attribute(picture.texts, "units"),
                   .projection = attribute(picture.texts, "projection"),
                   .world_to_ndc = attribute(picture.matrices, "worldToNDC")};
  if (!choice.mask.empty()) {
    map.mask = mask_of(channel_values(picture, index_of(picture.channels, choice.mask)));
  }
  return map;
}

/// Sizes without those of length 1 at the end or the beginning: (1, 512, 512), (512, 512, 1).
std::pair<int, int> rows_and_columns(const NumpyShape& given) {
  NumpyShape shape = given;
  while (shape.size() > 2 && shape.front() == 1) shape.erase(shape.begin());
  while (shape.size() > 2 && shape.back() == 1) shape.pop_back();
  const bool is_picture = shape.size() == 2 && shape[0] <= kMostSide && shape[1] <= kMostSide &&
                          shape[0] > 0 && shape[1] > 0;
  if (is_picture) return {static_cast<int>(shape[0]), static_cast<int>(shape[1])};
  std::string text;
  for (const std::uint64_t size : given) text += (text.empty() ? "" : " x ") + std::to_string(size);
  throw std::invalid_argument("has an array of shape " + (text.empty() ? "()" : text) +
                              "; must be rows x columns");
}

/// Before memory is taken for it.
CheckShape check_of(const DepthMapChoice& choice) {
  return [size = choice.size](const NumpyShape& shape) {
    const auto [rows, columns] = rows_and_columns(shape);
    check_map_size(columns, rows, size);
  };
}

DepthMapFile map_of(NumpyArray array, const std::string& format, const std::string& name) {
  const auto [rows, columns] = rows_and_columns(array.shape);
  return {.format = format,
          .channel = name,
          .width = columns,
          .height = rows,
          .values = std::move(array.values),
          .mask = {},
          .integers = array.is_integer()};
}

DepthMapFile read_arrays(const std::string& bytes, const DepthMapChoice& choice) {
  const std::vector<NpzEntry> entries = npz_entries(bytes);
  std::vector<std::string> names;
  for (const NpzEntry& entry : entries) names.push_back(entry.name);
  const std::size_t index = index_of(names, choice.channel);
  DepthMapFile map = map_of(read_npz(entries[index], check_of(choice)), "npz", names[index]);
  if (choice.mask.empty()) return map;
  const NumpyArray mask = read_npz(entries[index_of(names, choice.mask)], check_of(choice));
  if (rows_and_columns(mask.shape) != std::pair(map.height, map.width)) {
    throw std::invalid_argument("its mask \"" + choice.mask + "\" has another size than \"" +
                                names[index] + "\"");
  }
  map.mask = mask_of(mask.values);
  return map;
}

/// One channel of floats, rows from the bottom; big-endian where the scale is above 0.
DepthMapFile read_pfm(const std::filesystem::path& path) {
  std::istringstream header(read_file(path, 100));
  std::string magic, width, height, scale;
  header >> magic >> width >> height >> scale;
  header.get();
  if (magic != "Pf" || !header) {
    throw std::invalid_argument(
        "is no PFM of one channel: must begin with Pf, columns, rows, scale");
  }
  VoxelFile file{.path = path,
                 .data_path = path,
                 .offset = static_cast<std::uint64_t>(header.tellg()),
                 .element = Element::float32,
                 .big_endian = !scale.starts_with('-'),
                 .sizes = sizes_in(path, "columns and rows", width + " " + height)};
  check_size(file);
  const std::vector<float> values = read_numbers(file, 0, file.voxels());
  DepthMapFile map{.format = "PFM",
                   .width = static_cast<int>(file.sizes[0]),
                   .height = static_cast<int>(file.sizes[1])};
  for (auto row = values.end(); row != values.begin(); row -= map.width) {
    map.values.insert(map.values.end(), row - map.width, row);
  }
  return map;
}

}  // namespace

void check_map_size(int width, int height, int size) {
  if (size == 0 || (width == size && height == size)) return;
  throw std::invalid_argument("has " + std::to_string(width) + " x " + std::to_string(height) +
                              " pixels; must be " + std::to_string(size) + " x " +
                              std::to_string(size) +
                              ", the size of the scene's view (render.ray_casting.image_size)");
}

std::string depth_map_format(const std::filesystem::path& path) {
  using enum ForeignFormat;
  static const std::map<ForeignFormat, std::string> maps = {
      {exr, "EXR"}, {tiff, "TIFF"}, {png, "PNG"}, {pfm, "PFM"}, {npy, "npy"}, {npz, "npz"}};
  const auto found = maps.find(foreign_format(path));
  return found == maps.end() ? "" : found->second;
}

DepthMapFile read_depth_map(const std::filesystem::path& path, const DepthMapChoice& choice) {
  const std::string format = depth_map_format(path);
  if (format == "npz") return read_arrays(read_file(path), choice);
  if (format != "npy" && format != "PFM") {
    static_cast<void>(read_file(path, 1));  // says why a file cannot be read
    return read_picture(path, format, choice);
  }
  if (!choice.channel.empty() || !choice.mask.empty()) {
    throw std::invalid_argument("holds one array; --channel and --mask name those of an .npz");
  }
  if (format == "PFM") return read_pfm(path);
  return map_of(read_npy(read_file(path), check_of(choice)), "npy", "");
}

}  // namespace wobblebench::bench
