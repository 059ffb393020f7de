// Whether a recording has the texture that is expected of it: band by band, and by what a person would notice.
//
// Powers are compared where the tip slid alike, in cells of a third of an octave of the speed and half an octave of the
// normal force, as perceive does; each cell counts by the recording's share. A band whose vibration is below the
// threshold of feeling in both is not judged. What is noticed is perceive's d' of vibration in contact, without
// measurement noise taken out: a fingertip's thresholds, docs/explanation/perception.md.
#pragma once

#include <string>
#include <vector>

#include "harness/perception/judge/vibration.h"

namespace touchstone::texture {

struct ComparedBand {
  double centre_Hz = 0.0;
  double expected_N = 0.0;  // root mean square, all axes
  double recorded_N = 0.0;
  double threshold_N = 0.0;  // of feeling, root mean square
  bool felt = false;
  double difference_dB = 0.0;  // recorded over expected
  double interval_dB = 0.0;    // half the width of its 95 % interval
};

enum class TextureVerdict { same, different, cannot_tell };

struct TextureComparison {
  TextureVerdict verdict = TextureVerdict::cannot_tell;
  std::string reason;  // one sentence
  std::vector<ComparedBand> bands;
  perception::VibrationDifference noticed;
  std::size_t windows = 0;  // of the recording, where both slid alike
  std::size_t all_windows = 0;
  double tolerance_dB = 0.0;
};

// `same`: every band that is felt lies within the tolerance with its interval, and d' is below 1. `different`: a band
// lies outside with its interval, or d' is 1 or more beyond what noise reaches. Else it cannot be told.
TextureComparison compare_textures(const perception::FastForce& expected, const perception::FastForce& recorded,
                                   double tolerance_dB, const perception::Thresholds& thresholds);

std::string text_of(const TextureComparison& comparison);
std::string json_of(const TextureComparison& comparison, const std::string& expected, const std::string& recorded);
// Empty if the picture was written, else why not.
std::string write_picture(const TextureComparison& comparison, const std::string& png);

}  // namespace touchstone::texture
