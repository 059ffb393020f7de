#include "renderers/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "harness/base/error.h"

namespace touchstone::renderers {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The plane z = 0 without triangles.
class AnalyticPlane final : public surface::Surface {
 public:
  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p) const override {
    return {{p.x(), p.y(), 0.0}, Vec3::UnitZ(), std::abs(p.z()), p.z(), -1, surface::Feature::analytic};
  }
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3&, const Vec3&) const override {
    return std::nullopt;
  }
  [[nodiscard]] Box3 bounds() const override { return {Vec3(-1, -1, 0), Vec3(1, 1, 0)}; }
};

std::string refused(const std::string& text) {
  try {
    make_renderer(rendering::parse_model(text, "m.json"), std::make_shared<AnalyticPlane>());
  } catch (const BadData& error) {
    return error.what();
  }
  return "no error";
}

std::string model(const std::string& renderer, const std::string& rest = "") {
  return R"({"schema":"touchstone-model/1","renderer":")" + renderer + '"' + rest + "}";
}

TEST(Catalogue, EveryEntryIsCompleteAndNamedOnce) {
  std::set<std::string> names;
  for (const auto& entry : renderer_catalogue()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_FALSE(entry.summary.empty()) << entry.name;
    EXPECT_FALSE(entry.source.empty()) << entry.name;
    EXPECT_NE(entry.make, nullptr) << entry.name;
    std::set<std::string> parameters;
    for (const auto& parameter : entry.parameters) {
      EXPECT_TRUE(parameters.insert(parameter.name).second) << parameter.name;
      EXPECT_LE(parameter.minimum, parameter.initial) << parameter.name;
      EXPECT_LE(parameter.initial, parameter.maximum) << parameter.name;
      EXPECT_FALSE(parameter.unit.empty()) << parameter.name;
      EXPECT_FALSE(parameter.meaning.empty()) << parameter.name;
    }
  }
}

TEST(Catalogue, RefusesByNameWithThePlaceAndWhatIsKnown) {
  EXPECT_THAT(refused(model("god-objekt")),
              AllOf(HasSubstr("m.json: /renderer"), HasSubstr("did you mean \"god-object\"?")));
  EXPECT_THAT(refused(model("god-object", R"(,"parameters":{"stifness_N_per_m":1})")),
              AllOf(HasSubstr("/parameters/stifness_N_per_m"), HasSubstr("stiffness_N_per_m")));
  EXPECT_THAT(refused(model("god-object", R"(,"parameters":{"stiffness_N_per_m":-1})")), HasSubstr("out of range"));
  EXPECT_THAT(refused(model("god-object", R"(,"effects":[{"name":"magic"}])")),
              AllOf(HasSubstr("/effects/0/name"), HasSubstr("magic")));
  EXPECT_THAT(refused(model("god-object", R"(,"instrument":[{"name":"magic"}])")),
              AllOf(HasSubstr("/instrument/0/name"), HasSubstr("time-lag")));
  EXPECT_THAT(refused(model("god-object")), HasSubstr("without triangles"));
}

}  // namespace
}  // namespace touchstone::renderers
