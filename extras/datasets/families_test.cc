#include "harness/recording/dataset.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"
#include "measured_scan.h"
#include "packed_dataset.h"
#include "write_dataset.h"

namespace touchstone::datasets {
using synthetic::Tessellation;

namespace {

// Each is a whole data set, and its exact answer is one: in contact the force obeys Coulomb's law, out of it there is
// none.
TEST(Families, AreDataSetsWithAnExactAnswer) {
  for (const Recipe& recipe : families()) {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("touchstone-family-" + recipe.name + "-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    write_dataset(recipe, 1, folder);
    const recording::Dataset dataset = recording::load_dataset(folder);
    const DatasetReport report = check_dataset(dataset, [](const std::filesystem::path& file, const std::string& unit) {
      return surface::load_mesh(file, unit == "m" ? 1.0 : 1e-3).bounds();
    });
    EXPECT_THAT(report.errors, ::testing::IsEmpty()) << recipe.name;
    const recording::RenderedTrajectory exact = recording::load_rendered(folder / "scan.exact.csv");
    std::size_t touching = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      touching += exact.contact[i];
      if (exact.contact[i] == 0) {
        EXPECT_EQ(exact.f_W_N[i].norm(), 0.0) << recipe.name << ' ' << i;
      }
    }
    EXPECT_GT(touching, exact.size() / 2) << recipe.name;
    std::filesystem::remove_all(folder);
  }
}

// With instruments without error a scan of an object that moves is the scan of the same object at rest, but for where a
// probe that stands upright on the table points: nothing of the motion is left in the object's frame.
TEST(Families, AMovingObjectIsAtRestInItsOwnFrame) {
  const Recipe& moving = recipe("moving");
  const RigidScan scan = make_scan(moving, 1);
  const auto rest = measure(scan, ForceSensor::perfect(), Tracker::perfect(), 1);
  const auto moved = measure(scan, ForceSensor::perfect(), Tracker::perfect(), 1, moving.object_pose);
  ASSERT_EQ(moved.recording.size(), rest.recording.size());
  for (std::size_t i = 0; i < rest.recording.size(); ++i) {
    ASSERT_LT((moved.recording.motion.p_W_m[i] - rest.recording.motion.p_W_m[i]).norm(), 1e-12) << i;
    ASSERT_LT((moved.recording.f_W_N[i] - rest.recording.f_W_N[i]).norm(), 1e-12) << i;
  }
  // With noise of the tracker it is another recording, by more than that of one marker.
  const auto noisy = measure(scan, ForceSensor::perfect(), Tracker{}, 1, moving.object_pose);
  double largest_m = 0.0;
  for (std::size_t i = 0; i < rest.recording.size(); ++i)
    largest_m = std::max(largest_m, (noisy.recording.motion.p_W_m[i] - rest.recording.motion.p_W_m[i]).norm());
  EXPECT_GT(largest_m, 1e-4);
  EXPECT_LT(largest_m, 2e-3);
}

// The wall between two flush blocks is there, twice, and nothing of it reaches above the plane.
TEST(Families, FlushBlocksHaveAWallInside) {
  const Tessellation made = recipe("flush").mesh();
  std::size_t in_the_wall = 0;
  for (std::size_t t = 0; t < made.mesh.triangle_count(); ++t) {
    bool wall = true;
    for (const auto v : made.mesh.triangles[t]) {
      const Vec3& p = made.mesh.vertices_W_m[static_cast<std::size_t>(v)];
      EXPECT_LE(p.z(), 0.0);
      wall = wall && std::abs(p.x()) < 1e-12;
    }
    in_the_wall += wall ? 1 : 0;
  }
  EXPECT_GT(in_the_wall, 3u);
}

}  // namespace
}  // namespace touchstone::datasets
