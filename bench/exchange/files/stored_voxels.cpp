#include "bench/exchange/files/stored_voxels.h"

#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>

#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/exchange/files/inflate.h"
#include "bench/scene/scene_cost.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

/// In the header's folder or below: a header must not name other files of who reads it.
fs::path beside(const fs::path& header, const StoredVoxels& stored) {
  const fs::path name = stored.file, path = header.parent_path() / name;
  const bool is_below = name.is_relative() && std::ranges::count(name, fs::path("..")) == 0;
  std::error_code error;
  if (is_below && fs::is_regular_file(path, error)) return path;
  throw UserError(header.string() + ": " + stored.field + " = " + stored.file + ": must be " +
                  (is_below ? "one file that is there" : "a file in the header's folder"));
}

/// Bytes of the first lines from the offset on.
std::uint64_t bytes_of_lines(const VoxelFile& file, std::int64_t lines) {
  std::uint64_t at = 0, end = file.offset;
  read_pieces(file.data_path, [&](std::string_view piece) {
    for (std::size_t i = 0; i < piece.size() && lines > 0; ++i) {
      if (at + i < file.offset || piece[i] != '\n') continue;
      end = at + i + 1;
      --lines;
    }
    at += piece.size();
  });
  if (lines == 0) return end - file.offset;
  throw UserError(file.data_path.string() + ": has fewer lines than line skip says");
}

std::uint64_t bytes_there(const VoxelFile& file) {
  const std::uint64_t size = fs::file_size(file.data_path);
  return size - std::min(size, file.offset);
}

void check_memory(const VoxelFile& file, double bytes) {
  const double most = 0.5 * available_memory_bytes();
  if (bytes <= most) return;
  throw UserError(file.path.string() + ": its voxels need " + significant(bytes / 1e9, 3) +
                  " GB of memory; must be at most " + significant(most / 1e9, 3) + " GB");
}

void inflate_voxels(VoxelFile& file) {
  const std::string path = file.data_path.string();
  const std::uint64_t needed = file.voxels() * element_bytes(file.element);
  const auto refuse = [&](const std::string& why) {
    throw UserError(path + ": its compressed voxels " + why + "; the header says " +
                    std::to_string(needed) + " bytes");
  };
  if (needed / Inflater::kMostRatio > bytes_there(file)) refuse("cannot be that many");
  check_memory(file, static_cast<double>(needed));
  Inflater inflater(Inflater::kZlibOrGzip);
  std::string out(1 << 20, '\0');
  std::uint64_t done = 0, skip = file.offset;
  open_memory(file);
  read_pieces(path, [&](std::string_view piece) {
    const auto skipped = std::min<std::uint64_t>(skip, piece.size());
    skip -= skipped;
    if (skipped == piece.size()) return;
    inflater.feed(piece.substr(skipped));
    while (const std::size_t got = inflater.read(out)) {
      done += got;
      if (done > needed) refuse("are more than they should be");
      keep_in_memory(file, std::string_view(out).substr(0, got));
    }
    if (inflater.is_damaged()) refuse("are damaged");
  });
  if (done == needed && !inflater.is_done()) refuse("do not end where they should");
  if (done != needed) refuse("are " + std::to_string(done) + " bytes");
}

/// Numbers with white space between them, kept as doubles.
void read_text(VoxelFile& file) {
  const std::string path = file.data_path.string();
  const std::string text = read_file(path).substr(file.offset);
  const auto refuse = [&](const std::string& why) {
    throw UserError(path + ": " + why + "; the header says " + std::to_string(file.voxels()) +
                    " numbers");
  };
  if (file.voxels() > text.size()) refuse("has " + std::to_string(text.size()) + " bytes of text");
  constexpr std::string_view kSpace = " \t\r\n\v\f";
  std::vector<double> values;
  for (std::size_t at = 0; (at = text.find_first_not_of(kSpace, at)) != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSpace, at), text.size());
    const auto value = number_in(std::string_view(text).substr(at, end - at));
    if (!value) refuse("voxel " + std::to_string(values.size()) + " is no finite number");
    values.push_back(*value);
    at = end;
  }
  if (values.size() != file.voxels()) refuse("has " + std::to_string(values.size()) + " numbers");
  open_memory(file);
  const auto bytes = std::as_bytes(std::span(values));
  keep_in_memory(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  file.big_endian = std::endian::native == std::endian::big;
  file.kept_as = Element::float64;
}

}  // namespace

void open_memory(VoxelFile& file) {
  file.memory = std::make_shared<FileDescriptor>(::memfd_create("wobblebench", MFD_CLOEXEC));
  file.data_path = "/proc/self/fd/" + std::to_string(file.memory->get());
  file.offset = 0;
}

void keep_in_memory(const VoxelFile& file, std::string_view bytes) {
  if (file.memory->is_open() && write_all(file.memory->get(), bytes)) return;
  throw std::runtime_error(file.path.string() +
                           ": cannot be kept in memory: " + std::strerror(errno));
}

void take_voxels(const StoredVoxels& stored, VoxelFile& file) {
  if (!stored.file.empty()) {
    file.data_path = beside(file.path, stored);
    file.offset = 0;
  }
  if (stored.skipped_lines > 0) file.offset += bytes_of_lines(file, stored.skipped_lines);
  if (stored.as != StoredVoxels::As::raw && stored.skipped_bytes != 0) {
    throw UserError(file.path.string() + ": bytes to skip = " +
                    std::to_string(stored.skipped_bytes) + ": must be 0 where voxels are not raw");
  }
  if (stored.bytes && static_cast<std::uint64_t>(*stored.bytes) != bytes_there(file)) {
    throw UserError(file.data_path.string() + ": has " + std::to_string(bytes_there(file)) +
                    " bytes of compressed voxels; the header says " +
                    std::to_string(*stored.bytes));
  }
  if (stored.as == StoredVoxels::As::deflated) return inflate_voxels(file);
  if (stored.as == StoredVoxels::As::text) return read_text(file);
  const std::uint64_t needed = file.voxels() * element_bytes(file.element);
  if (stored.skipped_bytes >= 0) {
    file.offset += static_cast<std::uint64_t>(stored.skipped_bytes);
  } else if (needed <= bytes_there(file)) {
    file.offset += bytes_there(file) - needed;
  }
  check_size(file);
}

}  // namespace wobblebench::bench
