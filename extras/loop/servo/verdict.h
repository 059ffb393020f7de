// Whether a loop is stable, buzzes or throws the hand off, from a run and from runs of the same hand and device on an
// ideal servo (servo_loop.h): what the ideal run shakes too is the renderer's own; what it shakes besides if it reads
// positions in the encoder's steps is the encoder's; what is beyond both is the loop's.
//
// Judged in each stretch of contact of the ideal run, from 0.1 s after its beginning on, if at least 0.256 s are left,
// in windows of 0.128 s:
// - buzz: the vibration of 20 to 1000 Hz that the hand feels of the loop, as far as it does not die away: it is there
// in
//   a window and, at nine tenths of its amplitude or more, in the next one too. The worst counts, in just noticeable
//   differences on the scale of harness/perception (vibration_scale.h), which masks it by what shakes already. What
//   dies away is ringing.
// - unstable: the tip is still thrown out of contact again and again in the second half of the stretch, or leaves the
//   workspace.
// - kick: the largest force on the hand within 64 ms of the first contact since the hand last meant to be in the air,
//   beyond the largest of the ideal run. Where it meant to be says the renderer over the path itself. Later contacts of
//   the same press are bounces.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

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
  Vibration buzz;     // the loop's, and does not die away
  Vibration ringing;  // the loop's, whether or not it dies away
  Vibration encoder;  // of the encoder's steps as the hand goes over them
  Vibration own;      // of the ideal run, against none
  double kick_N = 0.0;
  double kick_at_s = 0.0;
  double kick_jnd = 0.0;       // just noticeable differences of force, from the largest of the ideal run on
  double energy_J = 0.0;       // the most that the actuator had given more than taken, since the beginning
  double judged_s = 0.0;       // of contact
  std::size_t thrown_out = 0;  // times that contact was lost and should not have been
  double limited_share = 0.0;  // of the judged time, at the force limit
  double device_felt_N = 0.0;  // root mean square on the hand in free air: what is felt of the device itself
  // Of LoopRuns; and whether the renderer is too slow: then nothing is judged.
  double real_time_factor = 0.0;
  bool too_slow = false;
};

struct LoopRuns {
  LoopTrace run, ideal;
  LoopTrace open;                 // the renderer alone over the path
  LoopTrace stepped;              // ideal but for the encoder's steps; empty if the device reads exact positions
  double real_time_factor = 0.0;  // of `run`: simulated over elapsed time, on this machine
  // A step takes more than half of a period, in a run of more than half a second: beside a device and its driver the
  // renderer cannot answer in time, and the loop that would run is another one. The ideal run, which takes 16 times as
  // long, is not made.
  bool too_slow = false;
};
// All but `stepped`.
LoopRuns run_for_judgement(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters);
// Adds it.
void run_encoder(LoopRuns& runs, rendering::Renderer& renderer, const MotionColumns& path,
                 const LoopParameters& parameters);

inline constexpr double device_settling_s = 0.1;
Judgement judge(const LoopRuns& runs, const perception::Thresholds& thresholds, double settling_s = device_settling_s);

// The largest vibration of a force in contact, wherever it is not zero for a window of 0.128 s; against none.
Vibration largest_vibration(const std::vector<Vec3>& f_W_N, double rate_Hz, const perception::Thresholds& thresholds);

// In a sentence, for people: "Buzzes at 143 Hz with 0.21 N (9.4 JND)."
std::string sentence(const Judgement& judgement);

}  // namespace touchstone::servo
