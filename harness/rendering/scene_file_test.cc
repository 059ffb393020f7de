#include "harness/rendering/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "harness/base/error.h"
#include "harness/surface/mesh_file.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::rendering {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class SceneFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    surface::save_mesh(testing::cube(10.0), folder_ / "cube.obj");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  SceneFile parse(const std::string& bodies, SceneFiles files = SceneFiles::anywhere) const {
    return parse_scene(R"({"schema": "touchstone-scene/1", "bodies": [)" + bodies + "]}", "scene.json", folder_, files);
  }
  [[nodiscard]] std::string refusal(const std::string& bodies, SceneFiles files = SceneFiles::anywhere) const {
    try {
      parse(bodies, files);
    } catch (const BadData& error) {
      return error.what();
    }
    return "none";
  }

  std::filesystem::path folder_;
};

TEST_F(SceneFileTest, ReadsBodiesAtRestRecordedAndByKeyframes) {
  write("path.csv", "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n2,0.2,0,0,0,0,0,1\n");
  write("scene.json", R"({"schema": "touchstone-scene/1", "bodies": [
    {"name": "floor", "mesh": "cube.obj", "unit": "mm"},
    {"name": "block", "mesh": "cube.obj", "unit": "mm", "pose": {"p_m": [1, 2, 3], "q_wxyz": [0, 1, 0, 0]}},
    {"name": "belt", "mesh": "cube.obj", "unit": "mm", "poses": "path.csv"},
    {"name": "wall", "mesh": "cube.obj", "unit": "mm", "keyframes": [
      {"t_s": 0, "p_m": [0, 0, 1]}, {"t_s": 1, "p_m": [0, 0, 2]}, {"t_s": 3, "p_m": [0, 0, 2]}]}]})");
  const BodyScene scene = load_scene(folder_ / "scene.json").scene();
  ASSERT_EQ(scene.bodies.size(), 4U);
  EXPECT_TRUE(scene.moves());
  EXPECT_EQ(scene.bodies[0].name, "floor");
  EXPECT_FALSE(scene.bodies[0].pose.moves());
  EXPECT_NEAR(scene.bodies[0].surface_B->bounds().max().x(), 0.01, 1e-15);
  EXPECT_FALSE(scene.bodies[1].pose.moves());
  EXPECT_NEAR((scene.bodies[1].pose.first().to_W({0.0, 0.01, 0.0}) - Vec3(1.0, 1.99, 3.0)).norm(), 0.0, 1e-15);
  std::size_t segment = 0;
  // Half a turn about z in 2 s: after one second a quarter of it, half of the way.
  const BodyPose belt = scene.bodies[2].pose.at(1.0, segment);
  EXPECT_NEAR((belt.p_W_m - Vec3(0.1, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((belt.to_W({0.01, 0, 0}) - Vec3(0.1, 0.01, 0)).norm(), 0.0, 1e-15);
  segment = 0;
  EXPECT_NEAR(scene.bodies[3].pose.at(0.25, segment).p_W_m.z(), 1.25, 1e-15);
  EXPECT_NEAR(scene.bodies[3].pose.at(2.5, segment).p_W_m.z(), 2.0, 1e-15);
  // Back again, as after a reset.
  EXPECT_NEAR(scene.bodies[3].pose.at(0.25, segment).p_W_m.z(), 1.25, 1e-15);
  EXPECT_FALSE(scene.bodies[3].pose.covers(3.1));
}

TEST_F(SceneFileTest, RescalesBodiesAndTheirWays) {
  SceneFile file = parse(R"({"name": "a", "mesh": "cube.obj", "keyframes": [
    {"t_s": 0, "p_m": [0, 0, 1]}, {"t_s": 2, "p_m": [0, 0, 3]}]})");
  file.rescale(0.5, 4.0);
  const BodyScene scene = file.scene();
  std::size_t segment = 0;
  EXPECT_NEAR(scene.bodies[0].surface_B->bounds().max().x(), 5.0, 1e-12);
  EXPECT_NEAR(scene.bodies[0].pose.at(0.25, segment).p_W_m.z(), 1.0, 1e-15);
  EXPECT_FALSE(scene.bodies[0].pose.covers(0.6));
}

TEST_F(SceneFileTest, JoinsBodiesWhereTheyBegin) {
  const BodyScene scene = parse(R"({"name": "a", "mesh": "cube.obj"},
                               {"name": "b", "mesh": "cube.obj", "pose": {"p_m": [100, 0, 0]}})")
                              .scene();
  const surface::TriangleMesh joined = joined_mesh(scene);
  EXPECT_EQ(joined.triangle_count(), 24U);
  EXPECT_NEAR(joined.bounds().max().x(), 110.0, 1e-12);
}

TEST_F(SceneFileTest, SaysWhatIsWrongAndWhere) {
  const std::string cube = R"("name": "a", "mesh": "cube.obj")";
  const std::map<std::string, std::vector<std::string>> cases{
      {"", {"scene.json: /bodies", "at least one body"}},
      {"{" + cube + R"(, "colour": 3})", {"/bodies/0", "colour"}},
      {"{" + cube + R"(, "unit": "inch"})", {"/bodies/0/unit", "inch"}},
      {"{" + cube + "}, {" + cube + "}", {"/bodies/1/name", "two bodies have the name \"a\""}},
      {R"({"name": "a", "mesh": "none.obj"})", {"none.obj"}},
      {"{" + cube + R"(, "pose": {"p_m": [1, 2]}})", {"/bodies/0/pose/p_m", "three numbers"}},
      {"{" + cube + R"(, "pose": {"q_wxyz": [1, 1, 0, 0]}})", {"/bodies/0/pose/q_wxyz", "length is 1.41421356"}},
      {"{" + cube + R"(, "pose": {"angle": 3}})", {"/bodies/0/pose", "angle"}},
      {"{" + cube + R"(, "pose": {}, "keyframes": []})", {"/bodies/0", "one of"}},
      {"{" + cube + R"(, "keyframes": [{"t_s": 0}]})", {"/bodies/0/keyframes", "1 poses", "at least two"}},
      {"{" + cube + R"(, "keyframes": [{"t_s": 1}, {"t_s": 1}]})", {"/bodies/0/keyframes", "pose 1", "t_s = 1"}},
  };
  for (const auto& [bodies, words] : cases) {
    const std::string said = refusal(bodies);
    for (const std::string& word : words) EXPECT_THAT(said, HasSubstr(word)) << bodies;
  }
  EXPECT_THAT(refusal(R"({"name": "a", "mesh": "../cube.obj"})", SceneFiles::own_folder),
              AllOf(HasSubstr("/bodies/0/mesh"), HasSubstr("own folder")));
  write("flat.csv", "t_s,x_m,y_m,z_m\n0,0,0,0\n2,0.2,0,0\n");
  EXPECT_THAT(refusal("{" + cube + R"(, "poses": "flat.csv"})"),
              AllOf(HasSubstr("flat.csv"), HasSubstr("no orientation")));
}

}  // namespace
}  // namespace touchstone::rendering
