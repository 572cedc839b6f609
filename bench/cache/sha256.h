// SHA-256, by OpenSSL.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace wobblebench::bench {

class Sha256 {
 public:
  using Digest = std::array<std::uint8_t, 32>;

  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  /// Digest of all that was added; call it once.
  Digest digest();

 private:
  evp_md_ctx_st* context_;
};

/// Lower-case hexadecimal.
std::string hex(const Sha256::Digest& digest);

/// Of a file's content, in hexadecimal. Throws as read_pieces().
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace wobblebench::bench
