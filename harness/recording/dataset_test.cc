#include "harness/recording/dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/scratch_folder.h"

namespace touchstone::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* example = R"({"schema": "touchstone-dataset/1",
  "object": "plate", "mesh": {"file": "meshes/plate.obj", "unit": "mm"}, "tip_radius_m": 0.001,
  "instrument": "Nano17", "stiffness_N_per_m": 500, "in_trajectory": "synthesize",
  "recordings": [{"file": "scan.csv", "shows": "a scan", "exact": "exact.csv",
                  "repeat": "taps.h5"}, {"file": "taps.h5", "shows": "taps"}],
  "source": "made for a test", "licence": "CC0-1.0"})";

std::string message_of(const std::string& json) {
  const ScratchFolder folder;
  write_file(folder.path() / "dataset.json", json);
  try {
    load_dataset(folder.path());
  } catch (const BadData& error) {
    return error.what();
  }
  return "no error";
}

std::string changed(const std::string& from, const std::string& to) {
  std::string json = example;
  json.replace(json.find(from), from.size(), to);
  return json;
}

TEST(Dataset, IsReadAndWrittenAsItIs) {
  const ScratchFolder folder;
  write_file(folder.path() / "dataset.json", example);
  const Dataset dataset = load_dataset(folder.path());
  EXPECT_EQ(dataset.mesh_unit, "mm");
  EXPECT_EQ(dataset.tip_radius_m, 0.001);
  EXPECT_EQ(dataset.stiffness_N_per_m, 500.0);
  EXPECT_THAT(dataset.files(), ElementsAre("meshes/plate.obj", "scan.csv", "exact.csv", "taps.h5"));
  save_dataset(dataset);
  const std::string text = read_file(folder.path() / "dataset.json");
  const Dataset again = load_dataset(folder.path() / "dataset.json");
  EXPECT_EQ(again.recordings[0].exact, "exact.csv");
  EXPECT_EQ(again.recordings[0].repeat, "taps.h5");
  save_dataset(again);
  EXPECT_EQ(text, read_file(folder.path() / "dataset.json"));
}

TEST(Dataset, DescriptionsThatCannotBeUsedNameThePlace) {
  EXPECT_THAT(message_of(changed("dataset/1", "dataset/9")), HasSubstr("schema"));
  EXPECT_THAT(message_of(changed("\"unit\": \"mm\"", "\"unit\": \"inch\"")), HasSubstr("/mesh/unit"));
  EXPECT_THAT(message_of(changed("scan.csv", "../scan.csv")), HasSubstr("/recordings/0/file"));
  EXPECT_THAT(message_of(changed("exact.csv", "/etc/passwd")), HasSubstr("no file within the data set's folder"));
  EXPECT_THAT(message_of(changed("\"file\": \"taps.h5", "\"file\": \"scan.csv")), HasSubstr("listed twice"));
  EXPECT_THAT(message_of(changed("\"repeat\": \"taps.h5", "\"repeat\": \"scan.csv")),
              HasSubstr("/recordings/0/repeat"));
  EXPECT_THAT(message_of(changed("0.001", "-1")), HasSubstr("tip_radius_m"));
  EXPECT_THAT(message_of(changed("500", "0")), HasSubstr("stiffness_N_per_m"));
  EXPECT_THAT(message_of(changed("\"synthesize\"", "\"guess\"")), HasSubstr("use synthesize, whole-force or measured"));
  EXPECT_THAT(message_of(changed("\"CC0-1.0\"", "\"\"")), HasSubstr("/licence"));
  EXPECT_THAT(message_of(changed("\"source\"", "\"origin\"")), HasSubstr("source"));
  EXPECT_THROW(load_dataset(std::filesystem::path(::testing::TempDir()) / "no-such-folder"), BadData);
}

}  // namespace
}  // namespace touchstone::recording
