// The effects of engines against CHAI3D's own answers (engine_answers_for_test.h), and against their laws by hand, on a
// plane, where gap and path are what the test makes them.
#include "renderers/effects/engine_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "harness/base/error.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/effects/engine_answers_for_test.h"
#include "renderers/effects/height_image.h"
#include "renderers/hand_for_test.h"

namespace touchstone::renderers {
using rendering::StepResult;

namespace {

constexpr double stiff = 800.0;

std::unique_ptr<rendering::Renderer> with(const std::string& effect, std::map<std::string, double> parameters,
                                          const std::string& image = {}) {
  rendering::Model model = model_of("god-object", {{"stiffness_N_per_m", stiff}});
  model.effects = {{effect, std::move(parameters), "/effects/0", image}};
  return make_renderer(model, make_embree_surface(testing::grid(1.0, 2)));
}

// What an effect adds to the god-object's k d along the path of engine_answers_for_test.h.
std::vector<Vec3> added_by(const std::string& effect, const std::map<std::string, double>& parameters) {
  const auto path = [](int i) -> Vec3 {
    return 1e-3 * Vec3(2.0 * std::sin(0.37 * i), 1.5 * std::cos(0.23 * i),
                       2.5 * std::sin(0.19 * i + 0.4) + std::sin(0.05 * i));
  };
  const auto renderer = with(effect, parameters);
  Hand hand(*renderer);
  hand.to(path(-1));
  std::vector<Vec3> added;
  for (int i = 0; i < static_cast<int>(std::size(engine_answers)); ++i)
    added.push_back(hand.to(path(i)).f_W_N - stiff * std::max(0.0, -path(i).z()) * Vec3::UnitZ());
  return added;
}

// 72 samples, of which the tip is in contact in 29 and slips and sticks again in each of the contacts; seven digits.
TEST(EngineEffects, AreThoseOfChai3dItself) {
  const auto outside = added_by("magnet", {{"force_N", 0.4}, {"distance_m", 3e-3}});
  const auto inside = added_by("magnet", {{"force_N", 0.4}, {"distance_m", 3e-3}, {"inside", 1.0}});
  const auto stick_slip = added_by("stick-slip", {{"stiffness_N_per_m", 100.0}, {"force_N", 0.15}});
  const auto viscosity = added_by("viscosity", {{"coefficient_N_s_per_m", 0.05}});
  int held = 0;
  for (std::size_t i = 0; i < std::size(engine_answers); ++i) {
    const EngineAnswer& answer = engine_answers[i];
    EXPECT_NEAR((outside[i] - Vec3(0.0, 0.0, answer.magnet_z_N)).norm(), 0.0, 1e-7) << i;
    EXPECT_NEAR((inside[i] - Vec3(0.0, 0.0, answer.magnet_inside_z_N)).norm(), 0.0, 1e-7) << i;
    EXPECT_NEAR((stick_slip[i] - Vec3(answer.stick_slip_N.data())).norm(), 0.0, 1e-7) << i;
    EXPECT_NEAR((viscosity[i] - Vec3(answer.viscosity_N.data())).norm(), 0.0, 1e-7) << i;
    held += stick_slip[i].norm() > 0.01 ? 1 : 0;
  }
  EXPECT_GT(held, 10);
}

// F = 0.4 N, k = 800 N/m: the pull grows to F at 0.5 mm and falls to zero at 4 mm.
TEST(EngineEffects, AMagnetPullsByTheGap) {
  const auto renderer = with("magnet", {{"force_N", 0.4}, {"distance_m", 4e-3}});
  const std::map<double, double> pull{{5e-3, 0.0},  {4e-3, 0.0},  {3e-3, 0.4 / 3.5}, {5e-4, 0.4},
                                      {2e-4, 0.16}, {1e-6, 8e-4}, {-1e-4, -0.08},    {-1e-3, -0.8}};
  Hand hand(*renderer);
  for (auto gap = pull.rbegin(); gap != pull.rend(); ++gap) {
    const StepResult result = hand.to({0.1, 0.05, gap->first});
    EXPECT_NEAR(result.f_W_N.z(), -gap->second, 1e-12) << gap->first;
    EXPECT_EQ(result.contact, gap->first < 0.0);
  }
  // Inside, too: 0.1 mm deep the contact's 0.08 N and as much of the magnet; 1 mm deep 0.8 N and 0.4 (4 - 1) / 3.5 N.
  const auto both = with("magnet", {{"force_N", 0.4}, {"distance_m", 4e-3}, {"inside", 1.0}});
  Hand second(*both);
  second.to({0.1, 0.05, 1e-3});
  EXPECT_NEAR(second.to({0.1, 0.05, -1e-4}).f_W_N.z(), 0.16, 1e-12);
  EXPECT_NEAR(second.to({0.1, 0.05, -1e-3}).f_W_N.z(), 0.8 + 0.4 * 3.0 / 3.5, 1e-12);
}

// A switch that a fit or a sweep puts between its ends: rounded.
TEST(EngineEffects, AMagnetPushesOutOfTheInsideFromAHalfOn) {
  for (const auto& [inside, force_N] : {std::pair{0.499, 0.08}, {0.5, 0.16}, {0.505, 0.16}}) {
    const auto renderer = with("magnet", {{"force_N", 0.4}, {"distance_m", 4e-3}, {"inside", inside}});
    Hand hand(*renderer);
    hand.to({0.1, 0.05, 1e-3});
    EXPECT_NEAR(hand.to({0.1, 0.05, -1e-4}).f_W_N.z(), force_N, 1e-12) << inside;
  }
}

// F = 0.8 N, k = 800 N/m: the pull would turn at 1 mm, and ends at 2^-11 m = 0.49 mm, where it is k times that.
TEST(EngineEffects, AMagnetEndsAtItsDistanceAlsoBeforeItTurns) {
  const double distance_m = 0x1p-11;
  const auto renderer = with("magnet", {{"force_N", 0.8}, {"distance_m", distance_m}});
  Hand hand(*renderer);
  for (const double gap_m : {2e-3, 1.5e-3, 0.9e-3, distance_m})
    EXPECT_EQ(hand.to({0.1, 0.05, gap_m}).f_W_N, Vec3::Zero()) << gap_m;
  EXPECT_NEAR(hand.to({0.1, 0.05, std::nextafter(distance_m, 0.0)}).f_W_N.z(), -stiff * distance_m, 1e-12);
  // Inside it is the same from the other side: 0.4 mm deep the contact's force twice, 0.49 mm deep the contact's alone.
  const auto both = with("magnet", {{"force_N", 0.8}, {"distance_m", distance_m}, {"inside", 1.0}});
  Hand second(*both);
  second.to({0.1, 0.05, 1e-3});
  EXPECT_NEAR(second.to({0.1, 0.05, -4e-4}).f_W_N.z(), 2.0 * stiff * 4e-4, 1e-12);
  EXPECT_NEAR(second.to({0.1, 0.05, -distance_m}).f_W_N.z(), stiff * distance_m, 1e-12);
}

// A spring of 100 N/m that slips at 0.05 N: the tip sticks for 0.5 mm, and again from where it slipped.
TEST(EngineEffects, StickSlipIsASawtooth) {
  const auto renderer = with("stick-slip", {{"stiffness_N_per_m", 100.0}, {"force_N", 0.05}});
  Hand hand(*renderer);
  hand.to({0.0, 0.0, 1e-3});
  hand.to({0.0, 0.0, -1e-3});
  for (int i = 1; i <= 40; ++i) {
    const StepResult result = hand.to({1e-4 * i, 0.0, -1e-3});
    // 0.1 mm a step: five steps hold it, the sixth slips.
    EXPECT_NEAR(result.f_W_N.x(), -0.01 * (i % 6), 1e-9) << i;
    EXPECT_NEAR(result.f_W_N.z(), 0.8, 1e-9);
  }
  // Of any direction: pressed 0.2 mm deeper the spring pushes out.
  hand.to({0.0, 0.0, 1e-3});
  hand.to({0.0, 0.0, -1e-3});
  EXPECT_NEAR(hand.to({0.0, 0.0, -1.2e-3}).f_W_N.z(), stiff * 1.2e-3 + 0.02, 1e-9);
  // Left and touched again, it sticks where it is touched.
  hand.to({0.01, 0.0, 1e-3});
  EXPECT_NEAR(hand.to({0.01, 0.0, -1e-3}).f_W_N.x(), 0.0, 1e-15);
}

TEST(EngineEffects, ViscosityHoldsBackInEveryDirection) {
  const auto renderer = with("viscosity", {{"coefficient_N_s_per_m", 3.0}});
  Hand hand(*renderer);
  hand.to({0.0, 0.0, 1e-3});
  hand.to({0.0, 0.0, -1e-3});
  const StepResult result = hand.to({2e-5, -1e-5, -9e-4});  // (20, -10, 100) mm/s, leaving
  EXPECT_NEAR((result.f_W_N - Vec3(-0.06, 0.03, stiff * 9e-4 - 0.3)).norm(), 0.0, 1e-9);
  // Faster out than the spring pushes: it is held.
  EXPECT_NEAR(hand.to({2e-5, -1e-5, -1e-4}).f_W_N.z(), stiff * 1e-4 - 3.0 * 0.8, 1e-9);
  EXPECT_EQ(hand.to({2e-5, -1e-5, 1e-4}).f_W_N, Vec3::Zero());
}

// A run that begins in contact: no step yet, and no velocity.
TEST(EngineEffects, ViscosityIsNothingBeforeTheFirstMotion) {
  const auto renderer = with("viscosity", {{"coefficient_N_s_per_m", 3.0}});
  Hand hand(*renderer);
  EXPECT_EQ(hand.to({0.0, 0.0, -1e-3}).f_W_N, Vec3(0.0, 0.0, stiff * 1e-3));
  EXPECT_EQ(hand.to({0.0, 0.0, -1e-3}).f_W_N, Vec3(0.0, 0.0, stiff * 1e-3));
}

class HeightImageFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  [[nodiscard]] std::string refusal() const {
    try {
      load_height_image(path_);
    } catch (const BadData& error) {
      return error.what();
    }
    return "none";
  }
  std::filesystem::path path_ =
      std::filesystem::path(::testing::TempDir()) / ("image-" + std::to_string(::getpid()) + ".pgm");
};

TEST_F(HeightImageFile, SaysHowManyBytesAreMissing) {
  write("P2\n2 2\n9\n1");
  EXPECT_THAT(refusal(), ::testing::HasSubstr("4 pixels need 4 bytes at least, 2 are there"));
  write(std::string("P5\n2 2\n999\n") + "1234567");
  EXPECT_THAT(refusal(), ::testing::HasSubstr("4 pixels need 8 bytes at least, 7 are there"));
}

// Four pixels of 2 mm: 0 and 100 above, 40 and 20 below, white is 100.
TEST_F(HeightImageFile, GivesHeightsBetweenThePixels) {
  write("P2 # heights\n2 2\n# white\n100\n0 100\n40 20\n");
  const auto renderer =
      with("height-image", {{"amplitude_m", 1e-3}, {"pixel_m", 2e-3}, {"x_m", 0.01}, {"y_m", 0.02}}, path_.string());
  Hand hand(*renderer);
  const auto height = [&](double u, double v) {
    const double force = hand.to({0.01 + 2e-3 * u, 0.02 + 2e-3 * v, -2e-3}).f_W_N.z();
    return (force / stiff - 2e-3) / 1e-3 + 0.5;
  };
  EXPECT_NEAR(height(0.5, 0.5), 0.4, 1e-6);  // lower left
  EXPECT_NEAR(height(1.5, 0.5), 0.2, 1e-6);
  EXPECT_NEAR(height(0.5, 1.5), 0.0, 1e-6);  // the first row is the upper one
  EXPECT_NEAR(height(1.5, 1.5), 1.0, 1e-6);
  EXPECT_NEAR(height(1.0, 0.5), 0.3, 1e-6);
  EXPECT_NEAR(height(1.0, 1.0), 0.4, 1e-6);  // the mean of all four
  EXPECT_NEAR(height(0.75, 1.25), 0.0625 * 0.2 + 0.1875 * 0.4 + 0.1875 * 1.0, 1e-6);
  EXPECT_NEAR(height(8.5, -7.5), 0.4, 1e-6);  // it repeats
  EXPECT_NEAR(height(2.0, 0.5), 0.3, 1e-6);   // across its border
}

TEST_F(HeightImageFile, ReadsBinaryPicturesOf8And16Bits) {
  write(std::string("P5\n3 1\n255\n") + std::string("\x00\x33\xff", 3));
  const HeightImage eight = load_height_image(path_);
  EXPECT_EQ(eight.width, 3U);
  EXPECT_FLOAT_EQ(eight.grey[1], 0.2F);
  EXPECT_FLOAT_EQ(eight.grey[2], 1.0F);
  write(std::string("P5 1 2 65535\n") + std::string("\x33\x33\xff\xff", 4));
  const HeightImage sixteen = load_height_image(path_);
  EXPECT_EQ(sixteen.height, 2U);
  EXPECT_FLOAT_EQ(sixteen.grey[0], 0.2F);
}

TEST_F(HeightImageFile, SaysWhatIsWrong) {
  using ::testing::HasSubstr;
  const std::map<std::string, std::string> cases{{"", "P2 or P5"},
                                                 {"P6\n1 1\n255\n   ", "P2 or P5"},
                                                 {"P2\n0 4\n255\n", "no picture"},
                                                 {"P2\n2 2\n0\n1 2 3 4", "no picture"},
                                                 {"P2\n2 2\n99999\n1 2 3 4", "value of white"},
                                                 {"P2\n2 2\n9\n1 2 3", "a pixel"},
                                                 {"P2\n2 2\n9\n1 2 x 4  ", "a pixel"},
                                                 {"P2\n2 2\n9\n1 2 10 4  ", "a pixel"},
                                                 {"P5\n2 2\n255\n123", "ends early"},
                                                 {"P5\n1 1\n100\n\xff", "above white"},
                                                 {"P5\n268435456 268435456\n255\n", "no picture"},
                                                 {"P5\n99999999999999999999 1\n255\n", "the width"}};
  for (const auto& [bytes, words] : cases) {
    write(bytes);
    EXPECT_THAT(refusal(), ::testing::AllOf(HasSubstr(path_.string()), HasSubstr(words))) << bytes;
  }
  const auto said = [&](const std::string& effect, const std::string& image) {
    try {
      with(effect, {}, image);
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(said("height-image", ""), HasSubstr("/effects/0: \"image\" is missing"));
  EXPECT_THAT(said("viscosity", "x.pgm"), HasSubstr("viscosity takes no \"image\""));
  EXPECT_THAT(said("height-image", "none.pgm"), HasSubstr("none.pgm"));
}

}  // namespace
}  // namespace touchstone::renderers
