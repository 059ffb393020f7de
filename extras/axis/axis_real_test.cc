// One joint of a haptic master arm, swept there and back at one speed: an expert finds dry friction of 0.072 N m and a
// cable torque over place, and that Coulomb and viscous friction cannot be told apart.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "axis_fit.h"
#include "axis_report.h"
#include "harness/testing/shared_data.h"

namespace touchstone::axis {
namespace {

TEST(RealAxis, JointSweep) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "actuator/mtm_joint4_sweep.csv");
  AxisRun run;
  run.source = file.string();
  std::ifstream in(file);
  char comma = ',';
  double q = 0.0, qd = 0.0, effort = 0.0;
  while (in >> q >> comma >> qd >> comma >> effort) {
    run.t_s.push_back(static_cast<double>(run.t_s.size()) / 200.0);
    run.place.push_back(q), run.rate.push_back(qd), run.load.push_back(effort);
  }
  ASSERT_EQ(run.t_s.size(), 4885U);
  const AxisFit fit = fit_axis(run);
  fmt::print("{}", axis_text(fit, {}, {}));
  EXPECT_TRUE(fit.friction_undecided);
  EXPECT_NEAR(fit.dry_alone, 0.072, 0.003);
  EXPECT_GT(fit.place_range, 0.02);
  EXPECT_LT(fit.after, 0.5 * fit.before);
}

}  // namespace
}  // namespace touchstone::axis
