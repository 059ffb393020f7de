// The terms of laws exist at the scales of every recording: of a cell under an AFM, of a press that never slides, of
// one that stands still.
#include "harness/discrepancy/law_library.h"

#include <gtest/gtest.h>

namespace touchstone::discrepancy {
namespace {

std::size_t named(const std::vector<LawTerm>& terms, const std::string& name) {
  std::size_t count = 0;
  for (const LawTerm& term : terms) count += term.effect.name == name ? 1 : 0;
  return count;
}

TEST(LawLibrary, IsMadeWhateverTheRecordingDoesNotHave) {
  for (const double m : {1.0, 1e-3, 1e-9}) {  // the size of the object, against some decimetres
    for (int lacks = 0; lacks < 32; ++lacks) {
      SCOPED_TRACE(testing::Message() << "size " << m << ", lacks " << lacks);
      ViewScales scales{0.1 * m, 0.1 * m, 0.2 * m, m, 0.3 * m, 20.0};
      double* const each[] = {&scales.depth_m, &scales.depth_rate_m_per_s, &scales.speed_m_per_s,
                              &scales.load_N,  &scales.extent_m,           &scales.duration_s};
      for (int k = 0; k < 5; ++k) {  // there is always a duration
        if ((lacks >> k) % 2 == 1) *each[k] = 0.0;
      }
      const std::vector<LawTerm> terms = law_terms(scales, {});
      EXPECT_EQ(named(terms, "empirical-lift"),
                scales.speed_m_per_s > 0.0 && scales.depth_m > 0.0 && scales.load_N > 0.0 ? 1U : 0U);
    }
  }
}

}  // namespace
}  // namespace touchstone::discrepancy
