#include "harness/recording/fuzz/read_recording.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "harness/base/error.h"
#include "harness/recording/recording_stream.h"

namespace touchstone::recording::fuzz {
namespace {

// A file of one process, in memory where the system has such a place: fuzzers write thousands a second.
std::filesystem::path scratch(const std::string& extension) {
  const std::filesystem::path memory = "/dev/shm";
  const auto folder = std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
  return folder / fmt::format("touchstone-fuzz-{}{}", ::getpid(), extension);
}

void check(bool holds) {
  if (!holds) std::abort();
}

// What every reader promises of what it gives out.
void check_block(const SampleBlock& block, const RecordingStream& stream, double& last_time_s) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    check(std::isfinite(block.motion.t_s[i]) && block.motion.t_s[i] > last_time_s);
    last_time_s = block.motion.t_s[i];
    check(block.motion.p_W_m[i].allFinite());
  }
  for (const Vec3& f : block.f_W_N) check(f.allFinite());
  for (const Quat& q : block.motion.q_WS) check(std::abs(q.norm() - 1.0) < 1e-12);
  check(block.f_W_N.size() == (stream.has(ColumnGroup::force) ? block.size() : 0));
}

}  // namespace

std::size_t read_recording(const std::uint8_t* data, std::size_t size, const std::string& extension) {
  const auto file = scratch(extension);
  struct Remove {
    const std::filesystem::path& path;
    ~Remove() {
      std::error_code ignored;
      std::filesystem::remove(path, ignored);
    }
  } const remove{file};
  std::FILE* const out = std::fopen(file.c_str(), "wb");
  check(out != nullptr && std::fwrite(data, 1, size, out) == size && std::fclose(out) == 0);
  std::size_t samples = 0;
  for (const auto on_duplicate : {OnDuplicate::refuse, OnDuplicate::mean}) {
    try {
      auto stream = RecordingStream::open(file, {.clock = {.on_duplicate = on_duplicate, .on_gap = OnGap::split}});
      SampleBlock block;
      double last_time_s = -INFINITY;
      // Enough to see what a damaged file holds; one that declares 10^18 samples would never end.
      for (int blocks = 0; blocks < 64 && stream.next(block, 100); ++blocks) check_block(block, stream, last_time_s);
      samples = stream.samples();
      check(stream.samples() <= 6400);
      (void)stream.notes();
    } catch (const BadData&) {
    }
  }
  return samples;
}

}  // namespace touchstone::recording::fuzz
