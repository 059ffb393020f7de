// On recordings that this project does not ship: two recordings of the same thing lie nearer to each other than a
// rendering without the right effect does.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "experiments/indentation.h"
#include "experiments/palpation_rows.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/stats/quantile.h"
#include "harness/testing/shared_data.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

TEST(RealData, NeighbouringRowsOfARasterAreNearerThanASpringOnAPlane) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "palpation/ContPalpRAL18T1.csv");
  const recording::Recording recording = recording::load_recording(file);
  const auto comparisons = compare_rows(recording, 10, raster_options());
  ASSERT_GE(comparisons.size(), 10u);
  std::size_t nearer = 0;
  std::vector<double> same;
  std::vector<double> rendered;
  for (const auto& own : comparisons) {
    nearer += own.same() < own.rendered() ? 1 : 0;
    same.push_back(own.same());
    rendered.push_back(own.rendered());
  }
  std::cout << "rows compared " << comparisons.size() << ", the same object nearer in " << nearer
            << "; median distance " << stats::median(same) << " against " << stats::median(rendered) << "\n";
  RecordProperty("compared", static_cast<int>(comparisons.size()));
  RecordProperty("nearer", static_cast<int>(nearer));
  // Far beyond chance: a fair coin stays below two thirds plus three standard deviations.
  const auto n = static_cast<double>(comparisons.size());
  EXPECT_GT(static_cast<double>(nearer), 0.5 * n + 3.0 * std::sqrt(0.25 * n));
  EXPECT_LT(stats::median(same), stats::median(rendered));
}

TEST(RealData, RecordsOfAnIndentationAreNearerThanAnyRendering) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(file, "afm-indentation/fmt-tab-fd_version_0.13.3.tab");
  const auto comparisons = compare_indentation(read_approach(file));
  ASSERT_EQ(comparisons.size(), interleaved * (interleaved - 1));
  for (const auto& own : comparisons) {
    const auto& c = own.evaluation.conditions;
    ASSERT_EQ(c.size(), indentation_conditions);
    std::cout << "record " << own.real << " against " << own.other << ": again " << c[0].distance << ", d "
              << c[1].distance << ", d^1.5 " << c[2].distance << ", d^2 " << c[3].distance << ", d^"
              << own.fitted_exponent << " " << c[4].distance << "\n";
    for (std::size_t i = 1; i < c.size(); ++i) EXPECT_LT(c[0].distance, c[i].distance) << c[i].name;
    // The effect that is missing from the linear spring is what brings a rendering nearer.
    EXPECT_LT(c[4].distance, c[1].distance);
    EXPECT_LT(c[2].distance, c[1].distance);
  }
}

TEST(Indentation, FindsTheExponentOfACurveThatHasOne) {
  for (const double exponent : {1.0, 1.5, 2.0, 2.7}) {
    Approach approach;
    approach.rate_Hz = 2000.0;
    approach.contact = 500;
    for (int i = 0; i < 2000; ++i) {
      approach.depth_m.push_back(1e-9 * (i - 500));
      approach.force_N.push_back(i < 500 ? 0.0 : 3e-3 * std::pow(approach.depth_m.back(), exponent));
    }
    const PowerLaw law = fit_power_law(approach, 1, 4);
    EXPECT_NEAR(law.exponent, exponent, 1e-5);
    EXPECT_NEAR(law.coefficient / 3e-3, 1.0, 1e-3);
  }
}

TEST(Indentation, BadFilesAreNamed) {
  const std::filesystem::path folder = ::testing::TempDir();
  const auto refused = [&](const std::string& text, const std::string& words) {
    const auto file = folder / "curve.tab";
    std::ofstream(file) << text;
    try {
      read_approach(file);
      ADD_FAILURE() << "taken: " << text.substr(0, 80);
    } catch (const BadData& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  const std::string header =
      "# BEGIN METADATA\n# {\"spring constant\": 0.02, \"rate approach\": 2000}\n# END METADATA\n";
  refused("", "no JSON");
  refused("# BEGIN METADATA\n# {\"rate approach\": 2000}\n# END METADATA\n", "spring constant");
  refused(header + "1e-9\t2\n", ":4:");
  refused(header + "1e-9\tnan\tx\tFalse\t0\n", ":4:");
  refused(header + "1e-9\t1e-6\t1e-6\tFalse\t0\n", "1 samples");
  std::string flat = header;
  for (int i = 0; i < 1200; ++i) flat += "0\t1e-6\t1e-6\tFalse\t0\n";
  refused(flat, "in contact was expected");
  EXPECT_THROW(read_approach(folder / "absent.tab"), BadData);
}

}  // namespace
}  // namespace touchstone::experiments
