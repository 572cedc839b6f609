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
#include "base/user_error.h"

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

template <class T>
std::vector<float> converted(const std::string& bytes, bool swap) {
  std::vector<float> values(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::array<char, sizeof(T)> raw;
    for (std::size_t k = 0; k < sizeof(T); ++k) {
      raw[swap ? sizeof(T) - 1 - k : k] = bytes[i * sizeof(T) + k];
    }
    values[i] = static_cast<float>(std::bit_cast<T>(raw));
  }
  return values;
}

std::vector<float> converted(const std::string& bytes, Element element, bool swap) {
  switch (element) {
    case Element::int8:
      return converted<std::int8_t>(bytes, false);
    case Element::uint8:
      return converted<std::uint8_t>(bytes, false);
    case Element::int16:
      return converted<std::int16_t>(bytes, swap);
    case Element::uint16:
      return converted<std::uint16_t>(bytes, swap);
    case Element::int32:
      return converted<std::int32_t>(bytes, swap);
    case Element::uint32:
      return converted<std::uint32_t>(bytes, swap);
    case Element::float32:
      return converted<float>(bytes, swap);
    case Element::float64:
      return converted<double>(bytes, swap);
  }
  throw std::logic_error("an element without a name");
}

}  // namespace

std::size_t element_bytes(Element element) {
  constexpr std::array<std::size_t, 8> bytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return bytes.at(static_cast<std::size_t>(element));
}

std::string_view element_name(Element element) {
  constexpr std::array<std::string_view, 8> names = {
      "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
  return names.at(static_cast<std::size_t>(element));
}

std::optional<Element> element_of(const ElementNames& names, std::string_view name) {
  const std::string wanted = "|" + lower_case(name) + "|";
  for (const auto& [element, known] : names) {
    if (lower_case(known).find(wanted) != std::string::npos) return element;
  }
  return {};
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
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

std::vector<float> read_voxels(const VoxelFile& file, std::uint64_t first, std::uint64_t count) {
  const Element element = file.kept_as.value_or(file.element);
  const std::uint64_t size = element_bytes(element);
  const std::string bytes = read_at(file, file.offset + first * size, count * size);
  const bool swap = file.big_endian != (std::endian::native == std::endian::big);
  auto values = converted(bytes, element, swap);
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
  constexpr double kMost = 1e15;
  const double number = number_in(text).value_or(-HUGE_VAL);
  if (number >= static_cast<double>(least) && number <= kMost && number == std::floor(number)) {
    return static_cast<std::int64_t>(number);
  }
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
