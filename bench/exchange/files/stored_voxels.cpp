#include "bench/exchange/files/stored_voxels.h"

#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/exchange/files/inflate.h"
#include "bench/scene/scene_cost.h"

namespace wobblebench::bench {

namespace {

/// In the header's folder or below: a header must not name other files of who reads it.
std::filesystem::path beside(const std::filesystem::path& header, const StoredVoxels& stored) {
  std::filesystem::path name = stored.file, path = header.parent_path() / name;
  const bool is_below = name.is_relative() && std::ranges::count(name, "..") == 0;
  std::error_code error;
  if (is_below && std::filesystem::is_regular_file(path, error)) return path;
  throw UserError(header.string() + ": " + stored.field + " = " + stored.file + ": must be " +
                  (is_below ? "one file that is there" : "a file in the header's folder"));
}

void skip_lines(VoxelFile& file, std::int64_t lines) {
  constexpr std::size_t kMostSkipped = 1 << 20;
  if (lines == 0) return;
  const std::string text = read_file(file.data_path, file.offset + kMostSkipped);
  for (; lines > 0; --lines) {
    const std::size_t end = text.find('\n', file.offset);
    if (end == std::string::npos) {
      throw UserError(file.data_path.string() + ": has fewer lines than line skip says");
    }
    file.offset = end + 1;
  }
}

void inflate_voxels(const std::string& stored, VoxelFile& file) {
  const std::uint64_t size = file.voxels() * element_bytes(file.element);
  const std::string voxels = inflated(stored, size, kZlibOrGzip, true);
  keep_in_memory(file, std::as_bytes(std::span(voxels)));
}

/// Numbers with white space between them, kept as doubles.
void read_text(const std::string& stored, VoxelFile& file) {
  std::istringstream words(stored);
  std::vector<double> values;
  for (std::string word; words >> word;) {
    const auto value = number_in(word);
    if (!value) {
      throw std::invalid_argument("hold no finite number at index " +
                                  std::to_string(values.size()));
    }
    values.push_back(*value);
  }
  if (values.size() != file.voxels()) {
    throw std::invalid_argument("are " + std::to_string(values.size()) + " numbers; must be " +
                                std::to_string(file.voxels()));
  }
  keep_in_memory(file, std::as_bytes(std::span(values)));
  file.big_endian = std::endian::native == std::endian::big;
  file.kept_as = Element::float64;
}

}  // namespace

void check_half_of_memory(const std::filesystem::path& path, double bytes) {
  const double most = 0.5 * available_memory_bytes();
  if (bytes <= most) return;
  throw UserError(path.string() + ": its samples need " + significant(bytes / 1e9, 3) +
                  " GB of memory; must be at most " + significant(most / 1e9, 3) + " GB");
}

void keep_in_memory(VoxelFile& file, std::span<const std::byte> bytes) {
  file.memory = std::make_shared<FileDescriptor>(::memfd_create("wobblebench", MFD_CLOEXEC));
  if (!file.memory->is_open() ||
      !write_all(file.memory->get(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()})) {
    throw std::runtime_error(file.path.string() +
                             ": cannot be kept in memory: " + std::strerror(errno));
  }
  file.data_path = "/proc/self/fd/" + std::to_string(file.memory->get());
  file.offset = 0;
}

void take_voxels(const StoredVoxels& stored, VoxelFile& file) {
  if (!stored.file.empty()) {
    file.data_path = beside(file.path, stored);
    file.offset = 0;
  }
  skip_lines(file, stored.skipped_lines);
  const std::uint64_t size = std::filesystem::file_size(file.data_path);
  const std::uint64_t there = size - std::min(size, file.offset);
  const std::uint64_t needed = file.voxels() * element_bytes(file.element);
  if (stored.as == StoredVoxels::As::raw) {
    const bool are_last = stored.skipped_bytes < 0 && needed <= there;
    file.offset += are_last ? there - needed : std::max<std::int64_t>(0, stored.skipped_bytes);
    return check_size(file);
  }
  const std::string path = file.data_path.string();
  try {
    if (stored.skipped_bytes != 0) throw std::invalid_argument("must not have bytes to skip");
    if (stored.bytes && static_cast<std::uint64_t>(*stored.bytes) != there) {
      throw std::invalid_argument("have " + std::to_string(there) + " bytes; the header says " +
                                  std::to_string(*stored.bytes));
    }
    // Twice, for a moment; and never more than zlib can make of what is there.
    check_half_of_memory(file.path, 2.0 * static_cast<double>(std::min(needed, 1032 * there)));
    const std::string bytes = read_file(path).substr(std::min(size, file.offset));
    stored.as == StoredVoxels::As::text ? read_text(bytes, file) : inflate_voxels(bytes, file);
  } catch (const std::invalid_argument& error) {
    throw UserError(path + ": its voxels " + error.what());
  }
}

}  // namespace wobblebench::bench
