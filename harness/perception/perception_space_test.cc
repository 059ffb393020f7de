#include "harness/perception/perception_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/perception/published_tables.h"

namespace touchstone::perception {
using published::published_conditions;

namespace {

Eigen::MatrixXd random_images(Random& random, Eigen::Index rows, Eigen::Index columns, double scale) {
  Eigen::MatrixXd images(rows, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    const double own = scale * random.log_uniform(0.01, 1.0);
    for (Eigen::Index r = 0; r < rows; ++r) images(r, c) = own * (random.normal() + 0.3);
  }
  return images;
}

TEST(PerceptionSpace, IsThePrincipalComponentsAndItsDistancesAreThoseOfTheFeatures) {
  Random random(1);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const auto& [rows, columns] : {std::pair<Eigen::Index, Eigen::Index>{7, 400}, {30, 5}, {2, 3}, {9, 8}}) {
      const Eigen::MatrixXd images = random_images(random, rows, columns, scale);
      const auto space = build_perception_space(images, 1.0);
      const Eigen::Index d = std::min(rows - 1, columns);
      ASSERT_EQ(space.dimensions, d);
      EXPECT_LT((space.basis.transpose() * space.basis - Eigen::MatrixXd::Identity(d, d)).norm(), 1e-10);
      // Eq 18 and 19 literally: the columns of T are eigenvectors of the covariance.
      const Eigen::RowVectorXd average = images.colwise().mean();
      const Eigen::MatrixXd centred = images.rowwise() - average;
      const Eigen::MatrixXd covariance = centred.transpose() * centred / static_cast<double>(rows);
      EXPECT_LT((covariance * space.basis - space.basis * space.eigenvalues.head(d).asDiagonal()).norm(),
                1e-10 * covariance.norm());
      EXPECT_TRUE(std::is_sorted(space.eigenvalues.data(), space.eigenvalues.data() + d, std::greater<>()));
      EXPECT_NEAR(space.eigenvalues.sum(), covariance.trace(), 1e-12 * covariance.trace());
      // With all components nothing is lost: distances are those of the features.
      for (Eigen::Index r = 0; r < rows; ++r) {
        EXPECT_NEAR(distances_to(space.coordinates, 0)[static_cast<std::size_t>(r)],
                    (images.row(r) - images.row(0)).norm(), 1e-11 * images.norm());
      }
    }
  }
}

TEST(PerceptionSpace, KeepsTheFewestDimensionsThatExplainTheShare) {
  Random random(2);
  const Eigen::MatrixXd images = random_images(random, 7, 50, 1.0);
  for (const double share : {0.3, 0.5, 0.9, 0.99}) {
    const auto space = build_perception_space(images, share);
    const double total = space.eigenvalues.sum();
    EXPECT_GE(space.explained_share, share * (1.0 - 1e-9));
    EXPECT_LT(space.eigenvalues.head(space.dimensions - 1).sum() / total, share);
    EXPECT_NEAR(space.explained_share, space.eigenvalues.head(space.dimensions).sum() / total, 1e-12);
  }
  EXPECT_THROW(build_perception_space(images, 0.0), UsageError);
  EXPECT_THROW(build_perception_space(images, 1.1), UsageError);
}

TEST(PerceptionSpace, SignsAreFixedAndTheOrderOfConditionsDoesNotMatter) {
  Random random(3);
  const Eigen::MatrixXd images = random_images(random, 7, 60, 1.0);
  const auto space = build_perception_space(images, 0.9);
  for (Eigen::Index d = 0; d < space.dimensions; ++d) {
    EXPECT_EQ(space.basis.col(d).maxCoeff(), space.basis.col(d).cwiseAbs().maxCoeff());
  }
  Eigen::MatrixXd shuffled = images;
  shuffled.row(1).swap(shuffled.row(5));
  shuffled.row(2).swap(shuffled.row(3));
  const auto other = build_perception_space(shuffled, 0.9);
  EXPECT_LT((other.basis - space.basis).norm(), 1e-9);
  EXPECT_LT((other.coordinates.row(5) - space.coordinates.row(1)).norm(), 1e-9);
}

TEST(PerceptionSpace, EdgesOfTheInput) {
  EXPECT_THROW(build_perception_space(Eigen::MatrixXd::Ones(1, 5)), BadData);
  const auto same = build_perception_space(Eigen::MatrixXd::Constant(4, 5, 0.1));
  EXPECT_EQ(same.dimensions, 0);
  EXPECT_EQ(distances_to(same.coordinates, 0), std::vector<double>(4, 0.0));
  Eigen::MatrixXd two(2, 3);
  two << 1, 2, 3, 1, 2, 7;  // fewer conditions than dimensions: one direction is all there is
  const auto line = build_perception_space(two, 1.0);
  EXPECT_EQ(line.dimensions, 1);
  EXPECT_NEAR(distances_to(line.coordinates, 0)[1], 4.0, 1e-12);
  two(0, 0) = std::nan("");
  EXPECT_THROW(build_perception_space(two), BadData);
}

HapticImage image_of(std::vector<double> force_rate, std::vector<double> hardness) {
  HapticImage image;
  image.blocks = {{"force rate", "N/s", std::move(force_rate)}, {"rate-hardness", "N/m", std::move(hardness)}};
  return image;
}

TEST(Scaling, EveryRuleDoesWhatItSays) {
  const HapticImage real = image_of({3, 4}, {100, 100});
  const HapticImage other = image_of({6, 8}, {100, 50});
  const std::vector<const HapticImage*> images{&real, &other};
  const auto rows = [&](FeatureScaling scaling) { return scale_images(images, scaling).rows; };
  Eigen::MatrixXd expected(2, 4);
  expected << 3, 4, 100, 100, 6, 8, 100, 50;
  EXPECT_EQ(rows(FeatureScaling::none), expected);
  EXPECT_NEAR(rows(FeatureScaling::reference_norm).row(0).head(2).norm(), 1.0, 1e-15);
  EXPECT_NEAR(rows(FeatureScaling::reference_norm)(1, 0), 1.2, 1e-15);
  EXPECT_NEAR(rows(FeatureScaling::pooled_range)(1, 1), 1.0, 1e-15);
  EXPECT_NEAR(rows(FeatureScaling::pooled_range)(1, 3), 0.5, 1e-15);
  const auto spread = rows(FeatureScaling::block_spread);
  for (const Eigen::Index block : {0, 2}) {
    // Each feature's variance among the conditions (over N = 2) is 1.
    const auto difference = (spread.row(1) - spread.row(0)).segment(block, 2);
    EXPECT_NEAR(difference.squaredNorm() / 4.0, 1.0, 1e-12);
  }
  const auto standardised = rows(FeatureScaling::standardised);
  EXPECT_NEAR(std::abs(standardised(1, 0) - standardised(0, 0)), 2.0, 1e-12);
  EXPECT_EQ(standardised(1, 2), 0.0);  // the same in both: carries nothing
  for (const auto scaling : feature_scalings) EXPECT_EQ(feature_scaling(name_of(scaling)), scaling);
  EXPECT_THROW(feature_scaling("z-score"), UsageError);
}

TEST(Scaling, UnitsDoNotMatterButForTheRuleNone) {
  HapticImage real = image_of({3, 4, 5}, {100, 90, 80});
  HapticImage a = image_of({6, 8, 1}, {100, 50, 20});
  HapticImage b = image_of({2, 4, 6}, {10, 90, 80});
  const auto distances = [&](FeatureScaling scaling) {
    const std::vector<const HapticImage*> images{&real, &a, &b};
    return distances_to(scale_images(images, scaling).rows, 0);
  };
  std::vector<std::vector<double>> before;
  for (const auto scaling : feature_scalings) before.push_back(distances(scaling));
  for (auto* image : {&real, &a, &b}) {
    for (double& value : image->blocks[1].values) value *= 1e-3;  // N/mm
  }
  for (std::size_t s = 0; s < feature_scalings.size(); ++s) {
    const auto after = distances(feature_scalings[s]);
    const bool same = std::abs(after[1] - before[s][1]) < 1e-9 * before[s][1];
    EXPECT_EQ(same, feature_scalings[s] != FeatureScaling::none) << name_of(feature_scalings[s]);
  }
}

TEST(Scaling, FeaturesWithoutContentAreSaidAndDifferentOnesRefused) {
  const HapticImage real = image_of({0, 0}, {1, 1});
  const HapticImage moving = image_of({0, 2}, {1, 1});
  const std::vector<const HapticImage*> images{&real, &moving};
  const auto scaled = scale_images(images, FeatureScaling::reference_norm);
  EXPECT_THAT(scaled.remarks, ::testing::ElementsAre(::testing::HasSubstr("the real process has no force rate")));
  EXPECT_TRUE(scaled.rows.allFinite());
  const HapticImage shorter = image_of({0}, {1, 1});
  EXPECT_THROW(scale_images(std::vector<const HapticImage*>{&real, &shorter}, FeatureScaling::none), BadData);
  const HapticImage bad = image_of({0, std::nan("")}, {1, 1});
  EXPECT_THROW(scale_images(std::vector<const HapticImage*>{&real, &bad}, FeatureScaling::none), BadData);
}

// Table 2 of the paper is golden data for eq 21.
TEST(PublishedTables, DistancesFollowFromTheCoordinates) {
  using namespace published;
  Eigen::MatrixXd coordinates(published_conditions.size() + 1, 3);
  coordinates.row(0) = Eigen::Map<const Eigen::RowVector3d>(published::real_coordinates.data());
  for (std::size_t i = 0; i < published_conditions.size(); ++i) {
    coordinates.row(static_cast<Eigen::Index>(i) + 1) =
        Eigen::Map<const Eigen::RowVector3d>(published_conditions[i].coordinates.data());
  }
  const auto distances = distances_to(coordinates, 0);
  // Coordinates are printed to 1e-4: each difference is off by 1e-4 at most, the distance by sqrt(3) of that, and its
  // own printing by half a digit.
  const double bound = std::sqrt(3.0) * 1e-4 + 0.5e-4;
  for (std::size_t i = 0; i < published_conditions.size(); ++i) {
    const bool misprint = published_conditions[i].device == "Touch X" && published_conditions[i].linear;
    if (misprint) {
      EXPECT_GT(std::abs(distances[i + 1] - published_conditions[i].distance), 5.0 * bound) << "the printed 3.7397";
      EXPECT_NEAR(distances[i + 1], published::touch_x_linear_distance_in_text, bound);
    } else {
      EXPECT_NEAR(distances[i + 1], published_conditions[i].distance, bound) << published_conditions[i].device;
    }
  }
  EXPECT_TRUE(std::is_sorted(distances.begin(), distances.end()));  // the table says it is sorted by distance
}

// Figure 13 is table 3 (and table 2) normalised.
TEST(PublishedTables, RelativeSimilaritiesOfFigure13) {
  using namespace published;
  std::vector<double> euclidean;
  std::vector<double> correlation;
  std::vector<double> space;
  for (const auto& c : published_conditions) {
    euclidean.push_back(c.euclidean);
    correlation.push_back(c.pearson);
    space.push_back(c.distance);
  }
  const auto by_distance = relative_similarity(euclidean, false);
  const auto by_correlation = relative_similarity(correlation, true);
  const auto by_space = relative_similarity(space, false);
  for (const auto* line : {&by_distance, &by_correlation, &by_space}) {
    EXPECT_EQ((*line)[0], 1.0);  // Omega.7 with the linear spring is the best by every method
    EXPECT_EQ(*std::min_element(line->begin(), line->end()), 0.0);
    EXPECT_TRUE((*line)[0] > (*line)[1] && (*line)[1] > (*line)[2]);  // linear: Omega.7, Touch X, Touch
    for (int linear = 0; linear < 3; ++linear) {
      for (int quadratic = 3; quadratic < 6; ++quadratic) EXPECT_GT((*line)[linear], (*line)[quadratic]);
    }
  }
  // The quadratic springs are ranked one way in perception space and the other by statistics.
  EXPECT_TRUE(by_space[3] > by_space[4] && by_space[4] > by_space[5]);
  EXPECT_TRUE(by_distance[3] < by_distance[4] && by_distance[4] < by_distance[5]);
  EXPECT_TRUE(by_correlation[3] < by_correlation[4] && by_correlation[4] < by_correlation[5]);
  EXPECT_DOUBLE_EQ(by_distance[4], (14.6449 - 11.6782) / (14.6449 - 7.3078));
}

TEST(RelativeSimilarity, NeedsDifferences) {
  EXPECT_TRUE(relative_similarity(std::vector<double>{3.0}, false).empty());
  for (const double value : relative_similarity(std::vector<double>{2.0, 2.0}, true)) EXPECT_TRUE(std::isnan(value));
}

}  // namespace
}  // namespace touchstone::perception
