// Five kilohertz from the emulated sensor through driver, recorder and disk in real time: an hour where
// TOUCHSTONE_SOAK_SECONDS says 3600, else a minute. Loses nothing, in bounded memory.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "hil/emulators/netft_emulator.h"
#include "hil/record/record_session.h"

namespace touchstone::hil {
namespace {

TEST(Soak, FiveKilohertzIsRecordedWithoutLoss) {
  const char* const text = std::getenv("TOUCHSTONE_SOAK_SECONDS");
  const double seconds = text != nullptr ? std::atof(text) : 60.0;
  const auto file = std::filesystem::temp_directory_path() / fmt::format("touchstone-soak-{}.tsraw", ::getpid());
  NetFtEmulator emulator(5000, {}, [](double t) { return Wrench{Vec3(t, 1, 2), Vec3(3, 4, 5)}; });
  const auto source = open_netft(emulator.address(), 2.0, true);
  RecordOptions options;
  options.seconds = seconds;
  options.plot = false;
  const auto report = record_session(*source, file, options, [] { return false; });
  std::uint64_t n = 0, gaps = 0, last = 0;
  const auto recovered = read_raw(file, [&](const RawSample& s) {
    gaps += n > 0 && s.wrench.sequence != last + 1;
    last = s.wrench.sequence;
    ++n;
  });
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  fmt::print(
      "emulated soak: {:.0f} s, {} samples written, lost on the way {}, lost in memory {}, gaps {}, file {:.1f} MB, "
      "largest memory {:.1f} MB\n",
      report.seconds, report.written, report.stream.lost, report.lost_in_memory, gaps,
      1e-6 * static_cast<double>(std::filesystem::file_size(file)), static_cast<double>(usage.ru_maxrss) / 1024);
  std::filesystem::remove(file);
  EXPECT_EQ(report.stream.lost + report.lost_in_memory + gaps + recovered.missing_samples + recovered.damaged_bytes,
            0U);
  EXPECT_GE(static_cast<double>(report.written), 0.99 * 5000 * seconds);
  EXPECT_LT(usage.ru_maxrss, 200 * 1024);
}

}  // namespace
}  // namespace touchstone::hil
