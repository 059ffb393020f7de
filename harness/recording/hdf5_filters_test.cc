// Against the definitions, byte by byte.
#include "harness/recording/hdf5_filters.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::recording {
namespace {

// Fletcher 1982, modulo 65535 at each step, written as HDF5 writes it: of a sum that is not zero but divisible, 65535.
std::uint32_t one_word_after_another(const std::vector<unsigned char>& bytes) {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  bool zero = true;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    const std::uint64_t word = bytes[i] * 256U + (i + 1 < bytes.size() ? bytes[i + 1] : 0U);
    zero = zero && word == 0;
    low = (low + word) % 65535;
    high = (high + low) % 65535;
  }
  const auto written = [&](std::uint64_t sum) { return static_cast<std::uint32_t>(zero ? 0 : sum == 0 ? 65535 : sum); };
  return written(high) << 16U | written(low);
}

std::vector<unsigned char> at_random(Random& random, std::size_t size) {
  std::vector<unsigned char> bytes(size);
  for (auto& byte : bytes) byte = static_cast<unsigned char>(random.below(256));
  return bytes;
}

TEST(Fletcher32, KnownSum) {
  const std::vector<unsigned char> bytes{'a', 'b', 'c', 'd', 'e'};
  // Words 6162, 6364, 6500: 129c6 -> 29c7; 6162 + c4c6 + 129c6 = 24fee -> 4ff0.
  EXPECT_EQ(fletcher32(bytes), 0x4ff029c7U);
}

TEST(Fletcher32, IsItsDefinition) {
  Random random(20261122);
  for (std::size_t size = 0; size < 600; ++size) {
    const auto bytes = at_random(random, size);
    ASSERT_EQ(fletcher32(bytes), one_word_after_another(bytes)) << size;
  }
  for (const std::size_t size : {4095U, 4096U, 4097U, 4111U, 4112U, 8191U, 65536U, 65551U}) {
    for (const int fill : {0x00, 0x01, 0x80, 0xff}) {
      const std::vector<unsigned char> bytes(size, static_cast<unsigned char>(fill));
      ASSERT_EQ(fletcher32(bytes), one_word_after_another(bytes)) << size << " of " << fill;
    }
    const auto bytes = at_random(random, size);
    ASSERT_EQ(fletcher32(bytes), one_word_after_another(bytes)) << size;
    std::vector<unsigned char> last(size, 0);
    last.back() = 1;
    ASSERT_EQ(fletcher32(last), one_word_after_another(last)) << size;
  }
}

TEST(Unshuffle, TakesWhatIsAskedForFromAnyPlace) {
  Random random(20261123);
  constexpr std::size_t count = 70;
  const auto values = at_random(random, count * sizeof(double));
  std::vector<unsigned char> shuffled(values.size());
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t i = 0; i < sizeof(double); ++i) shuffled[i * count + v] = values[v * sizeof(double) + i];
  }
  for (std::size_t first = 0; first < count; ++first) {
    for (std::size_t wanted = 0; first + wanted <= count; ++wanted) {
      std::vector<double> to(wanted + 1, 0.25);
      unshuffle(shuffled.data(), count, first, std::span(to).first(wanted));
      ASSERT_EQ(std::memcmp(to.data(), values.data() + first * sizeof(double), wanted * sizeof(double)), 0)
          << wanted << " from " << first;
      ASSERT_EQ(to.back(), 0.25) << "nothing is written behind the last";
    }
  }
}

}  // namespace
}  // namespace touchstone::recording
