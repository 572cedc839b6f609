// Lists of point scatterers of HDF5 files.
#pragma once

#include <filesystem>

#include "phantoms/io/message.h"

namespace wobblebench::phantoms {

/// Writes name and values of each dataset of the root group: one-dimensional numbers stored in the
/// file itself. Groups are ignored. Throws std::invalid_argument with one line for any other
/// dataset, for one of more than kMostScattererRows, and where this build does not read HDF5.
void write_hdf5_message(const std::filesystem::path& path, MessageWriter& out);

}  // namespace wobblebench::phantoms
