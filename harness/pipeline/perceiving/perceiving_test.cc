// What a person would notice, from files to a report, by the judge and by the paper's method.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/pipeline/perceiving/by_paper.h"
#include "harness/pipeline/perceiving/judging.h"
#include "harness/pipeline/perceiving/processes.h"
#include "harness/testing/temporary_folder.h"
#include "renderers/catalogue.h"

namespace touchstone::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class Perceiving : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) {
    write_file(folder_.path() / name, text);
    return (folder_.path() / name).string();
  }
  // Presses of 10 mm from 1 mm above the surface on a spring of `k` N/m.
  std::string press(const std::string& name, double k, double seconds = 5.0) {
    std::string text = "t_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N\n";
    for (int n = 0; n < static_cast<int>(seconds * 500); ++n) {
      const double depth = -1.0 + 5.5 * (1.0 - std::cos(2.0 * std::numbers::pi * n / 500.0));
      text += fmt::format("{:.3f},0,0,{:.6f},0,0,{:.6f}\n", n / 500.0, -depth, 1e-3 * k * std::max(0.0, depth));
    }
    return file(name, text);
  }
  // A spring of 250 N/m under the same presses.
  PerceiveRequest request_with_model() {
    PerceiveRequest request;
    request.real = press("real.csv", 500);
    request.conditions = {{"same", press("same.csv", 500)}};
    rendering::Model soft;
    soft.renderer = "spring-linear";
    soft.parameters["stiffness_N_per_m"] = 250.0;
    request.models = {{"soft", file("soft.json", "{}"), soft}};
    request.mesh = file("plane.obj", "v -100 -100 0\nv 100 -100 0\nv 100 100 0\nv -100 100 0\nf 1 2 3\nf 1 3 4\n");
    request.mesh_unit = "mm";
    return request;
  }
  testing::TemporaryFolder folder_;
};

TEST_F(Perceiving, TheJudgeTellsTheSoftModelFromTheRealSpring) {
  PerceiveRequest request = request_with_model();
  request.repeats = {press("again.csv", 500, 8.0)};
  const JudgedFiles files = judge_files(renderers::built_in_catalogue(), request);
  ASSERT_EQ(files.judged.conditions.size(), 2U);
  EXPECT_EQ(files.judged.conditions[0].rank, 1U);
  EXPECT_GT(files.judged.conditions[1].judgement.d_prime, 2.0) << "half the stiffness";
  // The condition that is hardest to tell stands first, whatever the order of the request.
  EXPECT_LT(files.table().find("same"), files.table().find("soft"));
  std::vector<std::string> roles;
  for (const report::InputFile& input : files.provenance.inputs) roles.push_back(input.role);
  EXPECT_THAT(roles, ::testing::ElementsAre("real", "repeat", "condition same", "mesh", "model soft"));
  write_judged(files, folder_.path());
  const auto json = nlohmann::json::parse(read_file(folder_.path() / "perception.json"));
  EXPECT_EQ(json["method"], "judge");
  EXPECT_THAT(read_file(folder_.path() / "report.html"), HasSubstr("What a person would notice"));
}

// A best guess of 99 % beside "cannot tell" would be read as a finding.
TEST(JudgedTable, WhereTheRecordingsCannotTellTheIntervalAloneStands) {
  JudgedFiles files;
  perception::JudgedCondition& condition = files.judged.conditions.emplace_back();
  condition.name = "perhaps";
  condition.judgement.noticed_probability = 0.99;
  condition.judgement.noticed_low95 = 0.5;
  condition.judgement.noticed_high95 = 1.0;
  EXPECT_THAT(files.table(), ::testing::AllOf(HasSubstr("50 to 100"), ::testing::Not(HasSubstr("99 %"))));
  condition.judgement.verdict = perception::Verdict::noticed;
  EXPECT_THAT(files.table(), HasSubstr("99 %"));
}

TEST_F(Perceiving, EachRemarkIsSaidOnce) {
  PerceiveRequest request;
  request.real = press("real.csv", 500);
  request.conditions = {{"a", press("a.csv", 400)}, {"b", press("b.csv", 300)}};
  const JudgedFiles files = judge_files(renderers::built_in_catalogue(), request);
  const std::vector<std::string> remarks = files.remarks();
  ASSERT_FALSE(remarks.empty());
  for (const std::string& remark : remarks) EXPECT_EQ(std::ranges::count(remarks, remark), 1) << remark;
}

TEST_F(Perceiving, ThePapersMethodRanksTheSameFiles) {
  PerceiveRequest request = request_with_model();
  request.conditions.push_back({"odd", press("odd.csv", 700)});
  const PaperFiles files = evaluate_by_paper(renderers::built_in_catalogue(), request);
  EXPECT_EQ(files.evaluation.conditions[0].rank_perception, 1U) << files.table();
  EXPECT_FALSE(files.people.has_value());
  write_by_paper(files, folder_.path());
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_.path() / "perception.json"))["schema"], "touchstone-perception/1");
}

TEST_F(Perceiving, WhatThereIsNotIsNamed) {
  PerceiveRequest request = request_with_model();
  request.direction = "up";
  EXPECT_THAT([&] { judge_files(renderers::built_in_catalogue(), request); },
              ThrowsMessage<UsageError>(HasSubstr("--direction up")));
  request.direction = "+z";
  request.judge.without = {"smell"};
  EXPECT_THAT([&] { judge_files(renderers::built_in_catalogue(), request); },
              ThrowsMessage<UsageError>(HasSubstr("--without smell")));
  request.judge.without = {};
  request.models[0].model.renderer = "sprung";
  EXPECT_THAT([&] { judge_files(renderers::built_in_catalogue(), request); },
              ThrowsMessage<BadData>(HasSubstr("sprung")));
  request.real = press("thumb.csv", 500) + "+" + press("finger.csv", 500);
  EXPECT_THAT([&] { evaluate_by_paper(renderers::built_in_catalogue(), request); },
              ThrowsMessage<UsageError>(HasSubstr("several parts")));
}

TEST_F(Perceiving, TheForceIsReversedWhereItIsSaidToBe) {
  PerceiveRequest request;
  const std::string real = press("real.csv", 500);
  request.flip_force = true;
  EXPECT_LE(read_recording(request, real).f_W_N[250].z(), -4.9);
  EXPECT_EQ(press_direction_of("-y", {}), Vec3(0, -1, 0));
}

}  // namespace
}  // namespace touchstone::pipeline
