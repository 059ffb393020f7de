#include "packed_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/recording/extent_check.h"
#include "harness/recording/recording_stream.h"

namespace touchstone::datasets {
using recording::ClockPolicy;
using recording::Dataset;
using recording::DatasetRecording;

namespace {

// False where the file cannot be used.
bool check_file(const Dataset& dataset, const std::string& file, DatasetReport& report) {
  const auto path = dataset.path_of(file);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    report.errors.push_back(fmt::format("{}: is named in dataset.json but is not there", path.string()));
    return false;
  }
  const auto expected = dataset.sha256.find(file);
  if (expected == dataset.sha256.end()) {
    report.errors.push_back(fmt::format("{}: dataset.json has no SHA-256 of it; 'touchstone dataset pack {}' adds it",
                                        path.string(), dataset.folder.string()));
    return true;
  }
  const std::string hash = sha256_file(path);
  if (hash == expected->second) return true;
  report.errors.push_back(
      fmt::format("{}: has changed: SHA-256 {} where dataset.json says {}", path.string(), hash, expected->second));
  return true;
}

void check_recording(const Dataset& dataset, const DatasetRecording& recording, const ClockPolicy& clock,
                     const std::optional<Box3>& mesh, DatasetReport& report) {
  auto stream = recording::RecordingStream::open(dataset.path_of(recording.file), {.need_force = true, .clock = clock});
  Box3 box;
  double largest_N = 0.0;
  recording::SampleBlock block;
  while (stream.next(block)) {
    for (const Vec3& p : block.motion.p_W_m) box.extend(p);
    for (const Vec3& f : block.f_W_N) largest_N = std::max(largest_N, f.norm());
  }
  report.facts.push_back(fmt::format("{}: {}, largest force {:.3g} N: {}", recording.file, stream.clock().summary(),
                                     largest_N, recording.shows));
  for (const std::string& note : stream.notes()) report.warnings.push_back(note);
  if (largest_N == 0.0) report.errors.push_back(fmt::format("{}: every force is zero", stream.source()));
  if (!mesh) return;
  if (const auto mismatch = recording::check_extents(box, *mesh, dataset.mesh_unit)) {
    (mismatch->apart ? report.errors : report.warnings)
        .push_back(fmt::format("{}: {}", stream.source(), mismatch->message));
  }
}

}  // namespace

void pack_dataset(Dataset& dataset) {
  std::map<std::string, std::string> hashes;
  for (const std::string& file : dataset.files()) hashes[file] = sha256_file(dataset.own_path_of(file));
  dataset.sha256 = std::move(hashes);
  save_dataset(dataset);
}

DatasetReport check_dataset(const Dataset& dataset, const MeshBounds& mesh_bounds, const ClockPolicy& clock) {
  DatasetReport report;
  std::vector<std::string> present;
  const std::vector<std::string> files = dataset.files();
  std::ranges::copy_if(files, std::back_inserter(present),
                       [&](const std::string& file) { return check_file(dataset, file, report); });
  const auto is_present = [&](const std::string& file) { return std::ranges::find(present, file) != present.end(); };
  std::optional<Box3> mesh;
  const auto keep_error = [&](const auto& call) {
    try {
      call();
    } catch (const BadData& error) {
      report.errors.emplace_back(error.what());
    }
  };
  if (is_present(dataset.mesh_file)) {
    keep_error([&] { mesh = mesh_bounds(dataset.path_of(dataset.mesh_file), dataset.mesh_unit); });
  }
  for (const DatasetRecording& recording : dataset.recordings) {
    if (is_present(recording.file)) keep_error([&] { check_recording(dataset, recording, clock, mesh, report); });
    // A repeat that is no recording of its own is read too: only the leaderboard would say that it cannot be.
    if (!is_present(recording.repeat) ||
        std::ranges::find(dataset.recordings, recording.repeat, &DatasetRecording::file) != dataset.recordings.end())
      continue;
    keep_error([&] {
      check_recording(dataset, {recording.repeat, "repeat of " + recording.file, "", ""}, clock, mesh, report);
    });
  }
  for (const auto& [file, hash] : dataset.sha256) {
    if (std::ranges::find(files, file) == files.end()) {
      report.warnings.push_back(fmt::format("dataset.json has a SHA-256 of '{}', which it names nowhere", file));
    }
  }
  return report;
}

}  // namespace touchstone::datasets
