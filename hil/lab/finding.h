// What an experiment of the lab found: numbers, the limits that they are held against, and pictures. A number that is
// not finite, or a limit on a number that is missing, never holds.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "lab/servo_loop.h"

namespace touchstone::hil {

struct Measurement {
  std::string name;  // with its unit: noise_fx_N
  double value = 0.0;
};

struct Limit {
  std::string measurement;
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

struct Curve {
  std::string name;
  std::vector<double> x, y;
  bool points = false;  // single points instead of a line
};

struct Picture {
  std::string title, x_label, y_label;  // labels with their units
  std::vector<Curve> curves;
};

struct Finding {
  std::string test;
  std::vector<Measurement> measurements = {};
  std::vector<Limit> limits = {};
  std::vector<Picture> pictures = {};
  std::vector<ServoRun> runs = {};  // the raw samples behind it

  // NaN where there is no such measurement.
  [[nodiscard]] double value(const std::string& name) const;
  // One sentence per limit that does not hold; empty where all hold. A finding without limits holds nothing.
  [[nodiscard]] std::vector<std::string> failures() const;
};

// What a device in working order keeps. A laboratory states its own device's under "limits" in the hardware map.
struct LabLimits {
  double friction_N = 0.5;         // at most, Coulomb part
  double force_error = 0.1;        // at most, of the commanded force, in steady state
  double overshoot = 0.5;          // at most, of the step
  double bandwidth_Hz = 20.0;      // at least, where the force falls to 0.71 of its steady gain
  double latency_s = 5e-3;         // at most, from command to force
  double z_width_N_per_m = 300.0;  // at least, stiffest stable wall without virtual damping
  double late_p99_s = 0.5e-3;      // at most, of a servo tick, under a real-time policy
  double golden_error = 0.1;       // at most, root mean square of the force error over that of the golden

  // By these names. Throws UsageError for an unknown one or a value that is not positive.
  void set(const std::string& name, double value);
};
LabLimits lab_limits(const std::map<std::string, double>& stated);

}  // namespace touchstone::hil
