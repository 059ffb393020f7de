// Fields of a message one after the other, never beyond its end.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace touchstone::hil {

class ByteReader {
 public:
  explicit ByteReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  // False once a field was asked for that is not there; what was read then is zero.
  [[nodiscard]] bool good() const noexcept { return good_; }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t at() const noexcept { return at_; }

  void skip(std::size_t bytes) {
    if (bytes > left()) good_ = false;
    at_ += std::min(bytes, left());
  }
  template <class T>
  T little() {
    return get<T>(false);
  }
  template <class T>
  T big() {
    return get<T>(true);
  }
  // Up to its zero, which is read too.
  std::string text() {
    const auto from = bytes_.subspan(at_);
    std::size_t n = 0;
    while (n < from.size() && from[n] != 0) ++n;
    if (n == from.size()) good_ = false;
    std::string text(reinterpret_cast<const char*>(from.data()), n);
    at_ += std::min(n + 1, from.size());
    return text;
  }

 private:
  template <class T>
  T get(bool big) {
    T value{};
    if (sizeof value > left()) {
      good_ = false;
      at_ = bytes_.size();
      return value;
    }
    unsigned char raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + at_, sizeof raw);
    at_ += sizeof raw;
    if (big == (std::endian::native == std::endian::little)) {
      for (std::size_t i = 0; i < sizeof raw / 2; ++i) std::swap(raw[i], raw[sizeof raw - 1 - i]);
    }
    std::memcpy(&value, raw, sizeof raw);
    return value;
  }

  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace touchstone::hil
