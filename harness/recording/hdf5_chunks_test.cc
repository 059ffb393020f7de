// The own decoder against HDF5's pipeline, to the bit, however the rows are asked for.
#include "harness/recording/hdf5_chunks.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <future>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/recording/hdf5_handle.h"
#include "harness/recording/recording_file.h"
#include "harness/recording/table_source.h"

namespace touchstone::recording {
namespace {

class Hdf5Chunks : public testing::Test {
 protected:
  Hdf5Chunks() { std::filesystem::create_directories(folder_); }
  ~Hdf5Chunks() override { std::filesystem::remove_all(folder_); }

  // Forces that are smooth, constant, or bits at random (which deflate cannot shrink), at very different scales.
  std::filesystem::path rendered(std::size_t samples, std::uint64_t seed) const {
    Random random(seed);
    RenderedTrajectory run;
    for (std::size_t i = 0; i < samples; ++i) {
      run.t_s.push_back(1e-3 * static_cast<double>(i));
      run.tip_W_m.emplace_back(random.log_uniform(1e-300, 1e300), 0.25, -random.log_uniform(1e-12, 1.0));
      run.contact_W_m.emplace_back(random.uniform(-1.0, 1.0), static_cast<double>(i), -0.0);
      run.f_W_N.emplace_back(random.uniform(-1.0, 1.0), random.uniform(-1e3, 1e3), 1.0);
      run.contact.push_back(static_cast<unsigned char>(random.below(2)));
    }
    auto file = folder_ / (std::to_string(samples) + ".h5");
    save_rendered(file, run);
    return file;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("touchstone-chunks-" + std::to_string(::getpid()));
};

std::vector<double> through_hdf5(const std::filesystem::path& file, const std::string& name, std::size_t samples) {
  const Hdf5Quiet quiet;
  const Hdf5File h5(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const Hdf5Dataset dataset(H5Dopen2(h5.get(), name.c_str(), H5P_DEFAULT));
  EXPECT_TRUE(checksummed_chunks(dataset.get()).has_value()) << name;
  std::vector<double> values(samples);
  EXPECT_GE(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  return values;
}

std::vector<std::vector<double>> through_chunks(const std::filesystem::path& file, std::size_t block) {
  const auto table = open_table(file);
  std::vector<std::vector<double>> columns(table->names().size());
  while (table->read(block, columns) > 0) {
  }
  return columns;
}

TEST_F(Hdf5Chunks, GivesTheBitsOfHdf5HoweverManyRowsAreAskedFor) {
  for (const std::size_t samples : {1U, 7U, 8191U, 8192U, 8193U, 40000U}) {
    const auto file = rendered(samples, 20260101 + samples);
    const auto names = open_table(file)->names();
    for (const std::size_t block : {1000U, 8192U, 12345U, 1000000U}) {
      const auto columns = through_chunks(file, block);
      for (std::size_t c = 0; c < names.size(); ++c) {
        const auto expected = through_hdf5(file, names[c], samples);
        ASSERT_EQ(columns[c].size(), samples);
        EXPECT_EQ(std::memcmp(columns[c].data(), expected.data(), samples * sizeof(double)), 0)
            << names[c] << ", blocks of " << block;
      }
    }
  }
}

// Every byte of the values has a checksum over it: no flip of any bit passes, and none reads outside of its memory.
TEST_F(Hdf5Chunks, NoFlippedBitPasses) {
  const auto file = rendered(9000, 5);
  const auto whole = through_chunks(file, 1 << 20);
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  Random random(7);
  int refused = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = bytes;
    damaged[random.below(damaged.size())] ^= static_cast<char>(1U << random.below(8));
    const auto other = folder_ / "damaged.h5";
    std::ofstream(other, std::ios::binary) << damaged;
    try {
      const auto columns = through_chunks(other, 1 << 20);
      for (std::size_t c = 0; c < whole.size(); ++c)
        // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits are meant, not the values
        ASSERT_EQ(std::memcmp(columns[c].data(), whole[c].data(), 9000 * sizeof(double)), 0) << "trial " << trial;
    } catch (const BadData&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
}

TEST_F(Hdf5Chunks, ManyThreadsReadAtOnce) {
  const auto file = rendered(30000, 11);
  const auto expected = through_chunks(file, 1 << 20);
  std::vector<std::future<std::vector<std::vector<double>>>> readers;
  for (int i = 0; i < 6; ++i)
    readers.push_back(std::async(std::launch::async, [&] { return through_chunks(file, 5000); }));
  for (auto& reader : readers) EXPECT_TRUE(reader.get() == expected);
}

}  // namespace
}  // namespace touchstone::recording
