#include "harness/base/hash.h"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/opensslv.h>

#include <array>
#include <fstream>
#include <memory>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/loaded_library.h"

namespace touchstone {
namespace {

#define TOUCHSTONE_TEXT_OF(number) TOUCHSTONE_TEXT(number)
#define TOUCHSTONE_TEXT(number) #number
constexpr const char* libcrypto = "libcrypto.so." TOUCHSTONE_TEXT_OF(OPENSSL_SHLIB_VERSION);

// Loaded at the first hash: linked, it would take a quarter of the time in which the program starts.
class Crypto {
 public:
  static const Crypto& library() {
    static const Crypto crypto;
    return crypto;
  }
  decltype(&EVP_MD_CTX_new) context_new = nullptr;
  decltype(&EVP_MD_CTX_free) context_free = nullptr;
  decltype(&EVP_sha256) sha256 = nullptr;
  decltype(&EVP_DigestInit_ex) init = nullptr;
  decltype(&EVP_DigestUpdate) update = nullptr;
  decltype(&EVP_DigestFinal_ex) finish = nullptr;

 private:
  Crypto() {
    const LoadedLibrary library(libcrypto, "makes checksums of files", "libssl3");
    library.find(context_new, "EVP_MD_CTX_new");
    library.find(context_free, "EVP_MD_CTX_free");
    library.find(sha256, "EVP_sha256");
    library.find(init, "EVP_DigestInit_ex");
    library.find(update, "EVP_DigestUpdate");
    library.find(finish, "EVP_DigestFinal_ex");
  }
};

class Sha256 {
 public:
  Sha256() : context_(crypto_.context_new(), crypto_.context_free) {
    if (!context_ || crypto_.init(context_.get(), crypto_.sha256(), nullptr) != 1) failed();
  }
  void add(const void* data, std::size_t size) {
    if (crypto_.update(context_.get(), data, size) != 1) failed();
  }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    if (crypto_.finish(context_.get(), digest.data(), &size) != 1) failed();
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  [[noreturn]] static void failed() {
    throw BadData(fmt::format("{} cannot make a SHA-256 checksum; is it whole?", libcrypto));
  }

  const Crypto& crypto_ = Crypto::library();
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string sha256(std::span<const std::byte> bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256(std::string_view text) { return sha256(std::as_bytes(std::span(text.data(), text.size()))); }

std::string sha256_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw BadData(fmt::format("{}: cannot be opened for reading; does it exist, and may you read it?", path.string()));
  Sha256 hash;
  std::vector<char> block(1 << 16);
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add(block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) throw BadData(fmt::format("{}: reading stopped half-way", path.string()));
  return hash.hex();
}

}  // namespace touchstone
