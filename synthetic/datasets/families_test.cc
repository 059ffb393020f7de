#include "harness/recording/dataset.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"
#include "synthetic/datasets/write_dataset.h"

namespace touchstone::synthetic {
namespace {

// Each is a whole data set, and its exact answer is one: in contact the force obeys Coulomb's law, out of it there is
// none.
TEST(Families, AreDataSetsWithAnExactAnswer) {
  for (const Recipe& recipe : families()) {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("touchstone-family-" + recipe.name + "-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    write_dataset(recipe, 1, folder);
    const Dataset dataset = load_dataset(folder);
    const DatasetReport report = check_dataset(dataset, [](const std::filesystem::path& file, const std::string& unit) {
      return load_mesh(file, unit == "m" ? 1.0 : 1e-3).bounds();
    });
    EXPECT_THAT(report.errors, ::testing::IsEmpty()) << recipe.name;
    const RenderedTrajectory exact = load_rendered(folder / "scan.exact.csv");
    std::size_t touching = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      touching += exact.contact[i];
      if (exact.contact[i] == 0) {
        EXPECT_EQ(exact.f_W_N[i].norm(), 0.0) << recipe.name << ' ' << i;
      }
    }
    EXPECT_GT(touching, exact.size() / 2) << recipe.name;
    std::filesystem::remove_all(folder);
  }
}

}  // namespace
}  // namespace touchstone::synthetic
