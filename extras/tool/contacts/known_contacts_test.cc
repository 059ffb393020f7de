#include "contacts/known_contacts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contacts/scripted_path.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::contacts {
namespace {

TEST(KnownContacts, EveryHandleHasTheWrenchOfItsEquilibrium) {
  const tool::Coupling coupling;
  const ExactCase made = make_exact_case("box-corner");
  const tool::KnownContacts known = known_contacts("box-corner", coupling);
  ASSERT_EQ(known.wrenches_W.size(), made.handles.size());
  const Equilibrium first = quasi_static_equilibrium(made.gaps, made.handles[0], coupling);
  EXPECT_EQ(known.wrenches_W[0].f_N, first.wrench_W.f_N);
  EXPECT_EQ(known.wrenches_W[0].torque_Nm, first.wrench_W.torque_Nm);
  EXPECT_THROW(known_contacts("nowhere", coupling), UsageError);
}

TEST(KnownContacts, TheFilesAreTheCase) {
  const testing::TemporaryFolder folder;
  const ExactCase made = make_exact_case("box-corner");
  EXPECT_EQ(write_exact_case(made, 0.5, folder.path()), 501U);
  EXPECT_EQ(surface::load_mesh(folder.path() / "tool.obj", 1.0).triangle_count(), made.tool_T.triangle_count());
  const auto path = recording::load_trajectory(folder.path() / "path.csv");
  ASSERT_EQ(path.motion.t_s.size(), 501U);
  EXPECT_NEAR((path.motion.p_W_m[250] - scripted_pose(made, 0.25, 0.5).p_W_m).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace touchstone::contacts
