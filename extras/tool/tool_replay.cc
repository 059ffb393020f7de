#include "tool_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "harness/base/error.h"
#include "harness/recording/recording_stream.h"
#include "harness/recording/recording_writer.h"
#include "harness/recording/table_sink.h"
#include "harness/rendering/renderer_failed.h"

namespace touchstone::tool {
using recording::ColumnGroup;
using recording::RecordingStream;
using recording::SampleBlock;

namespace {

RecordingStream open_path(const std::filesystem::path& path) {
  RecordingStream stream = RecordingStream::open(path);
  if (!stream.has(ColumnGroup::orientation)) {
    throw BadData(
        fmt::format("{}: no orientation: the path of a tool needs the columns qw, qx, qy and qz beside t_s, x_m, "
                    "y_m and z_m",
                    path.string()));
  }
  return stream;
}

ToolState state_of(const MotionColumns& motion, std::size_t i) {
  return {motion.t_s[i], {motion.p_W_m[i], motion.q_WS[i]}};
}

void require_working(const ToolRenderer& renderer, const ToolResult& result, const std::filesystem::path& path) {
  if (result.status == ToolStatus::failed)
    throw rendering::RendererFailed(fmt::format("{}: {}", path.string(), renderer.failure()));
}

class ContactTable {
 public:
  explicit ContactTable(const std::filesystem::path& path) {
    std::vector<recording::Column> columns;
    for (const auto& [name, unit] : tool_columns)
      columns.push_back({recording::Quantity::x, name, unit, recording::UnitScale()});
    sink_ = recording::create_table(path, columns);
  }

  void append(double t_s, std::span<const ToolContact> contacts) {
    for (const ToolContact& contact : contacts) {
      values_[0].push_back(t_s);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        values_[1 + k].push_back(contact.p_W_m[axis]);
        values_[4 + k].push_back(contact.n_W[axis]);
        values_[7 + k].push_back(contact.f_W_N[axis]);
      }
    }
    constexpr std::size_t rows = 8192;
    if (values_[0].size() > rows) write();
  }
  void commit() {
    write();
    sink_->commit();
  }

 private:
  static constexpr std::array<std::pair<const char*, const char*>, 10> tool_columns{{{"t_s", "s"},
                                                                                     {"px_m", "m"},
                                                                                     {"py_m", "m"},
                                                                                     {"pz_m", "m"},
                                                                                     {"nx", "1"},
                                                                                     {"ny", "1"},
                                                                                     {"nz", "1"},
                                                                                     {"fx_N", "N"},
                                                                                     {"fy_N", "N"},
                                                                                     {"fz_N", "N"}}};
  void write() {
    sink_->write(values_);
    for (std::vector<double>& column : values_) column.clear();
  }

  std::unique_ptr<recording::TableSink> sink_;
  std::vector<std::vector<double>> values_ = std::vector<std::vector<double>>(tool_columns.size());
};

}  // namespace

ToolReplaySummary replay_tool(ToolRenderer& renderer, const ToolReplayFiles& files) {
  if (files.keep_every < 1) throw UsageError("every 0th sample cannot be kept; give 1 or more");
  RecordingStream stream = open_path(files.path);
  recording::RecordingWriter writer(files.out, {ColumnGroup::time, ColumnGroup::position, ColumnGroup::orientation,
                                                ColumnGroup::force, ColumnGroup::torque, ColumnGroup::contact});
  std::optional<recording::TrajectoryWriter> proxy;
  if (files.proxy) proxy.emplace(*files.proxy, true);
  std::optional<ContactTable> contacts;
  if (files.contacts) contacts.emplace(*files.contacts);
  ToolReplaySummary summary;
  SampleBlock in;
  SampleBlock out;
  renderer.reset();
  while (stream.next(in)) {
    out.clear();
    for (std::size_t i = 0; i < in.size(); ++i) {
      const ToolState state = state_of(in.motion, i);
      const ToolResult result = renderer.step(state);
      require_working(renderer, result, files.path);
      summary.in_contact += result.contact ? 1U : 0U;
      summary.largest_force_N = std::max(summary.largest_force_N, result.f_W_N.norm());
      summary.largest_torque_Nm = std::max(summary.largest_torque_Nm, result.torque_W_Nm.norm());
      if (summary.samples++ % files.keep_every != 0) continue;
      out.motion.t_s.push_back(state.t_s);
      out.motion.p_W_m.push_back(state.handle.p_W_m);
      out.motion.q_WS.push_back(state.handle.q_WT);
      out.f_W_N.push_back(result.f_W_N);
      out.torque_W_Nm.push_back(result.torque_W_Nm);
      out.contact.push_back(result.contact ? 1 : 0);
      if (proxy) proxy->append(state.t_s, result.proxy.p_W_m, result.proxy.q_WT);
      if (!contacts) continue;
      contacts->append(state.t_s, result.contacts);
      summary.contacts += result.contacts.size();
    }
    if (out.size() > 0) writer.append(out);
  }
  writer.commit();
  if (proxy) proxy->commit();
  if (contacts) contacts->commit();
  return summary;
}

std::vector<double> measure_tool_steps(ToolRenderer& renderer, const std::filesystem::path& path) {
  using Clock = std::chrono::steady_clock;
  RecordingStream stream = open_path(path);
  std::vector<double> times_us;
  SampleBlock in;
  renderer.reset();
  while (stream.next(in)) {
    for (std::size_t i = 0; i < in.size(); ++i) {
      const ToolState state = state_of(in.motion, i);
      const auto began = Clock::now();
      const ToolResult result = renderer.step(state);
      times_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - began).count());
      require_working(renderer, result, path);
    }
  }
  std::ranges::sort(times_us);
  return times_us;
}

namespace {

// The value that a share of the steps does not reach.
double reached_by(const std::vector<double>& ascending, double share) {
  return ascending[std::min(ascending.size() - 1, static_cast<std::size_t>(share * double(ascending.size())))];
}

}  // namespace

std::string step_times_to_json(const std::vector<double>& ascending_us, std::optional<std::size_t> memory_bytes) {
  const nlohmann::ordered_json json{{"steps", ascending_us.size()},
                                    {"median_us", reached_by(ascending_us, 0.5)},
                                    {"p99_us", reached_by(ascending_us, 0.99)},
                                    {"p999_us", reached_by(ascending_us, 0.999)},
                                    {"max_us", ascending_us.back()},
                                    {"memory_bytes", memory_bytes ? nlohmann::json(*memory_bytes) : nlohmann::json()}};
  return json.dump(2) + "\n";
}

std::string step_times_to_text(const std::vector<double>& ascending_us) {
  return fmt::format("step: median {:.3f} us, p99 {:.3f} us, p99.9 {:.3f} us, max {:.3f} us\n",
                     reached_by(ascending_us, 0.5), reached_by(ascending_us, 0.99), reached_by(ascending_us, 0.999),
                     ascending_us.back());
}

}  // namespace touchstone::tool
