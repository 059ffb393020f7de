// Models between their nodes, their files, and files that are none.
#include "texture_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <tuple>
#include <utility>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/testing/temporary_folder.h"
#include "made_texture_for_test.h"
#include "texture_library.h"

namespace touchstone::texture {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(TextureModel, ANodeIsItselfAndBetweenTwoTheFrequenciesAreMeans) {
  const TextureModel model = made_texture();
  const TextureFilter at_node = filter_at(model, 0.1, 1.0);
  const std::vector<double> a = resonance(120.0, 0.93, 1000.0);
  EXPECT_NEAR(at_node.variance, 0.1, 1e-15);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(at_node.ar[i], a[i], 1e-12);
  // A third of the way from node 4 to node 2.
  const TextureFilter between = filter_at(model, 0.1 + 0.1 / 3.0, 1.0 + 1.0 / 3.0);
  EXPECT_NEAR(between.variance, 0.2, 1e-12);
  std::vector<double> angles;
  for (std::size_t i = 0; i < 2; ++i)
    angles.push_back((2.0 * model.nodes[4].ar_rad[i] + model.nodes[2].ar_rad[i]) / 3.0);
  std::vector<double> expected(3);
  polynomial_of(angles, expected);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(between.ar[i], expected[i], 1e-12);
}

TEST(TextureModel, TheNumeratorIsTimesTheGainBetweenNodesToo) {
  TextureModel model = made_texture();
  for (TextureNode& node : model.nodes) {
    node.ma_rad = {0.9, 1.6};
    node.gain = 2.0 + node.force_N;
  }
  std::vector<double> numerator(3);
  polynomial_of(model.nodes[0].ma_rad, numerator);
  const TextureFilter filter = filter_at(model, 0.1, 1.5);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(filter.ma[i], 3.5 * numerator[i], 1e-12);
}

TEST(TextureModel, BeyondTheLargestSpeedAndForceItIsThatOfTheLargest) {
  const TextureModel model = made_texture();
  const TextureFilter corner = filter_at(model, 0.2, 2.0), beyond = filter_at(model, 5.0, 30.0);
  EXPECT_EQ(corner.variance, beyond.variance);
  EXPECT_EQ(corner.ar, beyond.ar);
  EXPECT_EQ(filter_at(model, -1.0, 1.0).variance, 0.0) << "at rest it is silent";
}

// Of one pole the variance is known, and so is the integral of the density; of the numerator the square of the gain.
TEST(TextureModel, TheDensityIntegratesToTheVariance) {
  TextureFilter filter;
  filter.ar_count = 1;
  filter.ar = {1.0, -0.8};
  filter.ma_count = 1;
  filter.ma = {3.0, 1.5};
  filter.variance = 0.25;
  double sum = 0.0;
  constexpr int steps = 2000;
  for (int i = 0; i < steps; ++i) sum += filter.density((i + 0.5) * 500.0 / steps, 1000.0) * 500.0 / steps;
  // ARMA(1,1): sigma^2 (b0^2 + b1^2 - 2 a b0 b1) / (1 - a^2), Brockwell and Davis 1991, example 3.4.1.
  EXPECT_NEAR(sum, 0.25 * (9.0 + 2.25 + 2.0 * 0.8 * 4.5) / (1.0 - 0.64), 1e-9);
}

TEST(TextureFile, WhatIsWrittenIsRead) {
  TextureModel model = made_texture(2500.0);
  for (TextureNode& node : model.nodes) {
    node.ma_rad = {0.4, 1.1, 2.7};
    node.gain = 7.25;
  }
  const TextureModel read = parse_texture_model(texture_model_to_xml(model), "made.xml");
  EXPECT_EQ(read.material, model.material);
  EXPECT_EQ(read.rate_Hz, 2500.0);
  EXPECT_EQ(read.mu, model.mu);
  ASSERT_EQ(read.nodes.size(), model.nodes.size());
  EXPECT_EQ(read.triangles, model.triangles);
  const TextureFilter a = filter_at(model, 0.13, 1.7), b = filter_at(read, 0.13, 1.7);
  EXPECT_NEAR(a.density(150.0, 2500.0) / b.density(150.0, 2500.0), 1.0, 1e-9);
}

// A name, what stands in a whole file, what stands there instead, and what is said of it.
class BrokenTextureFile : public ::testing::TestWithParam<std::array<std::string, 4>> {};

TEST_P(BrokenTextureFile, IsRefusedWithLineElementAndValue) {
  std::string xml = texture_model_to_xml(made_texture());
  const auto& [from, to, said] = std::tie(GetParam()[1], GetParam()[2], GetParam()[3]);
  const std::size_t at = xml.find(from);
  ASSERT_NE(at, std::string::npos);
  xml.replace(at, from.size(), to);
  EXPECT_THAT([&] { parse_texture_model(xml, "m.xml"); },
              ThrowsMessage<BadData>(AllOf(HasSubstr("m.xml: line "), HasSubstr(said))));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BrokenTextureFile,
    ::testing::Values(
        std::array<std::string, 4>{"number", "<mu>0.35</mu>", "<mu>nan</mu>", "<mu>: 'nan' is no number"},
        std::array<std::string, 4>{"missing", "<mu>0.35</mu>", "", "has no <mu>"},
        std::array<std::string, 4>{"unit", "mm/s", "m/s", "<SpeedUnits>: 'm/s' is another unit than mm/s"},
        std::array<std::string, 4>{"models", "<numMod>5", "<numMod>6", "says 6, but there are 5 elements <model>"},
        std::array<std::string, 4>{"coefficients", "<numARCoeff>2", "<numARCoeff>3", "has 2 values, 3 were expected"},
        std::array<std::string, 4>{"too_many_coefficients", "<numARCoeff>2", "<numARCoeff>200",
                                   "'200' is no number from 1 to 25"},
        std::array<std::string, 4>{"variance", "<var>0.4</var>", "<var>-0.4</var>", "'-0.4' is no number from 0"},
        std::array<std::string, 4>{"corner", "<value>5</value>\n   </tri>", "<value>6</value></tri>",
                                   "'6' is no number from 1 to 5"},
        std::array<std::string, 4>{"flat_triangle", "<value>5</value>\n   </tri>", "<value>2</value></tri>",
                                   "lie on one line"},
        std::array<std::string, 4>{"gap", "<maxForce>2<", "<maxForce>3<", "cover 66.67 %"},
        std::array<std::string, 4>{"end", "</modelSet>", "", "no XML"}),
    [](const auto& test) { return test.param[0]; });

TEST(TextureFile, FrequenciesThatDoNotAscendAreNoStableFilter) {
  TextureModel model = made_texture();
  std::swap(model.nodes[2].ar_rad[0], model.nodes[2].ar_rad[1]);
  EXPECT_THAT([&] { parse_texture_model(texture_model_to_xml(model), "m.xml"); },
              ThrowsMessage<BadData>(HasSubstr("ascend between 0 and pi")));
}

// Whatever a disk or a hand does to a file: it is read, or refused with a sentence.
TEST(TextureFile, DamageIsReadOrRefused) {
  const std::string whole = texture_model_to_xml(made_texture());
  std::mt19937_64 engine(6);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string xml = whole;
    for (std::uint64_t damages = 1 + engine() % 3; damages > 0; --damages) {
      const std::size_t at = engine() % xml.size();
      if (engine() % 4 == 0) {
        xml.erase(at, engine() % 200);
      } else {
        xml[at] = static_cast<char>(engine() % 256);
      }
    }
    try {
      const TextureFilter filter = filter_at(parse_texture_model(xml, "m.xml"), 0.1, 1.0);
      EXPECT_TRUE(std::isfinite(filter.density(100.0, 1000.0)));
    } catch (const BadData&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(TextureFile, OtherXmlIsNoTexture) {
  EXPECT_THAT([] { parse_texture_model("<mesh/>", "m.xml"); },
              ThrowsMessage<BadData>(HasSubstr("modelSet was expected")));
}

TEST(TextureLibrary, TheModelBehindALibraryIsFoundAndNothingElse) {
  const testing::TemporaryFolder folder;
  const auto plain = folder.path() / "plain.so", full = folder.path() / "full.so";
  write_file(plain, "library");
  write_texture_library(plain, "<modelSet/>", full);
  EXPECT_EQ(model_in_library(full), "<modelSet/>");
  EXPECT_EQ(model_in_library(plain), std::nullopt);
  std::string lying = read_file(full);
  lying[lying.size() - 17] = '\x7f';  // the highest byte of the length
  write_file(plain, lying);
  EXPECT_EQ(model_in_library(plain), std::nullopt);
}

}  // namespace
}  // namespace touchstone::texture
