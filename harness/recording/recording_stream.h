// Reading a recording of any length in bounded memory, checked as it is read: finite values, time that increases,
// quaternions of length one, contact 0 or 1. Everything comes out in SI units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "harness/recording/clock.h"
#include "harness/recording/column.h"
#include "harness/recording/sample_block.h"
#include "harness/recording/table_source.h"

namespace touchstone::recording {

struct StreamOptions {
  // Time and position are always needed; these besides.
  bool need_force = false;
  bool need_contact = false;  // surface contact point, contact and force
  ClockPolicy clock{};
};

class RecordingStream {
 public:
  // Quaternions whose length differs from 1 by no more than this are normalised; others are refused.
  static constexpr double quaternion_tolerance = 1e-3;

  // Throws BadData naming the file, place and what was expected.
  static RecordingStream open(const std::filesystem::path& path, const StreamOptions& options = {});

  // Replaces the block by up to `max_samples` (> 0) next samples; false, with an empty block, at the end. Throws
  // BadData for the first value that breaks a rule; a file with fewer than two samples is refused at its end.
  bool next(SampleBlock& block, std::size_t max_samples = 16384);

  [[nodiscard]] const ColumnSet& columns() const noexcept { return columns_; }
  [[nodiscard]] bool has(ColumnGroup group) const noexcept { return columns_.has(group); }
  // The path as given, and "CSV", "CSV, gzip" or "HDF5".
  [[nodiscard]] const std::string& source() const noexcept { return source_; }
  [[nodiscard]] std::string format() const { return table_->format(); }

  // Complete once next() returned false.
  [[nodiscard]] ClockReport clock() const { return monitor_.report(options_.clock.gap_factor); }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  // What was tolerated or changed, one sentence each: for reports.
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  RecordingStream() = default;
  void convert(SampleBlock& block) const;
  void check_values(SampleBlock& block);
  void normalise_orientation(SampleBlock& block);
  void check_times(SampleBlock& block);
  void merge_held(SampleBlock& block);
  void finish();
  [[nodiscard]] std::string place(std::size_t row, Quantity quantity) const;
  [[noreturn]] void fail(std::size_t row, Quantity quantity, const std::string& why) const;

  std::string source_;
  StreamOptions options_;
  std::unique_ptr<TableSource> table_;
  ColumnSet columns_;
  std::vector<std::vector<double>> raw_;  // one vector per column, in the file's units
  std::uint64_t raw_first_ = 0;           // the row of the file that raw_ starts with
  std::optional<double> last_time_s_;     // of the row before raw_
  std::size_t repeats_ = 0;               // samples that repeated the present time so far
  std::optional<std::uint64_t> first_duplicate_row_;
  SampleBlock held_;  // OnDuplicate::mean: the last samples of one time, to which the next block may add
  double quaternion_deviation_ = 0.0;
  ClockMonitor monitor_;
  std::uint64_t samples_ = 0;
  bool finished_ = false;
};

}  // namespace touchstone::recording
