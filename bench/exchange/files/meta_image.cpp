#include "bench/exchange/files/meta_image.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "base/file.h"
#include "base/number_text.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/exchange/files/stored_voxels.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kMostMetaHeader = 64 << 20;  // a sequence has fields for each frame

const ElementNames kMetaTypes = {{Element::int8, "|MET_CHAR|"},
                                 {Element::uint8, "|MET_UCHAR|"},
                                 {Element::int16, "|MET_SHORT|"},
                                 {Element::uint16, "|MET_USHORT|"},
                                 {Element::int32, "|MET_INT|"},
                                 {Element::uint32, "|MET_UINT|"},
                                 {Element::float32, "|MET_FLOAT|"},
                                 {Element::float64, "|MET_DOUBLE|"}};

std::string type_name(Element element) {
  const auto found = std::ranges::find(kMetaTypes, element, &ElementNames::value_type::first);
  return std::string(found->second.substr(1, found->second.size() - 2));
}

template <class T>
std::string spaced(const std::vector<T>& values) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& value : values) text << " " << value;
  return text.str();
}

/// Of a field; none: it is not given.
std::optional<bool> flag_of(const VoxelFile& file, std::initializer_list<const char*> names) {
  const auto* found = field_of(file.fields, names);
  if (found == nullptr) return {};
  const std::string value = lower_case(found->second);
  if (value == "true" || value == "1") return true;
  if (value == "false" || value == "0") return false;
  throw UserError(file.path.string() + ": " + found->first + " = " + found->second +
                  ": must be True or False");
}

/// The fields up to ElementDataFile, and where the voxels begin.
HeaderFields split_header(const std::filesystem::path& path, std::uint64_t& end) {
  const std::string text = read_file(path, kMostMetaHeader);
  HeaderFields fields;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t line_end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, line_end - at);
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) break;
    const std::string key = trimmed(line.substr(0, equals));
    fields[key] = trimmed(line.substr(equals + 1));
    at = line_end + 1;
    if (lower_case(key) != "elementdatafile") continue;
    end = std::min(at, text.size());
    return fields;
  }
  throw UserError(path.string() + ": is no MetaImage: its header has no ElementDataFile");
}

void read_positions(VoxelFile& file) {
  const std::size_t axes = file.sizes.size();
  const auto* spacing = field_of(file.fields, {"ElementSpacing", "ElementSize"});
  if (spacing == nullptr) file.missing = "ElementSpacing is missing";
  if (spacing == nullptr) return;
  const auto numbers = [&](const HeaderFields::value_type& field, std::size_t count) {
    return numbers_in(file.path, field.first, field.second, count);
  };
  const auto step = numbers(*spacing, axes);
  std::vector<double> matrix(axes * axes, 0.0), offset(axes, 0.0);
  for (std::size_t i = 0; i < axes; ++i) matrix[i * axes + i] = 1;
  const auto* turned = field_of(file.fields, {"TransformMatrix", "Orientation", "Rotation"});
  if (turned != nullptr) matrix = numbers(*turned, axes * axes);
  const auto* placed = field_of(file.fields, {"Offset", "Position", "Origin"});
  if (placed != nullptr) offset = numbers(*placed, axes);
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
  const auto* found = field_of(file.fields, {"ElementType"});
  const std::string name = found == nullptr ? "" : found->second;
  if (const auto element = element_of(kMetaTypes, name)) return *element;
  throw UserError(file.path.string() + ": ElementType = " + name +
                  ": must be MET_UCHAR, MET_CHAR, MET_USHORT, MET_SHORT, MET_UINT, MET_INT, "
                  "MET_FLOAT or MET_DOUBLE");
}

StoredVoxels stored_voxels(const VoxelFile& file) {
  StoredVoxels stored{.field = "ElementDataFile"};
  const std::string& data = file.fields.at(stored.field);
  if (lower_case(data) != "local") stored.file = data;
  const bool is_deflated = flag_of(file, {"CompressedData"}).value_or(false);
  const bool is_text = !flag_of(file, {"BinaryData"}).value_or(true);
  if (is_deflated || is_text) {
    stored.as = is_deflated ? StoredVoxels::As::deflated : StoredVoxels::As::text;
  }
  const auto whole = [&](const char* name, std::int64_t least) -> std::optional<std::int64_t> {
    const auto* found = field_of(file.fields, {name});
    if (found == nullptr) return {};
    return whole_in(file.path, name, found->second, least);
  };
  stored.skipped_bytes = whole("HeaderSize", -1).value_or(0);
  if (is_deflated) stored.bytes = whole("CompressedDataSize", 0);
  return stored;
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
  const auto* channels = field_of(file.fields, {"ElementNumberOfChannels"});
  if (channels != nullptr && channels->second != "1") {
    throw UserError(path.string() + ": ElementNumberOfChannels = " + channels->second +
                    ": must be 1");
  }
  file.element = read_element(file);
  file.big_endian =
      flag_of(file, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}).value_or(false);
  file.sizes = sizes_in(path, "DimSize", file.fields["DimSize"]);
  if (numbers_in(path, "NDims", file.fields["NDims"], 1)[0] !=
      static_cast<double>(file.sizes.size())) {
    throw UserError(path.string() + ": NDims = " + file.fields["NDims"] + ": DimSize has " +
                    std::to_string(file.sizes.size()) + " numbers");
  }
  read_positions(file);
  take_voxels(stored_voxels(file), file);
  return file;
}

}  // namespace wobblebench::bench
