// Two recordings of the same motion: what differs is what instrument and object do not repeat. It is the floor that
// errors of a model are held against: a smaller error is chance, a larger one can be explained.
//
// The difference holds what both recordings do not repeat; a model is held against one of them. If both do so alike and
// independently, each has half of the mean square: the floor is the root mean square difference over the root of 2
// (duplicate measurements, ISO 5725-2: 1994, 7.4).
#pragma once

#include <filesystem>
#include <string>

#include "harness/recording/trajectory.h"

namespace touchstone::recording_checks {

struct RepeatFloor {
  double force_N = 0.0;   // RMS of the difference of the forces as vectors, at equal times, over the root of 2
  double within_N = 0.0;  // up to here an error is as large as the floor by chance: 95 %, by how tenths of time differ
  double position_m = 0.0;                         // RMS of the difference of the positions, over the root of 2
  double shift_s = 0.0;                            // by which the second is late; taken out
  double unshifted_N = 0.0;                        // force_N if that is not taken out
  double steadiest_N = 0.0, least_steady_N = 0.0;  // force_N of ten equal stretches of time
  double shared_s = 0.0;                           // time that both cover
  std::string source;                              // the second recording

  // "0.0761 N (again.csv; 0.178 mm in position, over 391 s; 0.05 to 0.14 N by tenths of that time; the start is 7 ms
  // late, 0.087 N without taking that out)"
  [[nodiscard]] std::string text() const;
  // "1.7 times the floor of 0.0761 N that the repeat again.csv gives", "within the floor ..."
  [[nodiscard]] std::string verdict(double error_N) const;
};

// Throws BadData where they do not repeat: the positions differ by more than a fifth of their own extent, or less than
// half of the first is covered.
RepeatFloor repeat_floor(const recording::Recording& first, const recording::Recording& second);
// The same from files of any length. The sign of the force does not matter as long as it is the same in both.
RepeatFloor repeat_floor_of_files(const std::filesystem::path& first, const std::filesystem::path& second);

}  // namespace touchstone::recording_checks
