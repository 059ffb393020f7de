// Writing recordings of any length in bounded memory, CSV or HDF5 by the extension. The file appears whole at commit(),
// or not at all. In SI units (the default) what is written is read back to the bit; in other units, to rounding.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "harness/recording/column.h"
#include "harness/recording/sample_block.h"
#include "harness/recording/table_sink.h"

namespace touchstone::recording {

class RecordingWriter {
 public:
  // `groups` are the columns that the file gets; time and position always. Throws BadData when the file cannot be
  // written, UsageError for an unknown unit.
  RecordingWriter(const std::filesystem::path& path, const std::vector<ColumnGroup>& groups,
                  const ColumnUnits& units = {});

  // Every chosen column must be filled (std::invalid_argument otherwise); others are ignored. Throws BadData for a
  // value that no reader would accept (not finite, or a time that does not increase).
  void append(const SampleBlock& block);
  void commit() { sink_->commit(); }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }

 private:
  std::string name_;
  std::vector<Column> columns_;
  std::unique_ptr<TableSink> sink_;
  std::vector<std::vector<double>> raw_;
  std::uint64_t samples_ = 0;
  double last_time_s_ = 0.0;
};

// Sample by sample: an in-trajectory.
class TrajectoryWriter {
 public:
  TrajectoryWriter(const std::filesystem::path& path, bool with_orientation, const ColumnUnits& units = {});
  void append(double t_s, const Vec3& p_W_m, const Quat& q_WS = Quat::Identity());
  void commit();

 private:
  void flush();
  RecordingWriter writer_;
  bool with_orientation_;
  SampleBlock block_;
};

// Sample by sample: what a renderer made of an in-trajectory.
class RenderedWriter {
 public:
  RenderedWriter(const std::filesystem::path& path, bool with_cost, const ColumnUnits& units = {});
  // `cost_us` is ignored where the file has no such column.
  void append(double t_s, const Vec3& tip_W_m, const Vec3& contact_W_m, const Vec3& f_W_N, bool contact,
              double cost_us = 0.0);
  void commit();

 private:
  void flush();
  RecordingWriter writer_;
  bool with_cost_;
  SampleBlock block_;
};

}  // namespace touchstone::recording
