#include "harness/report/place_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/report/sample_judgement_for_test.h"

namespace touchstone::report {
namespace {

using ::testing::HasSubstr;

template <class Wanted>
const Wanted& first_of(const Section& section) {
  for (const Block& block : section.blocks) {
    if (const auto* const found = std::get_if<Wanted>(&block)) return *found;
  }
  throw std::logic_error("no such block");
}

TEST(PlaceSections, EveryPlaceIsACellInItsColourAndInWords) {
  const auto sections = place_sections(sample_judgement());
  ASSERT_EQ(sections.size(), 2u);
  ASSERT_EQ(sections[0].blocks.size(), 2u) << "the condition at one place has no map";
  const auto& map = first_of<CellMap>(sections[0]);
  ASSERT_EQ(map.cells.size(), 20u);
  int more = 0;
  int less = 0;
  int unknown = 0;
  for (const auto& cell : map.cells) {
    unknown += cell.value ? 0 : 1;
    more += cell.value && *cell.value == 2.5 ? 1 : 0;
    less += cell.value && *cell.value == -0.1 ? 1 : 0;
    EXPECT_THAT(cell.text, HasSubstr(cell.value ? "N instead of 1 N" : "cannot tell"));
    // Squares of 4 mm that turn about one another's corners.
    for (std::size_t c = 0; c < 4; ++c) {
      const auto& [x, y] = cell.corners[c];
      const auto& [next_x, next_y] = cell.corners[(c + 1) % 4];
      EXPECT_NEAR(std::hypot(next_x - x, next_y - y), 4.0, 1e-9);
    }
  }
  EXPECT_EQ(unknown, 5);
  EXPECT_EQ(more, 6);
  EXPECT_EQ(less, 9);
  EXPECT_EQ(map.x_label, "x [mm]");
  EXPECT_EQ(map.y_label, "y [mm]");
  EXPECT_THAT(map.summary, HasSubstr("20 places of 4 mm: 6 differ by more than one JND, 5 cannot be told"));
  EXPECT_EQ(first_of<Table>(sections[1]).rows.size(), 20u);
}

TEST(PlaceSections, TheForcesAlongTheLongerSideAreMeansOfThePlacesKnown) {
  const auto sections = place_sections(sample_judgement());
  const auto& profile = first_of<LinePlot>(sections[0]);
  ASSERT_EQ(profile.lines.size(), 2u);
  EXPECT_THAT(profile.lines[0].x, ::testing::Pointwise(::testing::DoubleNear(1e-9), {-8.0, -4.0, 0.0, 4.0, 8.0}));
  EXPECT_THAT(profile.lines[0].y, ::testing::Each(1.0));
  EXPECT_THAT(profile.lines[1].y, ::testing::Pointwise(::testing::DoubleNear(1e-9), {0.99, 0.99, 0.99, 2.0, 2.0}));
}

// Layers of depth of one motion lie behind one another: the strongest is seen.
TEST(PlaceSections, OfPlacesBehindOneAnotherTheStrongestIsShown) {
  auto judged = sample_judgement();
  auto& cells = judged.conditions[0].judgement.places.force.cells;
  auto deeper = cells;
  for (auto& cell : deeper) cell.jnd *= 2.0;
  cells.insert(cells.end(), deeper.begin(), deeper.end());
  const auto sections = place_sections(judged);
  const auto& map = first_of<CellMap>(sections[0]);
  ASSERT_EQ(map.cells.size(), 20u);
  EXPECT_EQ(std::count_if(map.cells.begin(), map.cells.end(), [](const auto& c) { return c.value && *c.value == 5.0; }),
            6);
}

// Pressed along a slanting direction, cells stay whole and apart, and the axes say that they are not quite the
// object's.
TEST(PlaceSections, ASlantedMapKeepsItsCellsApart) {
  auto judged = sample_judgement();
  auto& places = judged.conditions[0].judgement.places.force;
  const Vec3 outward = Vec3(0.4, -0.3, -0.8).normalized();
  places.side[0] = outward.unitOrthogonal();
  places.side[1] = outward.cross(places.side[0]);
  for (auto& cell : places.cells)
    cell.centre_m = cell.centre_m.x() * places.side[0] + cell.centre_m.y() * places.side[1];
  const auto sections = place_sections(judged);
  const auto& map = first_of<CellMap>(sections[0]);
  ASSERT_EQ(map.cells.size(), 20u);
  EXPECT_THAT(map.x_label, HasSubstr("about"));
  for (std::size_t a = 0; a < map.cells.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const auto& p = map.cells[a].corners[0];
      const auto& q = map.cells[b].corners[0];
      EXPECT_GT(std::hypot(p[0] - q[0], p[1] - q[1]), 3.99) << a << " " << b;
    }
  }
}

TEST(PlaceSections, WithoutPlacesThereIsNoSection) {
  auto judged = sample_judgement();
  judged.conditions.erase(judged.conditions.begin());
  EXPECT_TRUE(place_sections(judged).empty());
}

}  // namespace
}  // namespace touchstone::report
