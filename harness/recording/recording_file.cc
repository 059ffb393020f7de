#include "harness/recording/recording_file.h"

#include <fmt/format.h>

#include <utility>

#include "harness/base/error.h"
#include "harness/recording/recording_stream.h"
#include "harness/recording/recording_writer.h"

namespace touchstone::recording {
namespace {

// Reads the whole file; `unused` are groups that the caller will not keep.
template <class T>
SampleBlock load_all(const std::filesystem::path& path, const StreamOptions& options,
                     const std::vector<ColumnGroup>& unused, Loaded<T>& loaded) {
  RecordingStream stream = RecordingStream::open(path, options);
  SampleBlock all;
  SampleBlock block;
  while (stream.next(block)) all.append(block);
  loaded.clock = stream.clock();
  loaded.format = stream.format();
  loaded.notes = stream.notes();
  std::string ignored;
  for (const ColumnGroup group : unused) {
    if (!stream.has(group)) continue;
    if (!ignored.empty()) ignored += ", ";
    ignored += group_members(group);
  }
  if (!ignored.empty()) loaded.notes.push_back(fmt::format("{}: columns not used: {}", path.string(), ignored));
  if (options.clock.on_gap == OnGap::split) {
    if (loaded.clock.gap_count > loaded.clock.gaps.size()) {
      throw BadData(fmt::format("{}: has {} gaps, too many to split at; is the clock right?", path.string(),
                                loaded.clock.gap_count));
    }
    loaded.segment_starts.push_back(0);
    for (const Gap& gap : loaded.clock.gaps) {
      loaded.segment_starts.push_back(static_cast<std::size_t>(gap.after_sample) + 1);
    }
  }
  return all;
}

}  // namespace

Loaded<Recording> load_recording(const std::filesystem::path& path, const ClockPolicy& policy) {
  Loaded<Recording> loaded;
  SampleBlock all = load_all(path, {.need_force = true, .clock = policy},
                             {ColumnGroup::contact_point, ColumnGroup::contact, ColumnGroup::cost}, loaded);
  loaded.value = {std::move(all.motion), std::move(all.f_W_N), std::move(all.torque_W_Nm), path.string()};
  return loaded;
}

Loaded<InTrajectory> load_trajectory(const std::filesystem::path& path, const ClockPolicy& policy) {
  Loaded<InTrajectory> loaded;
  SampleBlock all = load_all(
      path, {.clock = policy},
      {ColumnGroup::force, ColumnGroup::torque, ColumnGroup::contact_point, ColumnGroup::contact, ColumnGroup::cost},
      loaded);
  loaded.value.motion = std::move(all.motion);
  return loaded;
}

Loaded<RenderedTrajectory> load_rendered(const std::filesystem::path& path, const ClockPolicy& policy) {
  Loaded<RenderedTrajectory> loaded;
  SampleBlock all =
      load_all(path, {.need_contact = true, .clock = policy}, {ColumnGroup::orientation, ColumnGroup::torque}, loaded);
  loaded.value = {std::move(all.motion.t_s), std::move(all.motion.p_W_m), std::move(all.contact_W_m),
                  std::move(all.f_W_N),      std::move(all.contact),      std::move(all.cost_us)};
  return loaded;
}

Recording load_recording(const std::filesystem::path& path) { return load_recording(path, ClockPolicy{}).value; }
InTrajectory load_trajectory(const std::filesystem::path& path) { return load_trajectory(path, ClockPolicy{}).value; }
RenderedTrajectory load_rendered(const std::filesystem::path& path) { return load_rendered(path, ClockPolicy{}).value; }

void save_recording(const std::filesystem::path& path, const Recording& recording, const ColumnUnits& units) {
  std::vector<ColumnGroup> groups{ColumnGroup::force};
  if (!recording.motion.q_WS.empty()) groups.push_back(ColumnGroup::orientation);
  if (!recording.torque_W_Nm.empty()) groups.push_back(ColumnGroup::torque);
  SampleBlock block;
  block.motion = recording.motion;
  block.f_W_N = recording.f_W_N;
  block.torque_W_Nm = recording.torque_W_Nm;
  RecordingWriter writer(path, groups, units);
  writer.append(block);
  writer.commit();
}

void save_trajectory(const std::filesystem::path& path, const InTrajectory& trajectory, const ColumnUnits& units) {
  std::vector<ColumnGroup> groups;
  if (!trajectory.motion.q_WS.empty()) groups.push_back(ColumnGroup::orientation);
  SampleBlock block;
  block.motion = trajectory.motion;
  RecordingWriter writer(path, groups, units);
  writer.append(block);
  writer.commit();
}

void save_rendered(const std::filesystem::path& path, const RenderedTrajectory& rendered, const ColumnUnits& units) {
  std::vector<ColumnGroup> groups{ColumnGroup::force, ColumnGroup::contact_point, ColumnGroup::contact};
  if (!rendered.cost_us.empty()) groups.push_back(ColumnGroup::cost);
  SampleBlock block;
  block.motion.t_s = rendered.t_s;
  block.motion.p_W_m = rendered.tip_W_m;
  block.f_W_N = rendered.f_W_N;
  block.contact_W_m = rendered.contact_W_m;
  block.contact = rendered.contact;
  block.cost_us = rendered.cost_us;
  RecordingWriter writer(path, groups, units);
  writer.append(block);
  writer.commit();
}

}  // namespace touchstone::recording
