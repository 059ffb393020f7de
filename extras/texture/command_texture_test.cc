// `touchstone texture` as a user runs it: a model is played over a mesh, fitted and compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "harness/base/json_reader.h"
#include "harness/testing/built_program.h"
#include "made_texture_for_test.h"

namespace touchstone::texture {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;

class TextureCommand : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    BuiltProgram::SetUp();
    if (IsSkipped()) return;
    write_file(folder_ / "plate.obj", "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "texture.json", R"({"schema": "touchstone-model/1", "renderer": "texture"})");
    write_file(folder_ / "made.xml", texture_model_to_xml(made_texture()));
    write_path("path.csv", 1000.0);
  }
  // Circles at three speeds, 2 mm deep, 8 s each.
  void write_path(const std::string& name, double rate_Hz) const {
    std::string text = "t_s,x_m,y_m,z_m\n";
    double angle = 0.0;
    const int hold = static_cast<int>(8.0 * rate_Hz);
    for (int i = 0; i < 3 * hold; ++i) {
      const double speed = 0.05 * (1 + i / hold);
      angle += speed / 0.03 / rate_Hz;
      const double depth = 0.002 * std::min(1.0, i / rate_Hz);
      text += fmt::format("{:.6f},{:.9f},{:.9f},{:.9f}\n", i / rate_Hz, 0.03 * std::cos(angle), 0.03 * std::sin(angle),
                          -depth);
    }
    write_file(folder_ / name, text);
  }
  // The first seven columns of a file.
  [[nodiscard]] std::vector<std::array<double, 7>> rows(const std::string& name) const {
    std::istringstream text(read_file(folder_ / name));
    std::vector<std::array<double, 7>> result;
    std::string line;
    std::getline(text, line);
    while (std::getline(text, line)) {
      std::istringstream fields(line);
      for (double& value : result.emplace_back()) {
        fields >> value;
        fields.ignore();
      }
    }
    return result;
  }
  void play(const std::string& plugin, const std::string& path, const std::string& out) const {
    const Outcome played = run(fmt::format(
        "replay --model texture.json --plugin {} --mesh plate.obj --trajectory {} --out {}", plugin, path, out));
    ASSERT_EQ(played.status, 0) << played.err;
  }
};

TEST_F(TextureCommand, AModelIsPlayedFittedAndCompared) {
  const Outcome made = run("texture plugin made.xml --out made.so");
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("plays made & <told> up to 200 mm/s and 2 N"));
  play("made.so", "path.csv", "played.csv");
  const Outcome same = run("texture compare made.xml played.csv --json same.json --picture same.png");
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_EQ(load_json(folder_ / "same.json").at("verdict"), "same");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "same.png"));

  const Outcome fitted = run("texture fit played.csv --out fitted.xml --material told");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_THAT(fitted.out, HasSubstr("friction 0.35"));
  ASSERT_EQ(run("texture plugin fitted.xml --out fitted.so").status, 0);
  play("fitted.so", "path.csv", "again.csv");
  // The same with the force by the probe.
  std::string reversed;
  for (const auto& [t, x, y, z, fx, fy, fz] : rows("played.csv"))
    reversed += fmt::format("{},{},{},{},{},{},{}\n", t, x, y, z, -fx, -fy, -fz);
  write_file(folder_ / "reversed.csv", "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n" + reversed);
  EXPECT_THAT(run("texture compare made.xml reversed.csv").err, HasSubstr("--flip-force"));
  EXPECT_EQ(run("texture compare made.xml reversed.csv --flip-force").status, 0);
  for (const char* const expected : {"made.xml", "fitted.xml", "played.csv"}) {
    const Outcome again = run(fmt::format("texture compare {} again.csv", expected));
    EXPECT_EQ(again.status, 0) << expected << "\n" << again.out << again.err;
  }
}

TEST_F(TextureCommand, AnotherTextureFailsAndTheSameAtAnotherRateDoesNot) {
  TextureModel other = made_texture();
  for (TextureNode& node : other.nodes) node.variance *= 5.0;
  write_file(folder_ / "other.xml", texture_model_to_xml(other));
  ASSERT_EQ(run("texture plugin other.xml --out other.so").status, 0);
  play("other.so", "path.csv", "played.csv");
  EXPECT_EQ(run("texture compare other.xml played.csv").status, 0);
  const Outcome different = run("texture compare made.xml played.csv");
  EXPECT_EQ(different.status, 1);
  EXPECT_THAT(different.out, HasSubstr("different: "));
  write_path("fast.csv", 2500.0);
  play("other.so", "fast.csv", "fast-played.csv");
  const Outcome fast = run("texture compare other.xml fast-played.csv");
  EXPECT_EQ(fast.status, 0) << fast.out << fast.err;
}

// Without its vibration it is a renderer like any other; with it, it leaves the friction cone and nothing else.
TEST_F(TextureCommand, ThePluginPassesTheConformanceSuite) {
  const auto conformance = std::filesystem::path(program_).parent_path() / "touchstone-conformance";
  if (!std::filesystem::exists(conformance)) GTEST_SKIP() << "needs " << conformance;
  ASSERT_EQ(run("texture plugin made.xml --out made.so").status, 0);
  for (const char* const options :
       {"--parameter=effective_mass_kg=0", "'--gtest_filter=*RendererConformance*-*FrictionConeAndNeverPulls*'"}) {
    const Outcome suite = testing::run_command(
        fmt::format("'{}' --plugin=made.so --no-cases --friction=0.35 {}", conformance.string(), options), folder_);
    // Not all that it prints: what it skips would make ctest take this test for skipped.
    EXPECT_EQ(suite.status, 0) << options
                               << suite.out.substr(std::min(suite.out.size(), suite.out.rfind("[  FAILED  ]")));
    EXPECT_THAT(suite.out, HasSubstr("StepAllocatesNothing"));
  }
}

TEST_F(TextureCommand, WhatCannotBeUsedIsSaid) {
  write_file(folder_ / "wrong.xml", "<modelSet><AccelUnits>g</AccelUnits></modelSet>");
  const Outcome wrong = run("texture plugin wrong.xml --out wrong.so");
  EXPECT_EQ(wrong.status, 3);
  EXPECT_THAT(wrong.err, HasSubstr("wrong.xml: line 1: <AccelUnits>: 'g'"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "wrong.so"));
  EXPECT_EQ(run("texture compare made.xml path.csv").status, 3) << "it has no forces";
  EXPECT_EQ(run("texture fit path.csv --out x.xml --normal 0,0,0").status, 2);
  EXPECT_EQ(run("texture fit path.csv --out x.xml --texture 3").status, 2) << "it is no folder";
  const Outcome no_friction = run("texture fit . --texture 3 --out x.xml");
  EXPECT_EQ(no_friction.status, 2);
  EXPECT_THAT(no_friction.err, HasSubstr("texture_list.xlsx"));
  EXPECT_EQ(run("texture fit . --texture 3 --mu 0.4 --out x.xml").status, 3);
  // The plug-in as it is installed has no model.
  const Outcome empty =
      run(fmt::format("replay --model texture.json --plugin '{}' --mesh plate.obj --trajectory path.csv --out x.csv",
                      testing::environment("TOUCHSTONE_TEXTURE_PLUGIN")));
  EXPECT_NE(empty.status, 0);
  EXPECT_THAT(empty.err, HasSubstr("holds no texture; `touchstone texture plugin"));
}

}  // namespace
}  // namespace touchstone::texture
