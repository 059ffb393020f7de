#include "harness/report/rendered_input.h"

namespace touchstone::report {
namespace {

std::string hash_of(double z, double force, bool judged, double vertex) {
  InputHash hash;
  hash.add_vertex({vertex, 0.0, 0.0});
  for (int i = 0; i < 10; ++i) hash.add(0.001 * i, {0.0, 0.0, z}, {0.0, 0.0, force}, judged);
  return hash.text();
}

TEST(RenderedInput, TheHashIsOfAllThatARendererIsGivenAndJudgedBy) {
  const std::string hash = hash_of(0.1, 1.0, true, 0.0);
  EXPECT_EQ(hash.size(), 32u);
  EXPECT_EQ(hash, hash_of(0.1, 1.0, true, 0.0));
  EXPECT_NE(hash, hash_of(std::nextafter(0.1, 1.0), 1.0, true, 0.0)) << "positions";
  EXPECT_NE(hash, hash_of(0.1, 1.1, true, 0.0)) << "measured forces";
  EXPECT_NE(hash, hash_of(0.1, 1.0, false, 0.0)) << "time ranges";
  EXPECT_NE(hash, hash_of(0.1, 1.0, true, 1e-6)) << "the object";
}

TEST(RenderedInput, DifferentOrUnknownInputsAreNotComparable) {
  const RenderedInput normal{"synthesize", 500.0, 0.0015, 0.05, "aa"};
  RenderedInput whole = normal;
  EXPECT_EQ(why_not_comparable(normal, whole), "");
  whole.in_trajectory = "whole-force";
  whole.hash = "bb";
  EXPECT_THAT(why_not_comparable(normal, whole), ::testing::AllOf(::testing::HasSubstr("normal force (equation 2)"),
                                                                  ::testing::HasSubstr("the whole measured force")));
  RenderedInput threshold = normal;
  threshold.contact_threshold_N = 0.1;
  threshold.hash = "cc";
  EXPECT_THAT(why_not_comparable(normal, threshold), ::testing::HasSubstr("contact thresholds"));
  RenderedInput other = normal;
  other.hash = "dd";
  EXPECT_THAT(why_not_comparable(normal, other), ::testing::HasSubstr("different recordings"));
  EXPECT_NE(why_not_comparable({}, {}), "") << "an unknown input equals nothing, not even itself";
}

}  // namespace
}  // namespace touchstone::report
