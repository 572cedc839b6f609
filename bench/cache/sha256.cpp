#include "bench/cache/sha256.h"

#include <openssl/evp.h>

#include <stdexcept>

#include "base/file.h"

namespace wobblebench::bench {

namespace {

void expect_done(int done) {
  if (done != 1) throw std::runtime_error("SHA-256: OpenSSL cannot compute it");
}

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  expect_done(EVP_DigestInit_ex(context_, EVP_sha256(), nullptr));
}

Sha256::~Sha256() {
  EVP_MD_CTX_free(context_);
}

void Sha256::add(std::string_view bytes) {
  expect_done(EVP_DigestUpdate(context_, bytes.data(), bytes.size()));
}

Sha256::Digest Sha256::digest() {
  Digest digest{};
  expect_done(EVP_DigestFinal_ex(context_, digest.data(), nullptr));
  return digest;
}

std::string hex(const Sha256::Digest& digest) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : digest) text += {kDigits[byte >> 4], kDigits[byte & 15]};
  return text;
}

std::string sha256_of_file(const std::filesystem::path& path) {
  Sha256 hash;
  read_pieces(path, [&](std::string_view piece) { hash.add(piece); });
  return hex(hash.digest());
}

}  // namespace wobblebench::bench
