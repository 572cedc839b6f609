// Messages of OpenIGTLink that come from elsewhere: nothing in them is trusted.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bench/exchange/igtl/message.h"

namespace wobblebench::bench {

inline constexpr std::size_t kIgtlHeaderBytes = 58;

/// What a message is called that is damaged or cannot be taken; what() is a few words.
class IgtlRefusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ReceivedHeader {
  int version = 1;
  std::string type, device;
  std::uint64_t timestamp = 0;
  std::uint64_t body_bytes = 0;
  std::uint64_t crc = 0;
};

/// Of kIgtlHeaderBytes; nullopt: they are no header, so that nobody knows where the next one is.
std::optional<ReceivedHeader> read_igtl_header(std::string_view bytes);

struct ReceivedBody {
  std::string_view content;
  std::map<std::string, std::string> metadata;  ///< empty in version 1
};

/// Checks the CRC, and takes the body apart. Throws IgtlRefusal.
ReceivedBody read_igtl_body(const ReceivedHeader& header, std::string_view bytes);

/// The content of an IMAGE; `voxels` lie in it. Throws IgtlRefusal for a part of an image, a size
/// that is not that of the content, numbers that are not finite, and unknown types.
IgtlImage read_igtl_image(std::string_view content);

std::size_t scalar_bytes(IgtlScalar scalar);

}  // namespace wobblebench::bench
