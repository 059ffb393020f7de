// What a hand does in a scan, as a function of time: where it goes, when it touches, how hard it presses. Legs follow
// one another; in each the target moves to its next place by minimum jerk (Flash and Hogan 1985).
#pragma once

#include <cstdint>
#include <vector>

#include "synthetic/trajectories/tremor.h"

namespace touchstone::datasets {

enum class Touch : std::uint8_t {
  free,   // off the surface
  tap,    // one press at one place
  slide,  // in contact and moving; neighbouring slides keep contact
};

struct Leg {
  Touch touch;
  double duration_s;
  Vec3 target;  // at the leg's end; what it means is the guide's (x and y, a direction, a point)
};

struct HandModel {
  double hover_m = 0.008;            // the largest gap between contacts
  double pressing_N = 1.9;           // median normal force of a slide
  double pressing_variation = 0.15;  // root mean square, relative, below 0.6 Hz
  double tap_N = 2.5;                // the peak of a tap
  double tremor = 5e-5;              // root mean square of each axis, in the unit of the target
  double force_tremor = 0.03;        // root mean square of the normal force's, relative
  double ramp_s = 0.35;              // over which a slide's force grows and fades
};

class ScanScript {
 public:
  // Starts at `start`, free. Throws UsageError unless the first and last leg are free and every duration is positive.
  ScanScript(const Vec3& start, std::vector<Leg> legs, HandModel hand, std::uint64_t seed);

  [[nodiscard]] Vec3 target(double t_s) const;
  struct Press {
    double gap_m;           // 0 in contact
    double normal_force_N;  // > 0 in contact, 0 off the surface
  };
  [[nodiscard]] Press press(double t_s) const;
  [[nodiscard]] double duration_s() const noexcept { return starts_s_.back(); }

  // Spans of contact, for tests and for captions.
  struct Window {
    double from_s, to_s;
    Touch touch;
  };
  [[nodiscard]] const std::vector<Window>& windows() const noexcept { return windows_; }

 private:
  struct Within {
    const Window* window;
    double in_s;  // since its beginning
    double ramp;  // 0 at both ends, 1 inside
  };
  [[nodiscard]] Within within(double t_s) const;

  std::vector<Vec3> places_;      // one more than legs
  std::vector<Vec3> velocities_;  // at the places: not zero where one slide goes over into the next
  std::vector<double> starts_s_;  // one more than legs
  std::vector<Window> windows_;   // free ones too, neighbours of one kind joined
  HandModel hand_;
  synthetic::Tremor tremor_;
  synthetic::Tremor slow_force_;
  synthetic::Tremor fast_force_;
};

}  // namespace touchstone::datasets
