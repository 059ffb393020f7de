// Fuzzing from valid structures: the fuzzer's bytes choose what a valid file is made of and what is then damaged in it,
// so that they reach what lies behind a reader's first checks (Padhye et al., Semantic fuzzing with Zest, ISSTA 2019: a
// generator whose choices are the input). The same bytes make the same choices.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace touchstone::testing {

class Choices {
 public:
  explicit Choices(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  // After the last byte every choice is the first one: without bytes the structure is the valid one.
  [[nodiscard]] bool over() const { return bytes_.empty(); }
  // 0 to n - 1; n must be above 0.
  std::size_t below(std::size_t n) { return raw(2) % n; }
  bool one_in(std::size_t n) { return !over() && below(n) == n - 1; }
  // A number that a format can say but a reader may not expect, or any at all.
  double number() {
    constexpr double extremes[] = {0.0,
                                   -0.0,
                                   1.0,
                                   -1.0,
                                   0.5,
                                   1e-300,
                                   1e300,
                                   -1e300,
                                   2147483648.0,
                                   4294967296.0,
                                   9.3e18,
                                   1e-12,
                                   1e-3,
                                   1e3,
                                   1e9,
                                   -1e9,
                                   std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::quiet_NaN()};
    const std::size_t which = below(std::size(extremes) + 2);
    return which < std::size(extremes) ? extremes[which] : std::bit_cast<double>(raw(8));
  }
  std::uint64_t whole() {
    constexpr std::uint64_t extremes[] = {0,
                                          1,
                                          2,
                                          3,
                                          127,
                                          128,
                                          255,
                                          256,
                                          32767,
                                          65535,
                                          0x7fffffff,
                                          0x80000000,
                                          0xffffffff,
                                          0x100000000,
                                          1000,
                                          std::uint64_t{1} << 62,
                                          ~std::uint64_t{0}};
    const std::size_t which = below(std::size(extremes) + 2);
    return which < std::size(extremes) ? extremes[which] : raw(8);
  }
  const char* text(std::initializer_list<const char*> some) { return some.begin()[below(some.size())]; }

  // Numbers of 1, 2, 4 or 8 bytes somewhere in a packet become others; or it is cut, or grows.
  std::string damaged(std::string packet) {
    while (!over() && !packet.empty()) {
      const std::size_t at = below(packet.size());
      const std::size_t width = std::size_t{1} << below(4);
      if (one_in(16)) {
        packet.resize(at);
      } else if (one_in(16)) {
        packet.insert(at, packet.substr(below(packet.size())));
      } else {
        const std::uint64_t value = whole();
        char bytes[8];
        std::memcpy(bytes, &value, 8);
        if (below(2) == 1) {
          for (std::size_t i = 0; i < width / 2; ++i) std::swap(bytes[i], bytes[width - 1 - i]);
        }
        packet.replace(at, std::min(width, packet.size() - at), bytes, std::min(width, packet.size() - at));
      }
      if (packet.size() > 65536) packet.resize(65536);
    }
    return packet;
  }

 private:
  std::uint64_t raw(std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count && !bytes_.empty(); ++i) {
      value |= std::uint64_t{bytes_.front()} << (8 * i);
      bytes_ = bytes_.subspan(1);
    }
    return value;
  }
  std::span<const std::uint8_t> bytes_;
};

}  // namespace touchstone::testing
