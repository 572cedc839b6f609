#include "bench/exchange/files/meta_image.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kMostMetaHeader = 64 << 20;  // a sequence has fields for each frame

const std::vector<std::pair<std::string, Element>>& meta_types() {
  static const std::vector<std::pair<std::string, Element>> types = {
      {"MET_CHAR", Element::int8},
      {"MET_UCHAR", Element::uint8},
      {"MET_SHORT", Element::int16},
      {"MET_USHORT", Element::uint16},
      {"MET_INT", Element::int32},
      {"MET_UINT", Element::uint32},
      {"MET_FLOAT", Element::float32},
      {"MET_DOUBLE", Element::float64}};
  return types;
}

std::string type_name(Element element) {
  for (const auto& [name, type] : meta_types()) {
    if (type == element) return name;
  }
  return "";
}

template <class T>
std::string spaced(const std::vector<T>& values) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& value : values) text << " " << value;
  return text.str();
}

bool is_true(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text == "true" || text == "1";
}

/// The fields up to ElementDataFile, and where the voxels begin.
std::map<std::string, std::string> split_header(const std::filesystem::path& path,
                                                std::uint64_t& end) {
  const std::string text = read_file(path, kMostMetaHeader);
  std::map<std::string, std::string> fields;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t line_end = text.find('\n', at);
    const std::string_view line = std::string_view(text).substr(at, line_end - at);
    const std::size_t equals = line.find('=');
    if (line_end == std::string::npos || equals == std::string_view::npos) break;
    const std::string key = trimmed(line.substr(0, equals));
    fields[key] = trimmed(line.substr(equals + 1));
    at = line_end + 1;
    if (key != "ElementDataFile") continue;
    end = at;
    return fields;
  }
  throw UserError(path.string() +
                  ": is no MetaImage: no line of its header is ElementDataFile = LOCAL");
}

void read_positions(VoxelFile& file) {
  const auto value = [&](const std::vector<std::string>& names) {
    for (const auto& name : names) {
      const auto found = file.fields.find(name);
      if (found != file.fields.end()) return found;
    }
    return file.fields.end();
  };
  const std::size_t axes = file.sizes.size();
  const auto spacing = value({"ElementSpacing", "ElementSize"});
  if (spacing == file.fields.end()) return;
  const auto step = numbers_in(file.path, spacing->first, spacing->second, axes);
  std::vector<double> matrix(axes * axes, 0.0), offset(axes, 0.0);
  for (std::size_t i = 0; i < axes; ++i) matrix[i * axes + i] = 1;
  const auto turned = value({"TransformMatrix", "Orientation", "Rotation"});
  if (turned != file.fields.end()) {
    matrix = numbers_in(file.path, turned->first, turned->second, axes * axes);
  }
  const auto placed = value({"Offset", "Position", "Origin"});
  if (placed != file.fields.end()) {
    offset = numbers_in(file.path, placed->first, placed->second, axes);
  }
  const std::size_t in_space = std::min<std::size_t>(axes, 3);  // a fourth one is time
  for (std::size_t axis = 0; axis < in_space; ++axis) {
    glm::dvec3 direction(0);
    for (std::size_t k = 0; k < in_space; ++k) {
      direction[static_cast<int>(k)] = step[axis] * matrix[axis * axes + k];
    }
    file.directions_mm.emplace_back(direction);
    file.origin_mm[static_cast<int>(axis)] = offset[axis];
  }
}

Element read_element(const VoxelFile& file) {
  const auto found = file.fields.find("ElementType");
  const std::string name = found == file.fields.end() ? "" : found->second;
  for (const auto& [known, type] : meta_types()) {
    if (known == name) return type;
  }
  throw UserError(file.path.string() + ": ElementType = " + name +
                  ": must be MET_UCHAR, MET_CHAR, MET_USHORT, MET_SHORT, MET_UINT, MET_INT, "
                  "MET_FLOAT or MET_DOUBLE");
}

void refuse_true(const VoxelFile& file, const std::string& field, const std::string& why) {
  const auto found = file.fields.find(field);
  if (found == file.fields.end() || !is_true(found->second)) return;
  throw UserError(file.path.string() + ": " + field + " = " + found->second + ": " + why);
}

}  // namespace

std::string frame_field(std::size_t frame, const std::string& name) {
  std::string number(16, '\0');
  number.resize(
      static_cast<std::size_t>(std::snprintf(number.data(), number.size(), "%04zu", frame)));
  return "Seq_Frame" + number + "_" + name;
}

std::string meta_image_text(const MetaHeader& header) {
  std::ostringstream text;
  text << "ObjectType = Image\nNDims = " << header.sizes.size()
       << "\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
       << "TransformMatrix =" << spaced(header.directions) << "\nOffset ="
       << spaced<double>({header.origin_mm.x, header.origin_mm.y, header.origin_mm.z})
       << "\nCenterOfRotation = 0 0 0\nElementSpacing =" << spaced(header.spacing)
       << "\nDimSize =" << spaced(header.sizes)
       << "\nElementNumberOfChannels = 1\nElementType = " << type_name(header.element) << "\n";
  for (const auto& [key, value] : header.fields) text << key << " = " << value << "\n";
  text << "ElementDataFile = LOCAL\n";
  return text.str();
}

VoxelFile read_meta_image(const std::filesystem::path& path) {
  VoxelFile file{.path = path, .data_path = path};
  file.fields = split_header(path, file.offset);
  if (const std::string& data = file.fields["ElementDataFile"]; data != "LOCAL") {
    throw UserError(path.string() + ": ElementDataFile = " + data +
                    ": must be LOCAL: voxels follow the header in one file");
  }
  refuse_true(file, "CompressedData", "must be False: compressed voxels are not read");
  if (file.fields.contains("ElementNumberOfChannels") &&
      file.fields["ElementNumberOfChannels"] != "1") {
    throw UserError(path.string() + ": ElementNumberOfChannels = " +
                    file.fields["ElementNumberOfChannels"] + ": must be 1");
  }
  file.element = read_element(file);
  file.big_endian =
      is_true(file.fields["BinaryDataByteOrderMSB"]) || is_true(file.fields["ElementByteOrderMSB"]);
  file.sizes = sizes_in(path, "DimSize", file.fields["DimSize"]);
  if (numbers_in(path, "NDims", file.fields["NDims"], 1)[0] !=
      static_cast<double>(file.sizes.size())) {
    throw UserError(path.string() + ": NDims = " + file.fields["NDims"] + ": DimSize has " +
                    std::to_string(file.sizes.size()) + " numbers");
  }
  read_positions(file);
  check_size(file);
  return file;
}

}  // namespace wobblebench::bench
