// A message of OpenIGTLink, of any bytes behind a CRC that is made right: taken apart, or refused.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "bench/exchange/igtl/received_message.h"

namespace bench = wobblebench::bench;

namespace {

void check(const bench::ReceivedBody& body, std::string_view bytes) {
  std::size_t taken = body.content.size();
  for (const auto& [key, value] : body.metadata) taken += key.size() + value.size();
  if (taken > bytes.size()) std::abort();
  const bench::IgtlImage image = bench::read_igtl_image(body.content);
  std::size_t needed = bench::scalar_bytes(image.scalar);
  for (const auto size : image.sizes) needed *= size;
  if (needed * static_cast<std::size_t>(image.components) != image.voxels.size()) std::abort();
  if (!std::isfinite(image.first_voxel().x)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (size < bench::kIgtlHeaderBytes) return -1;
  auto header = bench::read_igtl_header(bytes.substr(0, bench::kIgtlHeaderBytes));
  if (!header) return 0;
  const std::string_view body = bytes.substr(bench::kIgtlHeaderBytes);
  header->crc = bench::crc64(body);
  try {
    check(bench::read_igtl_body(*header, body), body);
  } catch (const bench::IgtlRefusal&) {
    // In a few words.
  }
  return 0;
}
