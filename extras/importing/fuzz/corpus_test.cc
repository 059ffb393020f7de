// The fuzzers' entry points over the seeds: each as it is, cut short, and with bytes changed, always in the same way.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "fuzz/read_import.h"
#include "harness/base/atomic_file.h"
#include "harness/base/random.h"

namespace touchstone::importing {
namespace {

std::filesystem::path in_source(const std::string& folder) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  return std::filesystem::path(source != nullptr ? source : ".") / "extras/importing" / folder;
}

template <class Read>
void run_corpus(const std::string& folder, const Read& read) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(in_source(folder))) {
    ++files;
    const std::string seed = read_file(entry.path());
    const auto run = [&](const std::string& bytes) {
      read(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    };
    run(seed);
    Random random(1);
    for (int trial = 0; trial < 50 && !seed.empty(); ++trial) {
      run(seed.substr(0, random.below(seed.size())));
      std::string changed = seed;
      for (int i = 0; i < 3; ++i) changed[random.below(seed.size())] = static_cast<char>(random.below(256));
      run(changed);
    }
  }
  EXPECT_GT(files, 0U) << "no seeds in " << in_source(folder);
}

void run_format(const std::string& format, const std::string& extension) {
  run_corpus("fuzz/corpus/" + format,
             [&](const std::uint8_t* data, std::size_t size) { fuzz::read_import(data, size, extension); });
}

TEST(ImportFuzzCorpus, Text) { run_format("text", ".txt"); }
TEST(ImportFuzzCorpus, Bag) { run_format("bag", ".bag"); }
TEST(ImportFuzzCorpus, Database) { run_format("database", ".db3"); }
TEST(ImportFuzzCorpus, Excel) { run_format("excel", ".xlsx"); }
TEST(ImportFuzzCorpus, Mat) { run_format("mat", ".mat"); }
TEST(ImportFuzzCorpus, Mcap) { run_format("mcap", ".mcap"); }
TEST(ImportFuzzCorpus, Numpy) { run_format("numpy", ".npy"); }
TEST(ImportFuzzCorpus, Tdms) { run_format("tdms", ".tdms"); }
TEST(ImportFuzzCorpus, Map) { run_corpus("maps", fuzz::read_map); }

}  // namespace
}  // namespace touchstone::importing
