// Included first in every file that TSan sees: OpenVDB's templates are then compiled here, with the
// sanitizer, not taken from libopenvdb, whose own copies of TBB's templates synchronise in ways
// that it cannot see.
#pragma once

#include <openvdb/version.h>

#undef OPENVDB_USE_EXPLICIT_INSTANTIATION
