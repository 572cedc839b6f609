// Keeps files that a program opens away from its standard streams.
#pragma once

namespace wobblebench {

/// Opens those of the descriptors 0, 1 and 2 that the caller of the program closed, so that no file
/// opened later gets their number, and with it the text that is written to the stream. Reading or
/// writing such a stream fails. To be called first in main(). Throws std::system_error.
void occupy_standard_descriptors();

}  // namespace wobblebench
