// The fuzzers' entry point over the seeds and over everything they once found.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/random.h"
#include "harness/surface/fuzz/read_mesh.h"
#include "harness/surface/fuzz/read_structured_mesh.h"

namespace touchstone::surface {
namespace {

// Every seed as it is, cut short, and with bytes changed, always in the same way.
void run_corpus(const std::string& name, MeshFormat format) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  const auto folder = std::filesystem::path(source != nullptr ? source : ".") / "harness/surface/fuzz/corpus" / name;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++files;
    const std::string seed = read_file(entry.path());
    const auto run = [&](const std::string& bytes) {
      return fuzz::read_mesh(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), format);
    };
    run(seed);
    Random random(1);
    for (int trial = 0; trial < 200 && !seed.empty(); ++trial) {
      run(seed.substr(0, random.below(seed.size())));
      std::string changed = seed;
      for (int i = 0; i < 3; ++i) changed[random.below(seed.size())] = static_cast<char>(random.below(256));
      run(changed);
    }
  }
  EXPECT_GT(files, 0U) << "no seeds in " << folder;
}

TEST(MeshFuzzCorpus, Obj) { run_corpus("obj", MeshFormat::obj); }
TEST(MeshFuzzCorpus, Off) { run_corpus("off", MeshFormat::off); }
TEST(MeshFuzzCorpus, Ply) { run_corpus("ply", MeshFormat::ply); }
TEST(MeshFuzzCorpus, Stl) { run_corpus("stl", MeshFormat::stl); }

TEST(MeshFuzzCorpus, StructuresAreReadUndamagedAndSometimesDamaged) {
  EXPECT_EQ(fuzz::read_structured_mesh(nullptr, 0), 6U);
  Random random(1);
  std::size_t read = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::string bytes(2 + random.below(120), ' ');
    for (char& byte : bytes) byte = static_cast<char>(random.below(256));
    read += fuzz::read_structured_mesh(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  EXPECT_GT(read, 30U) << "the damage hides what lies behind the first checks";
  EXPECT_LT(read, 2900U) << "nothing is damaged";
}

}  // namespace
}  // namespace touchstone::surface
