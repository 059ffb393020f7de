#include "harness/base/md5.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>

#include "harness/base/error.h"
#include "harness/base/loaded_library.h"

namespace touchstone {

std::string md5(std::string_view text) {
  const LoadedLibrary library("libcrypto.so.3", "makes checksums of what is sent", "libssl3");
  decltype(&EVP_Digest) digest_of = nullptr;
  decltype(&EVP_md5) kind = nullptr;
  library.find(digest_of, "EVP_Digest");
  library.find(kind, "EVP_md5");
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (digest_of(text.data(), text.size(), digest.data(), &size, kind(), nullptr) != 1)
    throw BadData("libcrypto makes no MD5 checksum; is it set to refuse it (FIPS mode)?");
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

}  // namespace touchstone
