#include "packed_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"

namespace touchstone::datasets {
using recording::Dataset;
using recording::load_dataset;
using recording::Recording;

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* example = R"({"schema": "touchstone-dataset/1",
  "object": "plate", "mesh": {"file": "meshes/plate.obj", "unit": "mm"}, "tip_radius_m": 0.001,
  "instrument": "Nano17", "stiffness_N_per_m": 500, "in_trajectory": "synthesize",
  "recordings": [{"file": "scan.csv", "shows": "a scan", "exact": "exact.csv",
                  "repeat": "taps.h5"}, {"file": "taps.h5", "shows": "taps"}],
  "source": "made for a test", "licence": "CC0-1.0"})";

Recording arc(double force_N) {
  Recording recording;
  for (int i = 0; i < 100; ++i) {
    recording.motion.t_s.push_back(0.001 * i);
    recording.motion.p_W_m.emplace_back(0.05 * std::cos(0.06 * i), 0.05 * std::sin(0.06 * i), 0.0);
    recording.f_W_N.emplace_back(0.0, 0.0, force_N);
  }
  return recording;
}

std::filesystem::path make_dataset(const std::string& json = example) {
  auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-dataset" /
                ::testing::UnitTest::GetInstance()->current_test_info()->name() / "plate";
  std::filesystem::remove_all(folder.parent_path());
  ensure_writable_folder(folder / "meshes");
  write_file(folder / "dataset.json", json);
  write_file(folder / "meshes/plate.obj", "v 0 0 0\n");
  save_recording(folder / "scan.csv", arc(1.0));
  save_recording(folder / "exact.csv", arc(1.0));
  save_recording(folder / "taps.h5", arc(2.0));
  return folder;
}

// A mesh of 120 mm around the origin.
Box3 plate(const std::filesystem::path&, const std::string& unit) {
  const double half = unit == "mm" ? 0.06 : 60.0;
  return {Vec3::Constant(-half), Vec3::Constant(half)};
}

std::string changed(const std::string& from, const std::string& to) {
  std::string json = example;
  json.replace(json.find(from), from.size(), to);
  return json;
}

TEST(PackedDataset, PackThenCheckPasses) {
  const auto folder = make_dataset();
  Dataset dataset = load_dataset(folder);
  EXPECT_EQ(dataset.mesh_unit, "mm");
  EXPECT_EQ(dataset.tip_radius_m, 0.001);
  EXPECT_EQ(dataset.stiffness_N_per_m, 500.0);
  EXPECT_THAT(dataset.files(), ElementsAre("meshes/plate.obj", "scan.csv", "exact.csv", "taps.h5"));
  EXPECT_THAT(check_dataset(dataset, plate).errors, SizeIs(4)) << "without hashes nothing is certain";
  pack_dataset(dataset);
  const Dataset again = load_dataset(folder / "dataset.json");
  EXPECT_EQ(again.folder, folder);
  EXPECT_EQ(again.sha256, dataset.sha256);
  EXPECT_EQ(again.recordings[0].exact, "exact.csv");
  EXPECT_EQ(again.recordings[0].repeat, "taps.h5");
  const DatasetReport report = check_dataset(again, plate);
  EXPECT_THAT(report.errors, IsEmpty());
  EXPECT_THAT(report.warnings, IsEmpty());
  EXPECT_THAT(report.facts, ElementsAre(HasSubstr("scan.csv: 100 samples"), HasSubstr("taps.h5: 100 samples")));
  const std::string text = read_file(folder / "dataset.json");
  pack_dataset(dataset);
  EXPECT_EQ(text, read_file(folder / "dataset.json")) << "packing twice changes nothing";
}

// A link to a file elsewhere, directly or through a folder: nothing of it is hashed or packed. A link within is fine.
TEST(PackedDataset, NothingFromOutsideOfTheFolderIsPacked) {
  const auto folder = make_dataset();
  const auto outside = folder.parent_path() / "private";
  const auto archive = folder.parent_path() / "plate.tar.gz";
  std::filesystem::create_directories(outside);
  save_recording(outside / "scan.csv", arc(1.0));
  write_file(outside / "plate.obj", "v 0 0 0\n");
  const auto refused = [&] {
    Dataset dataset = load_dataset(folder);
    EXPECT_THROW(pack_dataset(dataset), BadData);
    EXPECT_THROW(archive_dataset(dataset, archive), BadData);
    EXPECT_FALSE(std::filesystem::exists(archive));
    EXPECT_TRUE(load_dataset(folder).sha256.empty());
  };
  std::filesystem::remove(folder / "scan.csv");
  std::filesystem::create_symlink("../private/scan.csv", folder / "scan.csv");
  refused();
  std::filesystem::remove(folder / "scan.csv");
  std::filesystem::create_symlink(outside / "scan.csv", folder / "scan.csv");
  refused();
  std::filesystem::remove(folder / "scan.csv");
  std::filesystem::create_symlink("exact.csv", folder / "scan.csv");
  Dataset dataset = load_dataset(folder);
  pack_dataset(dataset);
  archive_dataset(dataset, archive);
  std::filesystem::remove_all(folder / "meshes");
  std::filesystem::create_directory_symlink("../private", folder / "meshes");
  write_file(folder / "dataset.json", example);
  std::filesystem::remove(archive);
  refused();
}

TEST(PackedDataset, CheckFindsWhatIsWrong) {
  const auto folder = make_dataset();
  Dataset dataset = load_dataset(folder);
  pack_dataset(dataset);
  save_recording(folder / "scan.csv", arc(1.5));
  std::filesystem::remove(folder / "exact.csv");
  write_file(folder / "taps.h5", "cut");
  EXPECT_THAT(check_dataset(dataset, plate).errors,
              ElementsAre(HasSubstr("scan.csv: has changed: SHA-256"), HasSubstr("exact.csv: is named in dataset.json"),
                          HasSubstr("taps.h5: has changed"), HasSubstr("taps.h5: cannot be read as HDF5")));
  EXPECT_THROW(pack_dataset(dataset), BadData);
  EXPECT_EQ(load_dataset(folder).sha256, dataset.sha256) << "a failed pack changes nothing";
}

TEST(PackedDataset, CheckAsksForTheUnitOfAMeshElsewhere) {
  const auto folder = make_dataset(changed("\"mm\"", "\"m\""));
  Dataset dataset = load_dataset(folder);
  pack_dataset(dataset);
  EXPECT_THAT(check_dataset(dataset, plate).warnings, ::testing::Contains(HasSubstr("is the mesh in mm?")));
  const auto elsewhere = [](const auto&, const auto&) { return Box3(Vec3(5, 5, 5), Vec3(6, 6, 6)); };
  EXPECT_THAT(check_dataset(dataset, elsewhere).errors, ::testing::Contains(HasSubstr("is nowhere near")));
  const auto unreadable = [](const auto&, const auto&) -> Box3 { throw BadData("no such mesh"); };
  EXPECT_THAT(check_dataset(dataset, unreadable).errors, ElementsAre("no such mesh"));
  save_recording(folder / "scan.csv", arc(0.0));
  pack_dataset(dataset);
  EXPECT_THAT(check_dataset(dataset, plate).errors, ElementsAre(HasSubstr("every force is zero")));
}

TEST(PackedDataset, TheArchiveHoldsEverythingAndIsReproducible) {
  const auto folder = make_dataset();
  Dataset dataset = load_dataset(folder);
  pack_dataset(dataset);
  const auto out = folder.parent_path() / "plate.tar.gz";
  archive_dataset(dataset, out);
  const std::string bytes = read_file(out);
  archive_dataset(dataset, out);
  EXPECT_EQ(bytes, read_file(out));
  const auto copy = folder.parent_path() / "copy";
  ensure_writable_folder(copy);
  const std::string command = "tar -xzf '" + out.string() + "' -C '" + copy.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(check_dataset(load_dataset(copy / "plate"), plate).errors, IsEmpty());
  EXPECT_THROW(archive_dataset(dataset, folder.parent_path() / "plate.zip"), BadData);
}

}  // namespace
}  // namespace touchstone::datasets
