#include "harness/base/counted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "harness/base/random.h"
#include "harness/base/vec.h"

namespace touchstone {
namespace {

template <class Run>
OperationCounts counts_of(const Run& run) {
  const OperationCounts before = operations_on_this_thread();
  run();
  return operations_on_this_thread() - before;
}

// The same code for both scalars: some of everything.
template <class S>
S polynomial_and_norms(const std::array<double, 6>& x) {
  using std::abs;
  using std::sqrt;
  const Vec3Of<S> a{S(x[0]), S(x[1]), S(x[2])};
  const Vec3Of<S> b{S(x[3]), S(x[4]), S(x[5])};
  S sum = dot(a - b, a.cross(b)) + squared_norm(a + b) / (S(1.0) + abs(b.x()));
  sum -= dot(unit(a), b) * S(0.3);
  if (sum > S(0.1)) sum = sqrt(sum);
  return std::max(sum, -a.y());
}

TEST(Counted, EveryOperationCountsOnceAndNothingElseDoes) {
  Counted a = 3.0;
  const Counted b = 2.0;
  const auto expect = [](const OperationCounts& obtained, OperationCounts expected) { EXPECT_EQ(obtained, expected); };
  expect(counts_of([&] { a = a + b - b; }), {2, 0, 0, 0, 0});
  expect(counts_of([&] {
           a += b;
           a -= b;
         }),
         {2, 0, 0, 0, 0});
  expect(counts_of([&] { a *= b * b; }), {0, 2, 0, 0, 0});
  expect(counts_of([&] { a = a / b; }), {0, 0, 1, 0, 0});
  expect(counts_of([&] { a = sqrt(a); }), {0, 0, 0, 1, 0});
  expect(counts_of([&] { EXPECT_TRUE(b < a + 10.0); }), {1, 0, 0, 0, 1});
  expect(counts_of([&] { a = std::min(a, std::max(a, b)); }), {0, 0, 0, 0, 2});
  expect(counts_of([&] { a = floor(abs(-a)); }), {0, 0, 0, 0, 0});
  EXPECT_EQ(OperationCounts({1, 2, 3, 4, 5}).total(), 15U);
}

TEST(Counted, ByHandForVectors) {
  const Vec3Of<Counted> a{1.0, 2.0, 3.0};
  const Vec3Of<Counted> b{0.5, -2.0, 1.0};
  EXPECT_EQ(counts_of([&] { (void)dot(a, b); }), (OperationCounts{2, 3, 0, 0, 0}));
  EXPECT_EQ(counts_of([&] { (void)dot(a - b, b); }), (OperationCounts{5, 3, 0, 0, 0}));
  EXPECT_EQ(counts_of([&] { (void)squared_norm(a - b); }), (OperationCounts{5, 3, 0, 0, 0}));
  EXPECT_EQ(counts_of([&] {
              const Vec3Of<Counted> c = a.cross(b);
              (void)c;
            }),
            (OperationCounts{3, 6, 0, 0, 0}));
  EXPECT_EQ(counts_of([&] { (void)unit(a); }), (OperationCounts{2, 3, 3, 1, 1}));
  EXPECT_EQ(counts_of([&] {
              const Vec3Of<Counted> c = a + Counted(2.0) * b;
              (void)c;
            }),
            (OperationCounts{3, 3, 0, 0, 0}));
}

TEST(Counted, TheSameCodeGivesTheSameBitsAsDouble) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    std::array<double, 6> x{};
    for (double& value : x) value = random.log_uniform(1e-6, 1e6) * (random.uniform(-1, 1) < 0 ? -1.0 : 1.0);
    ASSERT_EQ(polynomial_and_norms<Counted>(x).value(), polynomial_and_norms<double>(x)) << i;
  }
}

TEST(FixedOrder, IsEigensOwnForDouble) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a = random.log_uniform(1e-3, 1e3) * random.direction();
    const Vec3 b = random.log_uniform(1e-3, 1e3) * random.direction();
    ASSERT_EQ(dot(a, b), a.dot(b));
    ASSERT_EQ(squared_norm(a - b), (a - b).squaredNorm());
    ASSERT_EQ(unit(a), a.normalized());
  }
}

}  // namespace
}  // namespace touchstone
