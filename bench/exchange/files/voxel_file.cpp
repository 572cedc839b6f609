#include "bench/exchange/files/voxel_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "base/file.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/exchange/files/numpy_parts.h"

namespace wobblebench::bench {

namespace {

/// More voxels along an axis, or in all, than any scan has.
constexpr double kMostAlong = 1e6, kMostVoxels = 1e11;

std::string read_at(const VoxelFile& file, std::uint64_t offset, std::uint64_t count) {
  const FileDescriptor data(::open(file.data_path.c_str(), O_RDONLY | O_CLOEXEC));
  std::string bytes(count, '\0');
  std::uint64_t done = 0;
  while (data.is_open() && done < count) {
    const ssize_t got =
        ::pread(data.get(), bytes.data() + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) break;
    if (got == 0) throw UserError(file.data_path.string() + ": ends before its last voxel");
    done += static_cast<std::uint64_t>(got);
  }
  if (done == count) return bytes;
  throw std::runtime_error(file.data_path.string() + ": cannot be read: " + std::strerror(errno));
}

struct ElementKind {
  std::string_view name;
  std::size_t bytes;
  double (*value)(const char* bytes, bool swap);
};

const ElementKind& kind_of(Element element) {
  using numpy::value_of;
  static constexpr std::array<ElementKind, 8> kinds = {{{"int8", 1, value_of<std::int8_t>},
                                                        {"uint8", 1, value_of<std::uint8_t>},
                                                        {"int16", 2, value_of<std::int16_t>},
                                                        {"uint16", 2, value_of<std::uint16_t>},
                                                        {"int32", 4, value_of<std::int32_t>},
                                                        {"uint32", 4, value_of<std::uint32_t>},
                                                        {"float32", 4, value_of<float>},
                                                        {"float64", 8, value_of<double>}}};
  return kinds.at(static_cast<std::size_t>(element));
}

}  // namespace

std::size_t element_bytes(Element element) {
  return kind_of(element).bytes;
}

std::string_view element_name(Element element) {
  return kind_of(element).name;
}

std::optional<Element> element_of(const ElementNames& names, std::string_view name) {
  const std::string wanted = "|" + lower_case(name) + "|";
  for (const auto& [element, known] : names) {
    if (lower_case(known).find(wanted) != std::string::npos) return element;
  }
  return {};
}

const HeaderFields::value_type* field_of(const HeaderFields& fields,
                                         std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (const auto found = fields.find(name); found != fields.end()) return &*found;
  }
  return nullptr;
}

std::uint64_t VoxelFile::voxels() const {
  std::uint64_t count = 1;
  for (const auto size : sizes) count *= size;
  return count;
}

void check_size(const VoxelFile& file) {
  std::error_code error;
  const auto there = std::filesystem::file_size(file.data_path, error);
  if (error) throw UserError(file.data_path.string() + ": " + error.message());
  const std::uint64_t needed = file.offset + file.voxels() * element_bytes(file.element);
  if (there == needed) return;
  std::string sizes;
  for (const auto size : file.sizes) sizes += (sizes.empty() ? "" : " x ") + std::to_string(size);
  throw UserError(file.data_path.string() + ": has " + std::to_string(there) + " bytes; " + sizes +
                  " voxels of " + std::string(element_name(file.element)) + " from byte " +
                  std::to_string(file.offset) + " on need " + std::to_string(needed));
}

std::vector<float> read_numbers(const VoxelFile& file, std::uint64_t first, std::uint64_t count) {
  const ElementKind& kind = kind_of(file.kept_as.value_or(file.element));
  const std::string bytes = read_at(file, file.offset + first * kind.bytes, count * kind.bytes);
  const bool swap = file.big_endian != (std::endian::native == std::endian::big);
  std::vector<float> values(count);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(kind.value(bytes.data() + i * kind.bytes, swap));
  }
  return values;
}

std::vector<float> read_voxels(const VoxelFile& file, std::uint64_t first, std::uint64_t count) {
  auto values = read_numbers(file, first, count);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw UserError(file.path.string() + ": voxel " + std::to_string(first + i) +
                    " is no finite number; must be one");
  }
  return values;
}

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

std::vector<double> numbers_in(const std::filesystem::path& path,
                               const std::string& field,
                               const std::string& text,
                               std::size_t count) {
  std::vector<double> numbers;
  std::istringstream words(text);
  bool good = true;
  for (std::string word; words >> word;) {
    const auto number = number_in(word);
    good = good && number;
    numbers.push_back(number.value_or(0));
  }
  if (good && numbers.size() == count) return numbers;
  throw UserError(path.string() + ": " + field + " = " + text + ": must be " +
                  std::to_string(count) + " numbers");
}

std::int64_t whole_in(const std::filesystem::path& path,
                      const std::string& field,
                      const std::string& text,
                      std::int64_t least) {
  const double number = number_in(text).value_or(-HUGE_VAL);
  const bool is_whole = number <= 1e15 && number == std::floor(number);
  if (is_whole && number >= static_cast<double>(least)) return static_cast<std::int64_t>(number);
  throw UserError(path.string() + ": " + field + " = " + text + ": must be a whole number from " +
                  std::to_string(least) + " on");
}

std::vector<std::uint64_t> sizes_in(const std::filesystem::path& path,
                                    const std::string& field,
                                    const std::string& text) {
  std::vector<std::uint64_t> sizes;
  std::istringstream words(text);
  double voxels = 1;
  bool good = true;
  for (std::string word; words >> word;) {
    const double size = number_in(word).value_or(0);
    good = good && size >= 1 && size <= kMostAlong && size == std::floor(size);
    voxels *= size;
    sizes.push_back(good ? static_cast<std::uint64_t>(size) : 0);
  }
  if (good && !sizes.empty() && sizes.size() <= kMostAxes && voxels <= kMostVoxels) return sizes;
  throw UserError(path.string() + ": " + field + " = " + text +
                  ": must be 1 to 4 whole numbers from 1 to 1000000, with at most 10^11 voxels");
}

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

}  // namespace wobblebench::bench
