#include "bench/exchange/surface/depth_map_file.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/file.h"
#include "base/near_name.h"
#include "bench/exchange/files/npy.h"
#include "bench/exchange/files/npz_reader.h"
#include "bench/output/encoders.h"

namespace wobblebench::bench {

namespace {

constexpr int kMostSide = 16384;

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

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

DepthMapFile read_picture(const std::filesystem::path& path, const DepthMapChoice& choice) {
  const DecodedPicture picture = encoders().decode(path, kMostSide);
  const std::size_t channel = index_of(picture.channels, choice.channel);
  DepthMapFile map{.format = extension_of(path) == ".exr" ? "EXR" : "TIFF",
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
std::pair<int, int> rows_and_columns(const NumpyArray& array) {
  std::vector<std::uint64_t> shape = array.shape;
  while (shape.size() > 2 && shape.front() == 1) shape.erase(shape.begin());
  while (shape.size() > 2 && shape.back() == 1) shape.pop_back();
  const bool is_picture = shape.size() == 2 && shape[0] <= kMostSide && shape[1] <= kMostSide &&
                          shape[0] > 0 && shape[1] > 0;
  if (is_picture) return {static_cast<int>(shape[0]), static_cast<int>(shape[1])};
  std::string text;
  for (const std::uint64_t size : array.shape) {
    text += (text.empty() ? "" : " x ") + std::to_string(size);
  }
  throw std::invalid_argument("has an array of shape " + (text.empty() ? "()" : text) +
                              "; must be rows x columns");
}

DepthMapFile map_of(NumpyArray array, const std::string& format, const std::string& name) {
  const auto [rows, columns] = rows_and_columns(array);
  return {.format = format,
          .channel = name,
          .width = columns,
          .height = rows,
          .values = std::move(array.values),
          .mask = {},
          .integers = array.is_integer()};
}

DepthMapFile read_arrays(const std::string& bytes, const DepthMapChoice& choice) {
  auto arrays = read_npz(bytes);
  std::vector<std::string> names;
  for (const auto& [name, array] : arrays) names.push_back(name);
  const std::size_t index = index_of(names, choice.channel);
  std::vector<bool> mask;
  if (!choice.mask.empty()) {
    const NumpyArray& found = arrays[index_of(names, choice.mask)].second;
    if (rows_and_columns(found) != rows_and_columns(arrays[index].second)) {
      throw std::invalid_argument("its mask \"" + choice.mask + "\" has another size than \"" +
                                  names[index] + "\"");
    }
    mask = mask_of(found.values);
  }
  DepthMapFile map = map_of(std::move(arrays[index].second), "npz", names[index]);
  map.mask = std::move(mask);
  return map;
}

}  // namespace

bool is_depth_map(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".exr" || extension == ".tif" || extension == ".tiff" ||
         extension == ".npy" || extension == ".npz";
}

DepthMapFile read_depth_map(const std::filesystem::path& path, const DepthMapChoice& choice) {
  const std::string extension = extension_of(path);
  if (extension == ".npz") return read_arrays(read_file(path), choice);
  if (extension != ".npy") {
    static_cast<void>(read_file(path, 1));  // says why a file cannot be read
    return read_picture(path, choice);
  }
  if (!choice.channel.empty() || !choice.mask.empty()) {
    throw std::invalid_argument("holds one array; --channel and --mask name those of an .npz");
  }
  return map_of(read_npy(read_file(path)), "npy", "");
}

}  // namespace wobblebench::bench
