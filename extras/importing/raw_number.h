// Numbers as they lie in binary files, of every size and in both orders of bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace touchstone::importing {

struct NumberType {
  char kind = 0;  // f: IEEE 754; i, u: whole, with a sign or without; b: a truth value
  std::size_t bytes = 0;
  bool big_endian = false;
};

template <class Number>
Number raw_number(const char* from, bool big_endian) {
  std::array<char, sizeof(Number)> bytes{};
  std::memcpy(bytes.data(), from, sizeof(Number));
  if (big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
  return std::bit_cast<Number>(bytes);
}

// Of 1, 2, 4 or 8 bytes; of kind f 2, 4 or 8.
double number_at(const char* from, const NumberType& type);

}  // namespace touchstone::importing
