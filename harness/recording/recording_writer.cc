#include "harness/recording/recording_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

constexpr std::size_t block_rows = 8192;

std::vector<ColumnGroup> with_motion(std::vector<ColumnGroup> groups) {
  groups.push_back(ColumnGroup::time);
  groups.push_back(ColumnGroup::position);
  return groups;
}

// The value of a quantity in a block; its column must be filled.
double value_of(const SampleBlock& block, Quantity quantity, std::size_t i) {
  const int axis = static_cast<int>(quantity);
  switch (quantities()[static_cast<std::size_t>(quantity)].group) {
    case ColumnGroup::time:
      return block.motion.t_s[i];
    case ColumnGroup::position:
      return block.motion.p_W_m[i][axis - static_cast<int>(Quantity::x)];
    case ColumnGroup::orientation: {
      const Quat& q = block.motion.q_WS[i];
      return quantity == Quantity::qw ? q.w() : q.vec()[axis - static_cast<int>(Quantity::qx)];
    }
    case ColumnGroup::force:
      return block.f_W_N[i][axis - static_cast<int>(Quantity::fx)];
    case ColumnGroup::torque:
      return block.torque_W_Nm[i][axis - static_cast<int>(Quantity::tx)];
    case ColumnGroup::contact_point:
      return block.contact_W_m[i][axis - static_cast<int>(Quantity::px)];
    case ColumnGroup::contact:
      return block.contact[i];
    case ColumnGroup::cost:
      return block.cost_us[i];
  }
  return std::nan("");
}

std::size_t filled(const SampleBlock& block, ColumnGroup group) {
  switch (group) {
    case ColumnGroup::time:
      return block.motion.t_s.size();
    case ColumnGroup::position:
      return block.motion.p_W_m.size();
    case ColumnGroup::orientation:
      return block.motion.q_WS.size();
    case ColumnGroup::force:
      return block.f_W_N.size();
    case ColumnGroup::torque:
      return block.torque_W_Nm.size();
    case ColumnGroup::contact_point:
      return block.contact_W_m.size();
    case ColumnGroup::contact:
      return block.contact.size();
    case ColumnGroup::cost:
      return block.cost_us.size();
  }
  return 0;
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& path, const std::vector<ColumnGroup>& groups,
                                 const ColumnUnits& units)
    : name_(path.string()),
      columns_(make_columns(with_motion(groups), units)),
      sink_(create_table(path, columns_)),
      raw_(columns_.size()) {}

void RecordingWriter::append(const SampleBlock& block) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    const ColumnGroup group = quantities()[static_cast<std::size_t>(column.quantity)].group;
    if (filled(block, group) != block.size()) {
      throw std::invalid_argument(fmt::format("{}: column {} has {} values for {} samples", name_, column.name,
                                              filled(block, group), block.size()));
    }
    raw_[c].resize(block.size());
    for (std::size_t i = 0; i < block.size(); ++i) {
      const double value = column.scale.from_si(value_of(block, column.quantity, i));
      if (!std::isfinite(value)) {
        throw BadData(fmt::format("{}: not written: {} is {} at sample {} (t = {} s)", name_, column.name, value,
                                  samples_ + i, block.motion.t_s[i]));
      }
      raw_[c][i] = value;
    }
  }
  for (std::size_t i = 0; i < block.size(); ++i) {
    const double t_s = block.motion.t_s[i];
    if (samples_ + i > 0 && !(t_s > last_time_s_)) {
      throw BadData(fmt::format("{}: not written: time does not increase at sample {}: {} s after {} s", name_,
                                samples_ + i, t_s, last_time_s_));
    }
    last_time_s_ = t_s;
  }
  sink_->write(raw_);
  samples_ += block.size();
}

TrajectoryWriter::TrajectoryWriter(const std::filesystem::path& path, bool with_orientation, const ColumnUnits& units)
    : writer_(path, with_orientation ? std::vector{ColumnGroup::orientation} : std::vector<ColumnGroup>{}, units),
      with_orientation_(with_orientation) {}

void TrajectoryWriter::append(double t_s, const Vec3& p_W_m, const Quat& q_WS) {
  block_.motion.t_s.push_back(t_s);
  block_.motion.p_W_m.push_back(p_W_m);
  if (with_orientation_) block_.motion.q_WS.push_back(q_WS);
  if (block_.size() == block_rows) flush();
}

void TrajectoryWriter::flush() {
  writer_.append(block_);
  block_.clear();
}

void TrajectoryWriter::commit() {
  flush();
  writer_.commit();
}

RenderedWriter::RenderedWriter(const std::filesystem::path& path, bool with_cost, const ColumnUnits& units)
    : writer_(path,
              with_cost
                  ? std::vector{ColumnGroup::force, ColumnGroup::contact_point, ColumnGroup::contact, ColumnGroup::cost}
                  : std::vector{ColumnGroup::force, ColumnGroup::contact_point, ColumnGroup::contact},
              units),
      with_cost_(with_cost) {}

void RenderedWriter::append(double t_s, const Vec3& tip_W_m, const Vec3& contact_W_m, const Vec3& f_W_N, bool contact,
                            double cost_us) {
  block_.motion.t_s.push_back(t_s);
  block_.motion.p_W_m.push_back(tip_W_m);
  block_.contact_W_m.push_back(contact_W_m);
  block_.f_W_N.push_back(f_W_N);
  block_.contact.push_back(contact ? 1 : 0);
  if (with_cost_) block_.cost_us.push_back(cost_us);
  if (block_.size() == block_rows) flush();
}

void RenderedWriter::flush() {
  writer_.append(block_);
  block_.clear();
}

void RenderedWriter::commit() {
  flush();
  writer_.commit();
}

}  // namespace touchstone::recording
