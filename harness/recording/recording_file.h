// Whole recordings, trajectories and rendered files in memory, from and to CSV (.csv, .csv.gz) or HDF5 (.h5, .hdf5).
// Files that do not fit in memory are read with RecordingStream and written with RecordingWriter.
// Columns: see column.h. Every load throws BadData naming the file, place, value and what was expected.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/recording/clock.h"
#include "harness/recording/column.h"
#include "harness/recording/trajectory.h"

namespace touchstone::recording {

// Needs time, position and force. Repeated times are refused, gaps are kept (see ClockPolicy).
Recording load_recording(const std::filesystem::path& path);
// Needs time and position. Other columns are checked and ignored.
InTrajectory load_trajectory(const std::filesystem::path& path);
// Needs time, tip position, force, surface contact point and contact.
RenderedTrajectory load_rendered(const std::filesystem::path& path);

// A loaded file with what is known of its clock and what was done to it.
template <class T>
struct Loaded {
  T value;
  ClockReport clock;
  std::string format;                       // "CSV", "CSV, gzip", "HDF5"
  std::vector<std::string> notes;           // what was tolerated or changed, one sentence each
  std::vector<std::size_t> segment_starts;  // OnGap::split: the first sample of each segment, beginning with 0
};
Loaded<Recording> load_recording(const std::filesystem::path& path, const ClockPolicy& policy);
Loaded<InTrajectory> load_trajectory(const std::filesystem::path& path, const ClockPolicy& policy);
Loaded<RenderedTrajectory> load_rendered(const std::filesystem::path& path, const ClockPolicy& policy);

// Atomic: an existing file is replaced by the whole new one or left as it is.
void save_recording(const std::filesystem::path& path, const Recording& recording, const ColumnUnits& units = {});
void save_trajectory(const std::filesystem::path& path, const InTrajectory& trajectory, const ColumnUnits& units = {});
// Writes cost_us too where it is filled.
void save_rendered(const std::filesystem::path& path, const RenderedTrajectory& rendered,
                   const ColumnUnits& units = {});

}  // namespace touchstone::recording
