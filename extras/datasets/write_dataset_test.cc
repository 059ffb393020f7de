// The bundled data sets are what their recipe makes, are complete, and are made again from their seed.
#include "write_dataset.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/units.h"
#include "harness/recording/dataset.h"
#include "harness/recording/recording_file.h"
#include "packed_dataset.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::datasets {
using synthetic::make_mesh;
using synthetic::make_surface;

namespace {

constexpr std::uint64_t bundled_seed = 1;

std::filesystem::path bundled(const std::string& name) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  if (source == nullptr) throw std::runtime_error("TOUCHSTONE_SOURCE_DIR is not set: ctest sets it");
  return std::filesystem::path(source) / "synthetic" / "bundled" / name;
}

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "touchstone_synthetic_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

Box3 mesh_bounds(const std::filesystem::path& file, const std::string& unit) {
  return surface::load_mesh(file, length_unit_factor(unit)).bounds();
}

TEST(BundledDatasets, AreCompleteAndUnchanged) {
  for (const Recipe& r : recipes()) {
    const DatasetReport report = check_dataset(recording::load_dataset(bundled(r.name)), mesh_bounds);
    EXPECT_THAT(report.errors, ::testing::IsEmpty());
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(bundled(r.name))) bytes += entry.file_size();
    EXPECT_LT(bytes, 3'000'000U);
  }
}

// Sine and exponential differ in the last bit between processors, which can turn a rounded digit: one unit is granted.
TEST(BundledDatasets, AreMadeAgainFromTheirSeed) {
  for (const Recipe& r : recipes()) {
    const TemporaryFolder folder;
    write_dataset(r, bundled_seed, folder.path());
    const recording::Recording kept = recording::load_recording(bundled(r.name) / "scan.csv");
    const recording::Recording made = recording::load_recording(folder.path() / "scan.csv");
    ASSERT_EQ(made.size(), kept.size());
    EXPECT_EQ(made.motion.t_s, kept.motion.t_s);
    for (std::size_t i = 0; i < made.size(); ++i) {
      EXPECT_LE((made.motion.p_W_m[i] - kept.motion.p_W_m[i]).cwiseAbs().maxCoeff(), 1.001 * position_unit_m);
      EXPECT_LE((made.f_W_N[i] - kept.f_W_N[i]).cwiseAbs().maxCoeff(), 1.001 * force_unit_N);
      EXPECT_LE((made.motion.q_WS[i].coeffs() - kept.motion.q_WS[i].coeffs()).cwiseAbs().maxCoeff(),
                1.001 * orientation_unit);
    }
    const recording::RenderedTrajectory exact = recording::load_rendered(folder.path() / "scan.exact.csv");
    const recording::RenderedTrajectory exact_kept = recording::load_rendered(bundled(r.name) / "scan.exact.csv");
    ASSERT_EQ(exact.size(), exact_kept.size());
    for (std::size_t i = 0; i < exact.size(); ++i) {
      EXPECT_LT((exact.tip_W_m[i] - exact_kept.tip_W_m[i]).norm(), 1e-15);
      EXPECT_LT((exact.contact_W_m[i] - exact_kept.contact_W_m[i]).norm(), 1e-15);
      EXPECT_LT((exact.f_W_N[i] - exact_kept.f_W_N[i]).norm(), 1e-9);
      EXPECT_EQ(exact.contact[i], exact_kept.contact[i]);
    }
  }
}

TEST(BundledDatasets, AreTheSameBytesEachTime) {
  for (const Recipe& r : recipes()) {
    const TemporaryFolder one;
    const TemporaryFolder two;
    write_dataset(r, 5, one.path());
    write_dataset(r, 5, two.path());
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(one.path())) {
      EXPECT_EQ(sha256_file(entry.path()), sha256_file(two.path() / entry.path().filename())) << entry.path();
      ++files;
    }
    EXPECT_EQ(files, 6U);
  }
}

TEST(BundledDatasets, MeshesAreAsNearAsTheirProvenanceSays) {
  for (const Recipe& r : recipes()) {
    const auto surface = make_surface(r.surface, r.parameters);
    const surface::TriangleMesh mesh =
        surface::load_mesh(bundled(r.name) / r.mesh_file, length_unit_factor(r.mesh_unit));
    const double bound = make_mesh(r.surface, r.parameters, r.triangles).deviation_bound_m;
    for (std::size_t i = 0; i < mesh.triangle_count(); i += 7) {
      const auto& t = mesh.triangles[i];
      const auto v = [&](std::size_t k) { return mesh.vertices_W_m[static_cast<std::size_t>(t[k])]; };
      EXPECT_LE(surface->closest((v(0) + v(1) + v(2)) / 3.0).distance_m, bound + 1e-15);
    }
  }
}

TEST(WriteDataset, LeavesForeignFoldersAlone) {
  const TemporaryFolder folder;
  write_file(folder.path() / "thesis.txt", "mine");
  EXPECT_THROW(write_dataset(recipe("plane"), 1, folder.path()), UsageError);
  EXPECT_EQ(read_file(folder.path() / "thesis.txt"), "mine");
  EXPECT_THROW(recipe("plaen"), UsageError);
}

}  // namespace
}  // namespace touchstone::datasets
