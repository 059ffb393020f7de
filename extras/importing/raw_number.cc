#include "raw_number.h"

#include <cmath>
#include <cstdint>

namespace touchstone::importing {
namespace {

double half(const char* from, bool big_endian) {
  const auto bits = raw_number<std::uint16_t>(from, big_endian);
  const int exponent = (bits >> 10U) & 0x1f, fraction = bits & 0x3ff;
  const double sign = (bits & 0x8000U) != 0 ? -1.0 : 1.0;
  if (exponent == 0x1f) return fraction == 0 ? sign * INFINITY : NAN;
  return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

template <class Of8, class Of4, class Of2, class Of1>
double whole(const char* from, const NumberType& type) {
  return type.bytes == 8   ? static_cast<double>(raw_number<Of8>(from, type.big_endian))
         : type.bytes == 4 ? raw_number<Of4>(from, type.big_endian)
         : type.bytes == 2 ? raw_number<Of2>(from, type.big_endian)
                           : raw_number<Of1>(from, false);
}

}  // namespace

double number_at(const char* from, const NumberType& type) {
  if (type.kind == 'i') return whole<std::int64_t, std::int32_t, std::int16_t, std::int8_t>(from, type);
  if (type.kind != 'f') return whole<std::uint64_t, std::uint32_t, std::uint16_t, std::uint8_t>(from, type);
  return type.bytes == 8   ? raw_number<double>(from, type.big_endian)
         : type.bytes == 4 ? raw_number<float>(from, type.big_endian)
                           : half(from, type.big_endian);
}

}  // namespace touchstone::importing
