// The fuzzers' entry points over the seeds and over everything they once found.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/random.h"
#include "harness/recording/fuzz/read_recording.h"
#include "harness/recording/fuzz/read_structured_recording.h"

namespace touchstone::recording {
namespace {

std::filesystem::path corpus(const std::string& format) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  return std::filesystem::path(source != nullptr ? source : ".") / "harness/recording/fuzz/corpus" / format;
}

// Every seed as it is, cut short, and with bytes changed, always in the same way.
void run_corpus(const std::string& format, const std::string& extension) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(corpus(format))) {
    ++files;
    const std::string seed = read_file(entry.path());
    const auto run = [&](const std::string& bytes) {
      fuzz::read_recording(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), extension);
    };
    run(seed);
    Random random(1);
    for (int trial = 0; trial < 8 && !seed.empty(); ++trial) {
      run(seed.substr(0, random.below(seed.size())));
      std::string changed = seed;
      for (int i = 0; i < 3; ++i) changed[random.below(seed.size())] = static_cast<char>(random.below(256));
      run(changed);
    }
  }
  EXPECT_GT(files, 0U) << "no seeds in " << corpus(format);
}

TEST(FuzzCorpus, Csv) { run_corpus("csv", ".csv"); }
TEST(FuzzCorpus, Hdf5) { run_corpus("hdf5", ".h5"); }

TEST(FuzzCorpus, StructuresAreReadUndamagedAndSometimesDamaged) {
  EXPECT_EQ(fuzz::read_structured_recording(nullptr, 0), 10U);
  Random random(1);
  int read = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::string bytes(2 + random.below(120), ' ');
    for (char& byte : bytes) byte = static_cast<char>(random.below(256));
    read +=
        fuzz::read_structured_recording(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) > 0 ? 1 : 0;
  }
  EXPECT_GT(read, 3) << "the damage hides what lies behind the first checks";
  EXPECT_LT(read, 290) << "nothing is damaged";
}

}  // namespace
}  // namespace touchstone::recording
