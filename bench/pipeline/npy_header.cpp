#include "bench/pipeline/npy_header.h"

#include <bit>
#include <sstream>

namespace wobblebench::bench {

std::string npy_header(std::span<const std::uint64_t> shape) {
  constexpr std::size_t kPreamble = 10, kAlignment = 64;
  std::ostringstream dictionary;
  dictionary << "{'descr': '" << (std::endian::native == std::endian::little ? '<' : '>')
             << "c8', 'fortran_order': False, 'shape': (" << shape.front() << ',';
  for (std::size_t i = 1; i < shape.size(); ++i) {
    dictionary << ' ' << shape[i] << (i + 1 < shape.size() ? "," : "");
  }
  dictionary << "), }";
  std::string text = dictionary.str();
  const std::size_t unpadded = kPreamble + text.size() + 1;
  text.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8);
  header += text;
  return header;
}

}  // namespace wobblebench::bench
