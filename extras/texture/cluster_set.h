// Recordings of the Cluster Haptic Texture Dataset (Eguchi, Hayase, Hiroi and Hiraki, arXiv 2407.16206): a machine
// slides a rubber tip over 118 surfaces at five speeds and two forces.
//
// Layout, from the set's documents/dataset_details.md (github.com/cluster-lab/Cluster-Haptic-Texture-Dataset): the
// folder sensor_data has accel/, force/ and position/, each with files TEXTURE_DIRECTION_SPEED_FORCE_REPEAT.csv: time
// (s) and X, Y, Z (g) at about 6 kHz; time and force (N); time and X, Y (mm) at 100 Hz, on one clock.
#pragma once

#include <filesystem>

#include "slide_windows.h"

namespace touchstone::texture {

// Windows of 0.256 s, one after the other, of all files of one texture, in which the tip moves at the speed that its
// file's name says to 20 %. Speed and load are the measured ones; the fast force is the acceleration times the mass, at
// 1000 samples per second, which a windowed sinc below 450 Hz gives from the samples, each by the time that it stands
// for. They are uneven, so that of what sounds in the machine above 450 Hz some remains as noise. Friction is not in
// the files and is 0. Throws BadData naming file, line or what is missing.
SlideWindows cluster_windows(const std::filesystem::path& sensor_data, int texture, double effective_mass_kg);

}  // namespace touchstone::texture
