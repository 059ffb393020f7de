// Samples spread evenly over a recording of any length, in bounded memory: what the gate looks at where a command
// streams.
#pragma once

#include <cstddef>
#include <filesystem>

#include "harness/recording/trajectory.h"

namespace touchstone::recording_checks {

// At most `most` samples, every n-th of the file's. `f_W_N` and `motion.q_WS` are empty where the file has none.
// Throws BadData as RecordingStream does.
recording::Recording sample_recording(const std::filesystem::path& path, std::size_t most = 16384);

// Reverses force and torque: a file that has the force BY the probe.
void flip_force(recording::Recording& recording);

}  // namespace touchstone::recording_checks
