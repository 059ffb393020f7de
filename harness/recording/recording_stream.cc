#include "harness/recording/recording_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

// More samples than this at one time are no accident of a clock: it stood still, or the file declares samples that were
// never written.
constexpr std::size_t most_repeats = 10000;

}  // namespace

RecordingStream RecordingStream::open(const std::filesystem::path& path, const StreamOptions& options) {
  RecordingStream stream;
  stream.source_ = path.string();
  stream.options_ = options;
  if (!(options.clock.gap_factor > 1.0)) {
    throw UsageError(fmt::format("the gap factor must be above 1, got {}", options.clock.gap_factor));
  }
  stream.table_ = open_table(path);
  const TableSource& table = *stream.table_;
  stream.columns_ = ColumnSet::parse(table.names(), [&](std::size_t i) { return table.name_place(i); });
  stream.raw_.resize(stream.columns_.columns().size());
  const auto require = [&](ColumnGroup group, const char* why) {
    if (stream.has(group)) return;
    throw BadData(fmt::format("{}: the columns {} are missing{}; the file has {}", stream.source_,
                              describe_group(group), why, fmt::join(table.names(), ", ")));
  };
  require(ColumnGroup::time, "");
  require(ColumnGroup::position, "");
  if (options.need_force) require(ColumnGroup::force, " (a recording holds the measured force)");
  if (options.need_contact) {
    constexpr const char* why = " (a rendered file holds force, surface contact point and contact)";
    require(ColumnGroup::force, why);
    require(ColumnGroup::contact_point, why);
    require(ColumnGroup::contact, why);
  }
  return stream;
}

bool RecordingStream::next(SampleBlock& block, std::size_t max_samples) {
  block.clear();
  while (block.size() == 0) {
    if (finished_) return false;
    for (auto& column : raw_) column.clear();
    const std::size_t rows = table_->read(std::max<std::size_t>(max_samples, 1), raw_);
    if (rows > 0) {
      convert(block);
      check_values(block);
      check_times(block);
      raw_first_ += rows;
    } else if (held_.size() > 0) {
      block.append_mean(held_, 0, held_.size());
      held_.clear();
    }
    for (const double t : block.motion.t_s) monitor_.add(t);
    block.first_sample = samples_;
    samples_ += block.size();
    if (rows == 0) finish();
  }
  return true;
}

void RecordingStream::convert(SampleBlock& block) const {
  const auto scalars = [&](Quantity quantity, auto& to) {
    const auto at = columns_.find(quantity);
    if (!at) return;
    const UnitScale scale = columns_.columns()[*at].scale;
    to.resize(raw_[*at].size());
    std::ranges::transform(raw_[*at], to.begin(), [&](double value) { return scale.to_si(value); });
  };
  const auto vectors = [&](Quantity x, std::vector<Vec3>& to) {
    if (!columns_.find(x)) return;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = *columns_.find(static_cast<Quantity>(static_cast<int>(x) + axis));
      const UnitScale scale = columns_.columns()[at].scale;
      const std::vector<double>& from = raw_[at];
      to.resize(from.size());
      for (std::size_t i = 0; i < from.size(); ++i) to[i][axis] = scale.to_si(from[i]);
    }
  };
  scalars(Quantity::t, block.motion.t_s);
  scalars(Quantity::cost, block.cost_us);
  vectors(Quantity::x, block.motion.p_W_m);
  vectors(Quantity::fx, block.f_W_N);
  vectors(Quantity::tx, block.torque_W_Nm);
  vectors(Quantity::px, block.contact_W_m);
  if (const auto w = columns_.find(Quantity::qw)) {
    const auto x = *columns_.find(Quantity::qx);
    const auto y = *columns_.find(Quantity::qy);
    const auto z = *columns_.find(Quantity::qz);
    block.motion.q_WS.reserve(raw_[x].size());
    for (std::size_t i = 0; i < raw_[x].size(); ++i) {
      block.motion.q_WS.emplace_back(raw_[*w][i], raw_[x][i], raw_[y][i], raw_[z][i]);
    }
  }
  if (const auto at = columns_.find(Quantity::contact)) {
    block.contact.resize(raw_[*at].size());
    std::ranges::transform(raw_[*at], block.contact.begin(), [](double value) { return value == 1.0 ? 1 : 0; });
  }
}

void RecordingStream::check_values(SampleBlock& block) {
  const std::size_t rows = block.size();
  // The first bad row among all columns, so that the message names what a reader of the file meets first.
  std::size_t first_bad = rows;
  std::size_t bad_column = 0;
  std::string why;
  for (std::size_t i = 0; i < raw_.size(); ++i) {
    const Column& column = columns_.columns()[i];
    const auto limit = raw_[i].begin() + static_cast<std::ptrdiff_t>(first_bad);
    const auto bad = std::find_if(raw_[i].begin(), limit, [&](double value) {
      if (column.quantity == Quantity::contact) return value != 0.0 && value != 1.0;
      if (column.quantity == Quantity::cost && value < 0.0) return true;
      return !std::isfinite(column.scale.to_si(value));
    });
    if (bad == limit) continue;
    first_bad = static_cast<std::size_t>(bad - raw_[i].begin());
    bad_column = i;
    if (column.quantity == Quantity::contact) {
      why = fmt::format("{} is no contact state; 0 or 1 was expected", *bad);
    } else if (std::isfinite(*bad)) {
      why = fmt::format("{} is out of range", *bad);
    } else {
      why = fmt::format("{} is not a finite number; remove or repair this sample", *bad);
    }
  }
  if (first_bad < rows) fail(first_bad, columns_.columns()[bad_column].quantity, why);
  normalise_orientation(block);
}

void RecordingStream::normalise_orientation(SampleBlock& block) {
  // A quaternion normalised once stays as it is, so that what was written is read back to the bit.
  constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
  for (std::size_t i = 0; i < block.motion.q_WS.size(); ++i) {
    Quat& q = block.motion.q_WS[i];
    const double squared = q.squaredNorm();
    if (std::abs(squared - 1.0) <= rounding) continue;
    const double deviation = std::abs(std::sqrt(squared) - 1.0);
    if (!(deviation <= quaternion_tolerance)) {
      fail(i, Quantity::qw,
           fmt::format("the quaternion ({}, {}, {}, {}) has length {:.6g}; a rotation has length 1 (within {})", q.w(),
                       q.x(), q.y(), q.z(), std::sqrt(squared), quaternion_tolerance));
    }
    quaternion_deviation_ = std::max(quaternion_deviation_, deviation);
    q.coeffs() /= std::sqrt(squared);
  }
}

void RecordingStream::check_times(SampleBlock& block) {
  const std::vector<double>& t = block.motion.t_s;
  std::vector<std::size_t> repeated;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (last_time_s_ && t[i] <= *last_time_s_) {
      const std::string before = table_->row_name(raw_first_ + i - 1);
      if (t[i] < *last_time_s_) {
        fail(i, Quantity::t,
             fmt::format("time goes back to {} s after {} s in {}; sort the samples, or split the file where the clock "
                         "started again",
                         t[i], *last_time_s_, before));
      }
      if (options_.clock.on_duplicate == OnDuplicate::refuse) {
        fail(i, Quantity::t,
             fmt::format("time {} s repeats that of {}; --on-duplicate first keeps the first of such samples, mean "
                         "their mean",
                         t[i], before));
      }
      if (++repeats_ > most_repeats) {
        fail(i, Quantity::t,
             fmt::format("more than {} samples have the time {} s; the clock stood still", most_repeats, t[i]));
      }
      monitor_.count_duplicate();
      if (!first_duplicate_row_) first_duplicate_row_ = raw_first_ + i;
      repeated.push_back(i);
    } else {
      repeats_ = 0;
    }
    last_time_s_ = t[i];
  }
  if (options_.clock.on_duplicate == OnDuplicate::mean) return merge_held(block);
  if (repeated.empty()) return;
  SampleBlock kept;
  std::size_t begin = 0;
  for (const std::size_t i : repeated) {
    kept.append(block, begin, i);
    begin = i + 1;
  }
  kept.append(block, begin, block.size());
  block = std::move(kept);
}

void RecordingStream::merge_held(SampleBlock& block) {
  held_.append(block);
  block.clear();
  const std::vector<double>& t = held_.motion.t_s;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (t[i] == t[begin]) continue;
    if (i - begin == 1) {
      block.append(held_, begin, i);
    } else {
      block.append_mean(held_, begin, i);
    }
    begin = i;
  }
  SampleBlock rest;
  rest.append(held_, begin, held_.size());
  held_ = std::move(rest);
}

void RecordingStream::finish() {
  finished_ = true;
  if (samples_ == 0) {
    throw BadData(fmt::format("{}: names its columns but holds no samples; at least two are needed", source_));
  }
  if (samples_ == 1) {
    throw BadData(fmt::format("{}: holds one sample; at least two are needed", source_));
  }
  if (options_.clock.on_gap != OnGap::refuse) return;
  const ClockReport report = clock();
  if (report.gap_count == 0) return;
  const Gap& gap = report.gaps.front();
  throw BadData(fmt::format(
      "{}: has {} gap{} longer than {} median intervals of {:.6g} s; the first, of {:.6g} s, is after t = {} s; "
      "--on-gap split starts anew after each, keep uses the samples as they are",
      source_, report.gap_count, report.gap_count == 1 ? "" : "s", report.gap_factor, report.median_interval_s,
      gap.length_s, gap.from_s));
}

std::vector<std::string> RecordingStream::notes() const {
  std::vector<std::string> notes = table_->notes();
  const ClockReport report = clock();
  if (report.duplicates > 0) {
    notes.push_back(fmt::format(
        "{}: {} sample{} with a repeated time {}, the first in {}", source_, report.duplicates,
        report.duplicates == 1 ? "" : "s",
        options_.clock.on_duplicate == OnDuplicate::first ? "left out (the first of each stays)" : "merged into means",
        table_->row_name(*first_duplicate_row_)));
  }
  if (report.gap_count > 0) {
    notes.push_back(fmt::format(
        "{}: {} gap{} longer than {} median intervals, the first of {:.6g} s after t = {} s; {}", source_,
        report.gap_count, report.gap_count == 1 ? "" : "s", report.gap_factor, report.gaps.front().length_s,
        report.gaps.front().from_s,
        options_.clock.on_gap == OnGap::split ? "each starts a new segment" : "the samples are used as they are"));
  }
  if (quaternion_deviation_ > 0.0) {
    notes.push_back(fmt::format("{}: quaternions normalised; their length differed from 1 by at most {:.2g}", source_,
                                quaternion_deviation_));
  }
  return notes;
}

std::string RecordingStream::place(std::size_t row, Quantity quantity) const {
  return table_->value_place(raw_first_ + row, *columns_.find(quantity));
}

void RecordingStream::fail(std::size_t row, Quantity quantity, const std::string& why) const {
  throw BadData(fmt::format("{}: {}", place(row, quantity), why));
}

}  // namespace touchstone::recording
