// A gap that was closed becomes a golden case, and a renderer that opens it again fails.
#include <gmock/gmock.h>

#include <numbers>

#include "harness/base/random.h"
#include "harness/pipeline/discrepancy/sample_check.h"

namespace touchstone::pipeline {
namespace {

class Offer : public DiscrepancySamples {
 protected:
  // Accepting is refused under CI, where these tests run too: the part of the person is played without it.
  void SetUp() override {
    DiscrepancySamples::SetUp();
    unsetenv("CI");
  }

  std::string errors() const { return read_file(folder_ / "err.txt"); }
};

// Presses on a Hertzian half-space: force against displacement, without a mesh.
std::string presses() {
  Random random(3);
  std::string text = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
  for (int i = 0; i < 2500; ++i) {
    const double t_s = i / 250.0;
    const double z_m = 0.0015 - 0.004 * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * 0.8 * t_s));
    const double force_N = 600.0 * 0.002 * std::pow(std::max(0.0, -z_m) / 0.002, 1.5);
    text += fmt::format("{:.4f},0,0,{:.7f},{:.5f},{:.5f},{:.5f}\n", t_s, z_m + 1e-5 * random.normal(),
                        0.01 * random.normal(), 0.01 * random.normal(), force_N + 0.01 * random.normal());
  }
  return text;
}

TEST_F(Offer, AClosedGapBecomesAGoldenCaseThatPassesAndThatAChangedModelFails) {
  if (std::system("git --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "needs git";
  const auto place = folder_ / "checkout";
  std::filesystem::create_directories(place);
  write_file(folder_ / "press.csv", presses());
  write_file(folder_ / "base.json",
             R"({"schema":"touchstone-model/1","renderer":"god-object","parameters":{"stiffness_N_per_m":600}})");
  write_file(
      folder_ / "sensor.json",
      R"({"schema":"touchstone-instrument/1","force_noise_N":0.01,"position_noise_m":1e-5,"position_rate_Hz":250})");
  ASSERT_EQ(run(fmt::format("discrepancy --model '{0}/base.json' --recording '{0}/press.csv' --instrument "
                            "'{0}/sensor.json' --out '{0}/found' --golden '{1}/closed-gap'",
                            folder_.string(), place.string())),
            0)
      << errors();
  const auto findings = nlohmann::json::parse(read_file(folder_ / "found" / "findings.json"));
  EXPECT_EQ(findings.at("verdict"), "explained");
  EXPECT_EQ(findings.at("code"), "effects-explain");
  const std::string page = read_file(folder_ / "found" / "report.html");
  EXPECT_THAT(page, ::testing::HasSubstr("What decides the verdict"));
  EXPECT_EQ(findings.at("gates").size(), 10) << "more with a repeat or a tolerance";
  for (const auto& gate : findings.at("gates"))
    EXPECT_THAT(page, ::testing::HasSubstr(fmt::format("\"text\":\"{}\"", gate.at("code").get<std::string>())));
  ASSERT_EQ(findings.at("effects").size(), 1);
  EXPECT_EQ(findings.at("effects")[0].at("name"), "power-law-stiffness");
  for (const auto& p : findings.at("effects")[0].at("parameters")) {
    if (p.at("name") != "exponent") continue;
    EXPECT_LE(p.at("interval95")[0].get<double>(), 1.5);
    EXPECT_GE(p.at("interval95")[1].get<double>(), 1.5);
  }

  const auto commit = fmt::format(
      "cd '{}' && git init -q . && git add -A && git -c user.name=t -c user.email=t@example.org commit -q -m case",
      place.string());
  ASSERT_EQ(std::system(commit.c_str()), 0);
  const auto golden = [&](const std::string& command) {
    return run(
        fmt::format("{} closed-gap --golden '{}' --out '{}/pending'", command, place.string(), folder_.string()));
  };
  EXPECT_EQ(golden("check"), 1);  // nothing accepted yet
  EXPECT_EQ(golden("golden accept --reason 'gap closed'"), 0) << errors();
  EXPECT_EQ(golden("check"), 0) << read_file(folder_ / "out.txt");

  auto golden_case = nlohmann::json::parse(read_file(place / "closed-gap" / "case.json"));
  double& exponent = *golden_case["models"]["found"]["effects"][0]["parameters"]["exponent"].get_ptr<double*>();
  exponent *= 1.01;
  write_file(place / "closed-gap" / "case.json", golden_case.dump());
  EXPECT_EQ(golden("check"), 1);
}

}  // namespace
}  // namespace touchstone::pipeline
