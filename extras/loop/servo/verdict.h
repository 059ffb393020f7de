// Whether a loop is stable, buzzes or throws the hand off, from a run and the run of the same hand and device on an
// ideal servo (servo_loop.h): what the ideal run does too belongs to the renderer, what is beyond it to the loop.
//
// Judged in each stretch of at least 0.36 s in which the ideal run stays in contact, from 0.1 s after its beginning on,
// in windows of 0.128 s:
// - buzz: the vibration that the hand feels beyond the ideal run's, 20 to 1000 Hz, as far as it does not die away: it
//   is there in a window and, at nine tenths of its amplitude or more, in the next one too. The worst counts, in just
//   noticeable differences on the scale of harness/perception (vibration_scale.h), which masks it by what the ideal run
//   shakes already. What dies away is ringing.
// - unstable: the tip is thrown out of contact again and again, or leaves the workspace.
// - kick: the largest force on the hand within 64 ms of a contact's beginning, beyond the largest of the ideal run.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "harness/perception/judge/thresholds.h"
#include "servo/servo_loop.h"

namespace touchstone::servo {

enum class Verdict : std::uint8_t { stable, buzzes, unstable, cannot_tell };
std::string_view name_of(Verdict verdict);

struct Vibration {
  double frequency_Hz = 0.0;
  double amplitude_N = 0.0;  // of a sine of that frequency, with its neighbours in the spectrum
  double jnd = 0.0;          // of the whole band
  double at_s = 0.0;         // the middle of the window
};

struct Judgement {
  Verdict verdict = Verdict::cannot_tell;
  Vibration buzz;     // beyond the ideal run's, and does not die away
  Vibration ringing;  // beyond the ideal run's, whether or not it dies away
  Vibration own;      // of the ideal run, against none
  double kick_N = 0.0;
  double kick_at_s = 0.0;
  double energy_J = 0.0;       // the most that the actuator had given more than taken, since the beginning
  double judged_s = 0.0;       // of contact
  std::size_t thrown_out = 0;  // times that contact was lost and should not have been
  double limited_share = 0.0;  // of the judged time, at the force limit
  double device_felt_N = 0.0;  // root mean square on the hand in free air: what is felt of the device itself
};

Judgement judge(const LoopTrace& run, const LoopTrace& ideal, const perception::Thresholds& thresholds);

// In a sentence, for people: "Buzzes at 143 Hz with 0.21 N (9.4 JND)."
std::string sentence(const Judgement& judgement);

}  // namespace touchstone::servo
