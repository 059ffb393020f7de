#include "harness/recording/hdf5_filters.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace touchstone::recording {
namespace {

static_assert(std::endian::native == std::endian::little);

using Bytes = unsigned char __attribute__((vector_size(16)));
using Words = std::uint16_t __attribute__((vector_size(16)));
using Longs = std::uint32_t __attribute__((vector_size(16)));
constexpr std::size_t vector_bytes = 16;
constexpr std::size_t vector_words = 8;

template <class Vector>
inline Vector load(const unsigned char* from) {
  Vector vector;
  std::memcpy(&vector, from, sizeof vector);
  return vector;
}

inline Longs lower(Words words) {
  return reinterpret_cast<Longs>(__builtin_shufflevector(words, Words{}, 0, 8, 1, 9, 2, 10, 3, 11));
}
inline Longs upper(Words words) {
  return reinterpret_cast<Longs>(__builtin_shufflevector(words, Words{}, 4, 12, 5, 13, 6, 14, 7, 15));
}

// The same modulo 65535, in 16 bits; zero only of zero.
std::uint64_t fold(std::uint64_t sum) {
  while (sum > 0xffffU) sum = (sum & 0xffffU) + (sum >> 16U);
  return sum;
}

std::uint32_t turned(std::uint64_t word) { return static_cast<std::uint32_t>((word >> 8U) | (word & 0xffU) << 8U); }

// The elements of two vectors in turn: those of their first halves, then those of their second.
inline std::array<Bytes, 2> zip_bytes(Bytes a, Bytes b) {
  return {__builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23),
          __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)};
}
inline std::array<Bytes, 2> zip_words(Bytes a, Bytes b) {
  return {__builtin_shufflevector(a, b, 0, 1, 16, 17, 2, 3, 18, 19, 4, 5, 20, 21, 6, 7, 22, 23),
          __builtin_shufflevector(a, b, 8, 9, 24, 25, 10, 11, 26, 27, 12, 13, 28, 29, 14, 15, 30, 31)};
}
inline std::array<Bytes, 2> zip_longs(Bytes a, Bytes b) {
  return {__builtin_shufflevector(a, b, 0, 1, 2, 3, 16, 17, 18, 19, 4, 5, 6, 7, 20, 21, 22, 23),
          __builtin_shufflevector(a, b, 8, 9, 10, 11, 24, 25, 26, 27, 12, 13, 14, 15, 28, 29, 30, 31)};
}

// Sixteen values: `rows` are `count` bytes apart.
inline void sixteen_values(const unsigned char* rows, std::size_t count, double* to) {
  std::array<std::array<Bytes, 2>, 4> words{};  // bytes 0 and 1 of every value, 2 and 3, ...
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = zip_bytes(load<Bytes>(rows + 2 * i * count), load<Bytes>(rows + (2 * i + 1) * count));
  }
  for (std::size_t eight = 0; eight < 2; ++eight) {
    const auto low = zip_words(words[0][eight], words[1][eight]);
    const auto high = zip_words(words[2][eight], words[3][eight]);
    for (std::size_t four = 0; four < 2; ++four) {
      const auto values = zip_longs(low[four], high[four]);
      std::memcpy(to + 8 * eight + 4 * four, values.data(), sizeof values);
    }
  }
}

}  // namespace

// The sums are taken modulo 65535, where the bytes of a word change places when it is multiplied by 256 (Braden, Borman
// and Partridge 1988, RFC 1071, section 2B): little-endian words give the sums with their bytes turned. Each lane keeps
// its own two sums; of m vectors the word of lane j in vector v counts 8 (m - v) - j times in the second.
std::uint32_t fletcher32(std::span<const unsigned char> bytes) {
  constexpr std::size_t vectors_without_overflow = 256;
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  const unsigned char* at = bytes.data();
  std::size_t left = bytes.size();
  while (left >= vector_bytes) {
    const std::size_t vectors = std::min(left / vector_bytes, vectors_without_overflow);
    std::array<Longs, 2> sums{};
    std::array<Longs, 2> weighted{};
    for (std::size_t v = 0; v < vectors; ++v, at += vector_bytes) {
      const auto words = load<Words>(at);
      sums[0] += lower(words);
      sums[1] += upper(words);
      weighted[0] += sums[0];
      weighted[1] += sums[1];
    }
    left -= vectors * vector_bytes;
    high += vectors * vector_words * low;
    for (std::size_t lane = 0; lane < vector_words; ++lane) {
      const std::uint64_t sum = sums[lane / 4][lane % 4];
      low += sum;
      high += vector_words * std::uint64_t{weighted[lane / 4][lane % 4]} - lane * sum;
    }
    low = fold(low);
    high = fold(high);
  }
  for (; left > 0; left -= std::min<std::size_t>(left, 2), at += 2) {
    low += left == 1 ? *at : static_cast<std::uint64_t>(at[0] | at[1] << 8);
    high += low;
  }
  return turned(fold(high)) << 16U | turned(fold(low));
}

void unshuffle(const unsigned char* bytes, std::size_t count, std::size_t first, std::span<double> to) {
  std::size_t done = 0;
  for (; done + 16 <= to.size(); done += 16) sixteen_values(bytes + first + done, count, &to[done]);
  for (; done < to.size(); ++done) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof bits; ++i) bits |= std::uint64_t{bytes[i * count + first + done]} << (8 * i);
    to[done] = std::bit_cast<double>(bits);
  }
}

}  // namespace touchstone::recording
