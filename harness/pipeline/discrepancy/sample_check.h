// Runs the program on a sample recording with a known answer and checks what it says. For the tests of every commit and
// of the night.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/recording/recording_file.h"
#include "harness/testing/built_program.h"
#include "harness/testing/shared_data.h"

namespace touchstone::pipeline {

class DiscrepancySamples : public testing::BuiltProgram {
 protected:
  int run(const std::string& arguments) const { return testing::BuiltProgram::run(arguments).status; }

  // Of the folder data/discrepancy-sample.
  void check(const std::filesystem::path& samples, const std::string& id) const {
    nlohmann::json answer;
    const auto answers = nlohmann::json::parse(read_file(samples / "answers.json"));
    for (const auto& one : answers.at("cases")) {
      if (one.at("id") == id) answer = one;
    }
    ASSERT_FALSE(answer.is_null());
    const auto place = samples / id;
    ASSERT_EQ(run(fmt::format("discrepancy --model {0}/model.json --mesh {0}/mesh.obj --recording {0}/train.csv "
                              "--holdout {0}/holdout.csv --instrument {0}/instrument.json --out {1}",
                              place.string(), folder_.string())),
              0)
        << read_file(folder_ / "err.txt");
    const auto findings = nlohmann::json::parse(read_file(folder_ / "findings.json"));
    EXPECT_EQ(findings.at("verdict"), answer.at("expected_verdict"));
    const auto names = [](const nlohmann::json& effects) {
      std::set<std::string> all;
      for (const auto& effect : effects) all.insert(effect.at("name").get<std::string>());
      return all;
    };
    if (answer.at("expected_verdict") != "unexplained") {
      EXPECT_EQ(names(findings.at("effects")), names(answer.at("effects")));
    }
    const auto& gap = findings.at("gap");
    const double after = gap.at("holdout").at("after").get<double>();
    EXPECT_NEAR(gap.at("fresh_process_after").get<double>(), after, 1e-9);
    const auto& truth = answer.at("gap_N").at("holdout");
    if (!truth.contains("noise_floor")) return;
    const double floor = truth.at("noise_floor").get<double>();
    const double before = truth.at("before").get<double>();
    EXPECT_GT((before * before - after * after) / (before * before - floor * floor), 0.9);
    // The noise model stands on what the makers declare; the truth adds what they do not (a filter's smear, sticking).
    const double expected = gap.at("noise_floor").get<double>();
    EXPECT_GT(expected, 0.5 * floor);
    EXPECT_LT(expected, 1.35 * floor);
    for (const auto& effect : answer.at("effects")) {
      for (const auto& found : findings.at("effects")) {
        if (found.at("name") != effect.at("name")) continue;
        for (const auto& parameter : found.at("parameters")) {
          const auto name = parameter.at("name").get<std::string>();
          if (!effect.at("parameters").contains(name)) continue;
          const double value = effect.at("parameters").at(name).get<double>();
          EXPECT_NEAR(parameter.at("value").get<double>(), value, 0.05 * std::abs(value)) << name;
        }
      }
    }
  }
};

}  // namespace touchstone::pipeline
