// The series that Apache Otava publishes its own answers for (tests/analysis_test.py, change_point_divisive_test.py and
// tigerbeetle_test.py of github.com/apache/otava, Apache License 2.0, revision 1ceb153), and an independent slow
// evaluation of the energy statistic in the way of its test (compute_Q_and_candidate_slow).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "change_points/change_points.h"
#include "change_points/energy.h"

namespace touchstone::change_points {
namespace {

using testing::ElementsAre;

const std::vector<double> three_levels{0.3,  2.4,   1.5,   -0.9,  -0.5,  99.7,  98.3,
                                       99.1, 149.0, 149.7, 149.5, 149.1, 148.8, 150.0};
const std::vector<double> two_levels{1.02, 0.95, 0.99, 1.00, 1.12, 1.00, 1.01, 0.98, 1.01, 0.96,
                                     0.50, 0.51, 0.48, 0.48, 0.55, 0.50, 0.49, 0.51, 0.50, 0.49};
// TigerBeetle's series: a fall at 15, rises at 61 and 71, a fall at 95, then slow rises; one outlier at 10.
const std::vector<double> tigerbeetle{
    26705, 26475, 26641, 26806, 26835, 26911, 26564, 26812, 26874, 26682, 15672, 26745, 26460, 26977, 26851, 23412,
    23547, 23674, 23519, 23670, 23662, 23462, 23750, 23717, 23524, 23588, 23687, 23793, 23937, 23715, 23570, 23730,
    23690, 23699, 23670, 23860, 23988, 23652, 23681, 23798, 23728, 23604, 23523, 23412, 23685, 23773, 23771, 23718,
    23409, 23739, 23674, 23597, 23682, 23680, 23711, 23660, 23990, 23938, 23742, 23703, 23536, 24363, 24414, 24483,
    24509, 24944, 24235, 24560, 24236, 24667, 24730, 28346, 28437, 28436, 28057, 28217, 28456, 28427, 28398, 28250,
    28331, 28222, 28726, 28578, 28345, 28274, 28514, 28590, 28449, 28305, 28411, 28788, 28404, 28821, 28580, 27483,
    26805, 27487, 27124, 26898, 27295, 26951, 27312, 27660, 27154, 27050, 26989, 27193, 27503, 27326, 27375, 27513,
    27057, 27421, 27574, 27609, 27123, 27824, 27644, 27394, 27836, 27949, 27702, 27457, 27272, 28207, 27802, 27516,
    27586, 28005, 27768, 28543, 28237, 27915, 28437, 28342, 27733, 28296, 28524, 28687, 28258, 28611, 29360, 28590,
    29641, 28965, 29474, 29256, 28611, 28205, 28539, 27962, 28398, 28509, 28240, 28592, 28102, 28461, 28578, 28669,
    28507, 28535, 28226, 28536, 28561, 28087, 27953, 28398, 28007, 28518, 28337, 28242, 28607, 28545, 28514, 28377,
    28010, 28412, 28633, 28576, 28195, 28637, 28724, 28466, 28287, 28719, 28425, 28860, 28842, 28604, 28327, 28216,
    28946, 28918, 29287, 28725, 29148, 29541, 29137, 29628, 29087, 28612, 29154, 29108, 28884, 29234, 28695, 28969,
    28809, 28695, 28634, 28916, 29852, 29389, 29757, 29531, 29363, 29251, 29552, 29561, 29046, 29795, 29022, 29395,
    28921, 29739, 29257, 29455, 29376, 29528, 28909, 29492, 28984, 29621, 29026, 29457, 29102, 29114, 28924, 29162,
    29259, 29554, 29616, 29211, 29367, 29460, 28836, 29645, 29586, 28848, 29324, 28969, 29150, 29243, 29081, 29312,
    28923, 29272, 29117, 29072, 29529, 29737, 29652, 29612, 29856, 29012, 30402, 29969, 29309, 29439, 29285, 29421,
    29023, 28772, 29692, 29416, 29267, 29542, 29904, 30045, 29739, 29945, 29141, 29163, 29765, 29197, 29441, 28910,
    29504, 29614, 29643, 29506, 29420, 29672, 29432, 29784, 29888, 29309, 29247, 29816, 29254, 29813, 29451, 29382,
    29618, 28558, 29845, 29499, 29283, 29184, 29246, 28790, 29952, 29145, 29415, 30437, 29227, 29605, 29859, 29156,
    29807, 29406, 29734, 29861, 29140, 29983, 29832, 29919, 29896, 29991, 29266, 29001, 29459, 29548, 29310, 29042,
    29303, 29894, 29091, 29018, 29537, 29614, 29180, 29736, 29500, 29218, 29581, 28906, 28542, 29306, 28987, 29878,
    28865, 30272, 29707, 29662, 29815, 30492, 29347, 30096, 29054, 30238, 28813, 31895, 28915};

double slow_energy(const std::vector<double>& values, std::size_t index, std::size_t end) {
  const auto distance = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d, bool pairs) {
    double sum = 0.0;
    for (std::size_t i = a; i < b; ++i) {
      for (std::size_t j = pairs ? i + 1 : c; j < d; ++j) sum += std::abs(values[i] - values[j]);
    }
    return sum;
  };
  const auto n = static_cast<double>(index);
  const auto m = static_cast<double>(end - index);
  return 2.0 / (m + n) * distance(0, index, index, end, false) -
         2.0 * m / (m + n) / (n - 1.0) * distance(0, index, 0, index, true) -
         2.0 * n / (m + n) / (m - 1.0) * distance(index, end, index, end, true);
}

TEST(Otava, TheEnergyIsTheirs) {
  EnergySplit best;
  for (std::size_t index = 2; index < three_levels.size(); ++index) {
    for (std::size_t end = index + 2; end <= three_levels.size(); ++end) {
      const double energy = slow_energy(three_levels, index, end);
      if (energy > best.energy) best = {index, end, energy};
    }
  }
  const EnergySplit fast = largest_energy_split(three_levels, 2);
  EXPECT_EQ(fast.index, best.index);
  EXPECT_EQ(fast.end, best.end);
  EXPECT_NEAR(fast.energy, best.energy, 1e-10 * best.energy);
}

std::vector<std::size_t> steps(const std::vector<double>& values, const ChangeOptions& options) {
  std::vector<std::size_t> found;
  for (const Change& change : find_changes(values, options).changes) {
    if (change.kind == ChangeKind::step) found.push_back(change.index);
  }
  return found;
}

// Their answers: 10; 5 and 8.
TEST(Otava, ItsShortSeries) {
  EXPECT_THAT(steps(two_levels, {}), ElementsAre(10U));
  EXPECT_THAT(steps(three_levels, {.outliers = 1}), ElementsAre(5U, 8U));
}

// With changes below 5 % of no interest they answer 15 and 71 at the levels 0.01 and 0.05, and at 0.1 and 0.2 the
// outlier at 10 and the last values too. Ours do not depend on the rate.
TEST(Otava, ItsLongSeriesWithALimitOnSize) {
  for (const double rate : {0.001, 0.01, 0.1, 1.0})
    EXPECT_THAT(steps(tigerbeetle, {.false_alarms_per_year = rate, .smallest_relative = 0.05}), ElementsAre(15U, 71U));
}

// Without a limit on size they answer 5 changes at 0.00001, 11 at 0.001, 14 at 0.01 and 70 at 0.2: the rise after 95 as
// a staircase. Its steep parts are all that is left here; the one at 260 is theirs at 0.01 too.
TEST(Otava, ItsLongSeries) {
  EXPECT_THAT(steps(tigerbeetle, {}), ElementsAre(15U, 61U, 71U, 95U, 131U, 192U));
  EXPECT_THAT(steps(tigerbeetle, {.false_alarms_per_year = 0.1}), ElementsAre(15U, 61U, 71U, 95U, 131U, 192U, 260U));
}

}  // namespace
}  // namespace touchstone::change_points
