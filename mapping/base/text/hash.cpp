#include "mapping/base/text/hash.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <random>

#include "mapping/base/error.h"

namespace loci {

std::string content_hash(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
  unsigned size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw Error("SHA-256 cannot be computed", {}, "check the installation of OpenSSL");
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    text.push_back("0123456789abcdef"[digest[i] >> 4]);
    text.push_back("0123456789abcdef"[digest[i] & 0xf]);
  }
  return text;
}

std::string unguessable_hex(int words) {
  std::random_device random;
  std::string hex;
  for (int i = 0; i < words; ++i) hex += fmt::format("{:08x}", random());
  return hex;
}

}  // namespace loci
