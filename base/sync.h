// Waits until files and folders are on the disk.
#pragma once

#include <filesystem>

namespace wobblebench {

/// fsync(2) of an open file, or fdatasync(2). Returns 0 or errno; 0 too for what is on no disk, a
/// pipe or /dev/null.
int sync_file(int descriptor);
int sync_data(int descriptor);

/// Of a file by its name, and of a folder's names: a new or renamed file survives a power failure
/// when its folder is synced too. Each throws std::runtime_error "PATH: cannot be written: reason".
void sync_file(const std::filesystem::path& path);
void sync_folder(const std::filesystem::path& path);

}  // namespace wobblebench
