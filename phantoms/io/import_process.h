// Reading of files by third-party parsers, in a process of their own: a damaged file may make them
// write where they must not.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string_view>

namespace wobblebench::phantoms {

/// The program wobblebench-import is missing, cannot be started, or was stopped by the system or
/// the clock: nothing is said of the file.
class ImportUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class ImportFormat { vdb, mesh, hdf5, zea };

/// The message that wobblebench-import makes of a file, as memory.
class ImportedBytes {
 public:
  /// Runs the program and waits for it. Throws std::invalid_argument with one line for a file that
  /// it refuses, or that ends it: by a signal, too much memory or too much processor time; and
  /// ImportUnavailable. As read_pieces() where the file cannot be read.
  ImportedBytes(ImportFormat format, const std::filesystem::path& path);
  ~ImportedBytes();
  ImportedBytes(const ImportedBytes&) = delete;
  ImportedBytes& operator=(const ImportedBytes&) = delete;

  /// Without the message's first and last words.
  std::string_view message() const { return message_; }

 private:
  std::string_view mapped_;
  std::string_view message_;
};

}  // namespace wobblebench::phantoms
