// What people can just notice, channel by channel: constants with their sources. A file replaces any of them.
//
// One just noticeable difference (JND) is the difference with d' = 1: 76 % right answers in a two-alternative forced
// choice. d' grows in proportion to the difference on the scale of JNDs; that of vibration is in vibration_scale.h. The
// procedure of an experiment decides at which d' its JND stands (procedure.h); each constant names its own.
//
// File (JSON), every member optional; a name that is not one of threshold_entries() is an error:
//   {"schema": "touchstone-thresholds/1", "stiffness_fraction": 0.15,
//    "vibration_threshold": {"frequency_Hz": [20, 100, 250, 1000], "amplitude_N": [0.01, 0.003, 0.0015, 0.2]}}
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "harness/perception/filters/weber_law.h"

namespace touchstone::perception {

struct Thresholds {
  WeberLaw force = fingertip_force;
  double stiffness_fraction = 0.22;
  // How well a hand knows its depth, as standard deviation of its logarithm: what stands between the 22 % of a person
  // who cannot rely on the depth and the 7 % of one who compares forces, sqrt(ln^2 1.22 - ln^2 1.07). 0: the hand is
  // led to the same depth, or pressed to a stop.
  double depth_fraction = 0.18699;
  double direction_rad = 0.4468;
  double friction_fraction = 0.20;
  double position_m = 0.003;
  double delay_s = 0.036;
  // Of the amplitude, 10 dB above threshold, at 79 % right answers (d' = 1.16).
  double vibration_fraction = 0.20;
  double frequency_fraction = 0.2121;  // of a vibration's frequency, far above threshold
  double vibration_integration_s = 0.2;
  // The hand at the tip as mass, damper and spring: turns a threshold of displacement into one of force.
  double hand_mass_kg = 0.006;
  double hand_damping_N_s_per_m = 4.0;
  double hand_stiffness_N_per_m = 800.0;
  // A measured threshold of vibrating force (amplitude of a sine) in place of the derived one; ascending frequencies.
  std::vector<double> vibration_frequency_Hz;
  std::vector<double> vibration_amplitude_N;

  // Amplitude of the displacement sine that is just felt on the glabrous skin of the hand.
  [[nodiscard]] static double vibration_displacement_m(double frequency_Hz);
  // Amplitude of the force sine at the tip that is just felt.
  [[nodiscard]] double vibration_force_N(double frequency_Hz) const;
};

// One constant: its name in files, unit, source and place.
struct ThresholdEntry {
  std::string_view name;
  std::string_view unit;
  std::string_view source;
  std::string_view read_in;  // the text in which the number was read; empty: cited from memory, not checked
  double& (*place)(Thresholds&);
  // Of the experiment: decides at which d' its figure stands.
  std::string_view procedure = "not stated there; d' = 1 is assumed (the usual 75 % of two alternatives is 0.95)";
  bool may_be_zero = false;
};
const std::vector<ThresholdEntry>& threshold_entries();
// Source, procedure, and whether it was checked, as files say it.
std::string source_of(const ThresholdEntry& entry);
// Where the curve of vibration comes from if no file gives one.
std::string_view vibration_threshold_source();

// The defaults with what the file replaces. Throws BadData naming file and place for an unknown name, or a value that
// is not above zero (depth_fraction: below zero).
Thresholds read_thresholds(const std::filesystem::path& file);
// The same format, complete, each constant with its unit and source beside it ("sources"): read_thresholds() takes it.
std::string thresholds_to_json(const Thresholds& thresholds);

// d' of a difference of `jnd` just noticeable differences is `jnd`; share of right answers in a two-alternative forced
// choice with that d' (Macmillan and Creelman 2005, eq 7.2): Phi(d' / sqrt 2).
double forced_choice_probability(double d_prime);

}  // namespace touchstone::perception
