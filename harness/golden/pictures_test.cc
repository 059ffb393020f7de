// The pictures of a failing golden case, decoded: what is drawn is counted in pixels, since a picture without its lines
// passes every check of the file.
#include "harness/golden/pictures.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "harness/base/atomic_file.h"
#include "harness/report/drawn_pixels.h"

namespace touchstone::golden {
namespace {

constexpr std::size_t panels = 3;
constexpr std::size_t title_height = 60;

TrajectoryColumns pressing(std::size_t rows, double amplitude_N) {
  TrajectoryColumns set;
  std::vector<double> t_s;
  std::vector<double> force_N;
  for (std::size_t i = 0; i < rows; ++i) {
    t_s.push_back(0.001 * static_cast<double>(i));
    force_N.push_back(amplitude_N * std::sin(7.0 * static_cast<double>(i) / static_cast<double>(rows)));
  }
  set.columns = {{"t", t_s}, {"fx", force_N}, {"fy", force_N}, {"fz", force_N}};
  return set;
}

class PictureFolder {
 public:
  PictureFolder() { ensure_writable_folder(path_); }
  ~PictureFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("touchstone-golden-pictures-" + std::to_string(::getpid()));
};

class GoldenPictures : public testing::TestWithParam<std::size_t> {
 protected:
  PictureFolder folder_;
};

// Rows of the shortest and longest golden cases, about the number from which runs are thinned, and far more.
INSTANTIATE_TEST_SUITE_P(Rows, GoldenPictures, testing::Values(2, 3, 200, 1999, 2000, 2001, 4500, 300000));

TEST_P(GoldenPictures, EveryPanelShowsItsLineFromEndToEnd) {
  const auto pictures = draw_pictures(pressing(GetParam(), 1.0), pressing(GetParam(), 1.2), folder_.path());
  ASSERT_EQ(pictures.size(), 3U);
  for (const auto& [name, png] : pictures) {
    const auto drawn = report::coloured_columns(png, panels, title_height);
    ASSERT_EQ(drawn.size(), panels);
    // The plot takes about nine tenths of the width of 1000 pixels.
    for (const std::size_t columns : drawn) EXPECT_GT(columns, 800U) << name;
  }
}

// One wrong sample among many is a line from the bottom of the panel to its top.
TEST_P(GoldenPictures, OneWrongSampleIsSeen) {
  const std::size_t rows = std::max<std::size_t>(GetParam(), 200);  // of fewer, one sample is a part of the curve
  const auto expected = pressing(rows, 1e-3);
  auto obtained = expected;
  for (auto& [name, values] : obtained.columns) {
    if (name != "t") values[rows / 2] += 1.0;
  }
  const auto pictures = draw_pictures(expected, obtained, folder_.path());
  ASSERT_EQ(pictures.size(), 3U);
  // Golden and obtained have the same axes: what the obtained one shows more is the spike, in each panel over most of
  // its 260 pixels.
  EXPECT_GT(report::coloured_pixels(pictures[1].second), report::coloured_pixels(pictures[0].second) + panels * 100);
}

TEST(GoldenPicturesOfBadData, WhatIsNotFiniteLeavesTheRest) {
  const PictureFolder folder;
  auto obtained = pressing(1000, 1.0);
  for (auto& [name, values] : obtained.columns) {
    if (name != "t") std::fill(values.begin(), values.begin() + 100, std::numeric_limits<double>::quiet_NaN());
  }
  for (const auto& [name, png] : draw_pictures(pressing(1000, 1.0), obtained, folder.path())) {
    for (const std::size_t columns : report::coloured_columns(png, panels, title_height))
      EXPECT_GT(columns, 700U) << name;
  }
}

}  // namespace
}  // namespace touchstone::golden
