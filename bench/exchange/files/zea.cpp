#include "bench/exchange/files/zea.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>

#include "base/user_error.h"
#include "bench/exchange/files/stored_voxels.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"

namespace wobblebench::bench {

namespace {

/// An array of the message; sizes slowest first.
struct Numbers {
  bool are_bytes = false;
  std::vector<std::uint64_t> sizes;
  std::vector<float> values;
};

template <class T>
std::vector<T> list_of(phantoms::MessageReader& message) {
  const std::string_view bytes = message.list<T>();
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

Numbers numbers_of(phantoms::MessageReader& message) {
  Numbers numbers;
  numbers.are_bytes = message.get<std::uint32_t>() != 0;
  numbers.sizes = list_of<std::uint64_t>(message);
  numbers.values = list_of<float>(message);
  std::uint64_t count = 1;
  bool fits = true;
  for (const std::uint64_t size : numbers.sizes) {
    fits = fits && size >= 1 && size <= numbers.values.size() / count;  // so that nothing wraps
    if (fits) count *= size;
  }
  if (!fits || count != numbers.values.size()) {
    throw std::invalid_argument("is damaged: its sizes differ");
  }
  return numbers;
}

/// "KEY VALUE; …" of a description that `export` wrote.
HeaderFields fields_in(const std::string& description) {
  HeaderFields fields;
  for (std::size_t from = 0; from < description.size();) {
    const std::size_t end = std::min(description.find(';', from), description.size());
    const std::string part = trimmed(std::string_view(description).substr(from, end - from));
    const std::size_t space = part.find(' ');
    if (part.starts_with("wobblebench_") && space != std::string::npos) {
      fields[part.substr(0, space)] = part.substr(space + 1);
    }
    from = end + 1;
  }
  return fields;
}

/// Of the first volume: they may differ from one to the next.
std::vector<glm::dvec3> coordinates_of(const Numbers& numbers, const Numbers& picture) {
  const auto& sizes = numbers.sizes;
  const std::vector<std::uint64_t> voxels(picture.sizes.begin() + 1, picture.sizes.end());
  const std::size_t rank = voxels.size();
  const bool fits =
      (sizes.size() == rank + 1 || sizes.size() == rank + 2) && sizes.back() == 3 &&
      std::equal(voxels.begin(), voxels.end(), sizes.end() - 1 - static_cast<std::ptrdiff_t>(rank));
  if (!fits) throw std::invalid_argument("its coordinates are not those of its values");
  std::uint64_t count = 1;
  for (const std::uint64_t size : voxels) count *= size;
  std::vector<glm::dvec3> positions(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const float* at = numbers.values.data() + 3 * i;
    positions[i] = {at[0], at[1], at[2]};
    if (std::isfinite(at[0] + at[1] + at[2])) continue;
    throw std::invalid_argument("coordinate " + std::to_string(i) + " is no finite number");
  }
  return positions;
}

/// No echo at all is -infinity dB.
void make_finite(std::vector<float>& values_db) {
  std::ranges::replace(
      values_db, -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::lowest());
}

ZeaPicture picture_of(const std::filesystem::path& path, phantoms::MessageReader message) {
  ZeaPicture picture;
  picture.file.path = path;
  picture.is_envelope = message.text().ends_with("envelope_data");
  picture.file.fields = fields_in(message.text());
  Numbers numbers = numbers_of(message);
  if (numbers.sizes.size() != 3 && numbers.sizes.size() != 4) {
    throw std::invalid_argument("has values of " + std::to_string(numbers.sizes.size()) +
                                " axes; must have volumes, z, x and y, or frames, z and x");
  }
  picture.file.sizes.assign(numbers.sizes.rbegin(), numbers.sizes.rend());
  if (numbers.are_bytes) {
    picture.file.element = Element::uint8;
    const std::vector<std::uint8_t> bytes(numbers.values.begin(), numbers.values.end());
    keep_in_memory(picture.file, std::as_bytes(std::span(bytes)));
  } else {
    picture.file.element = Element::float32;
    if (!picture.is_envelope) make_finite(numbers.values);
    keep_in_memory(picture.file, std::as_bytes(std::span(numbers.values)));
  }
  if (message.get<std::uint32_t>() != 0) {
    picture.coordinates_m = coordinates_of(numbers_of(message), numbers);
  }
  return picture;
}

}  // namespace

ZeaPicture read_zea(const std::filesystem::path& path) {
  try {
    const phantoms::ImportedBytes bytes(phantoms::ImportFormat::zea, path);
    return picture_of(path, phantoms::MessageReader(bytes.message()));
  } catch (const std::invalid_argument& error) {
    throw UserError(path.string() + ": " + error.what());
  } catch (const phantoms::ImportUnavailable& error) {
    throw UserError(path.string() + ": " + error.what());
  }
}

}  // namespace wobblebench::bench
