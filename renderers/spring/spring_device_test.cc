#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "renderers/catalogue.h"

namespace touchstone::renderers {
namespace {

using ::testing::HasSubstr;

// The half space below a plane through the origin.
class Plane final : public surface::Surface {
 public:
  explicit Plane(const Vec3& n) : n_(n) {}
  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p) const override {
    const double height = n_.dot(p);
    return {p - height * n_, n_, std::abs(height), height, -1, surface::Feature::analytic};
  }
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3&, const Vec3&) const override {
    return std::nullopt;
  }
  [[nodiscard]] Box3 bounds() const override { return {Vec3(-1, -1, -1), Vec3(1, 1, 1)}; }

 private:
  Vec3 n_;
};

std::unique_ptr<rendering::Renderer> renderer(const std::string& name, const std::string& parameters,
                                              const std::string& device = "", const Vec3& n = Vec3::UnitZ()) {
  const std::string effects =
      device.empty() ? "" : R"(,"effects":[{"name":"haptic-device","parameters":{)" + device + "}}]";
  return make_renderer(rendering::parse_model(R"({"schema":"touchstone-model/1","renderer":")" + name +
                                                  R"(","parameters":{)" + parameters + "}" + effects + "}",
                                              "m.json"),
                       std::make_shared<Plane>(n));
}

double press(rendering::Renderer& r, double t_s, double depth_m, const Vec3& n = Vec3::UnitZ()) {
  rendering::TipState tip;
  tip.t_s = t_s;
  tip.p_W_m = -depth_m * n;
  return r.step(tip).f_W_N.dot(n);
}

TEST(Spring, LinearAndQuadraticLawsInEveryDirectionAndScale) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 n = random.direction();
    const double d = random.log_uniform(1e-6, 1e2);
    const double k = random.log_uniform(1e-2, 1e6);
    auto linear = renderer("spring-linear", fmt::format(R"("stiffness_N_per_m":{:.17g})", k), "", n);
    auto quadratic = renderer("spring-quadratic", fmt::format(R"("coefficient_N_per_m2":{:.17g})", k), "", n);
    EXPECT_NEAR(press(*linear, 0.0, d, n), k * d, 1e-12 * k * d);
    EXPECT_NEAR(press(*quadratic, 0.0, d, n), k * d * d, 1e-12 * k * d * d);
    EXPECT_EQ(press(*linear, 1.0, -d, n), 0.0);
    EXPECT_EQ(press(*quadratic, 1.0, 0.0, n), 0.0);
  }
}

TEST(HapticDevice, WithoutLimitsChangesNothing) {
  auto bare = renderer("spring-linear", "");
  auto held = renderer("spring-linear", "", R"("force_limit_N":0)");
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(press(*bare, 0.001 * i, 1e-4 * i), press(*held, 0.001 * i, 1e-4 * i));
  }
}

TEST(HapticDevice, EachLimitDoesWhatItSays) {
  const std::string k = R"("stiffness_N_per_m":1000)";
  auto coarse = renderer("spring-linear", k, R"("resolution_m":0.001)");
  EXPECT_NEAR(press(*coarse, 0.0, 0.00249), 2.0, 1e-12);
  EXPECT_NEAR(press(*coarse, 0.1, 0.00251), 3.0, 1e-12);
  auto weak = renderer("spring-linear", k, R"("force_limit_N":3.3)");
  EXPECT_NEAR(press(*weak, 0.0, 0.002), 2.0, 1e-12);
  EXPECT_NEAR(press(*weak, 0.1, 0.009), 3.3, 1e-12);
  auto soft = renderer("spring-linear", k, R"("stiffness_limit_N_per_m":400)");
  EXPECT_NEAR(press(*soft, 0.0, 0.005), 2.0, 1e-12);
  // The encoder is quantised before the law: the square is that of the rounded depth.
  auto square = renderer("spring-quadratic", R"("coefficient_N_per_m2":1e6)", R"("resolution_m":0.001)");
  EXPECT_NEAR(press(*square, 0.0, 0.00249), 4.0, 1e-12);
}

TEST(HapticDevice, ServoPeriodHoldsTheForce) {
  auto slow = renderer("spring-linear", R"("stiffness_N_per_m":1000)", R"("servo_period_s":0.004)");
  for (int n = 0; n < 40; ++n) {
    const double expected = 1000.0 * 1e-4 * (n / 4 * 4);
    EXPECT_NEAR(press(*slow, 0.001 * n, 1e-4 * n), expected, 1e-12) << n;
  }
  slow->reset();
  EXPECT_NEAR(press(*slow, 0.0, 0.005), 5.0, 1e-12);  // forgets what it held
}

TEST(HapticDevice, TimeConstantIsAnExactFirstOrderLag) {
  for (const double dt : {1e-4, 1e-3, 3e-3}) {
    auto lagging = renderer("spring-linear", R"("stiffness_N_per_m":1000)", R"("time_constant_s":0.01)");
    for (int n = 0; n < 50; ++n) {
      const double t = n * dt;
      EXPECT_NEAR(press(*lagging, t, 0.005), 5.0 * (1.0 - std::exp(-t / 0.01)), 1e-9);
    }
  }
}

TEST(HapticDevice, TwoDevicesAndWrongParametersAreRefused) {
  const auto refused = [](const std::string& effects) {
    try {
      make_renderer(
          rendering::parse_model(
              R"({"schema":"touchstone-model/1","renderer":"spring-linear","effects":[)" + effects + "]}", "m.json"),
          std::make_shared<Plane>(Vec3::UnitZ()));
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(refused(R"({"name":"haptic-device"},{"name":"haptic-device"})"),
              HasSubstr("m.json: /effects/1: a second haptic-device"));
  EXPECT_THAT(refused(R"({"name":"haptic-device","parameters":{"resolution_mm":1}})"), HasSubstr("resolution_mm"));
  EXPECT_THAT(refused(R"({"name":"haptic-device","parameters":{"resolution_m":-1}})"), HasSubstr("resolution_m"));
}

}  // namespace
}  // namespace touchstone::renderers
