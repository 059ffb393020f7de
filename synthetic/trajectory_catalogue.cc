#include "synthetic/trajectory_catalogue.h"

#include <fmt/format.h>

#include <numbers>

#include "harness/base/error.h"
#include "synthetic/trajectories/approach.h"
#include "synthetic/trajectories/hand_scan.h"
#include "synthetic/trajectories/presses.h"
#include "synthetic/trajectories/strokes.h"

namespace touchstone::synthetic {
namespace {

constexpr double pi = std::numbers::pi;
using Made = std::unique_ptr<Path>;

Parameter length(std::string name, double initial, std::string meaning) {
  return {std::move(name), "m", 1e-9, 1e6, initial, std::move(meaning)};
}
Parameter offset(std::string name, double initial, std::string meaning) {
  return {std::move(name), "m", -1e6, 1e6, initial, std::move(meaning)};
}
Parameter speed() { return {"speed_m_per_s", "m/s", 1e-9, 1e6, 0.05, "along the path"}; }
Parameter number(std::string name, double least, double initial, std::string meaning) {
  return {std::move(name), "1", least, 1e6, initial, std::move(meaning)};
}
Parameter time(std::string name, double initial, std::string meaning) {
  return {std::move(name), "s", 1e-6, 1e6, initial, std::move(meaning)};
}
Parameter depth(double initial = 0.001) { return offset("depth_m", initial, "below z = 0"); }

Parameter approach() {
  return {"approach_m", "m",
          0.0,          1e6,
          0.0,          "above z = 0, from where it comes straight down to the first position; 0: it starts there"};
}
Made approached(Made path, const ParameterValues& v) {
  const bool from_above = v["approach_m"] > 0.0 && v["approach_m"] > path->position_W_m(0.0).z();
  if (!from_above) return path;
  return std::make_unique<ApproachPath>(std::move(path), v["approach_m"], v["speed_m_per_s"]);
}

Made stroke(const ParameterValues& v, std::uint64_t) {
  return approached(std::make_unique<StrokePath>(Stroke{v["length_m"], v["speed_m_per_s"], v["azimuth_rad"],
                                                        v["descent_rad"], v["depth_m"], v["passes"]}),
                    v);
}
Made edge_crossing(const ParameterValues& v, std::uint64_t) {
  return approached(std::make_unique<EdgeCrossingPath>(v["length_m"], v["speed_m_per_s"], v["depth_m"],
                                                       static_cast<double>(v.count("strokes"))),
                    v);
}
Made raster(const ParameterValues& v, std::uint64_t) {
  return approached(std::make_unique<RasterPath>(v["side_m"], static_cast<double>(v.count("lines")), v["speed_m_per_s"],
                                                 v["depth_m"]),
                    v);
}
Made taps(const ParameterValues& v, std::uint64_t) {
  return std::make_unique<TapPath>(v["height_m"], v["depth_m"], v["period_s"], v["taps"]);
}
Made push(const ParameterValues& v, std::uint64_t) {
  return std::make_unique<PushPath>(v["height_m"], v["depth_m"], v["shift_m"], v["speed_m_per_s"]);
}
Made jumps(const ParameterValues& v, std::uint64_t seed) {
  return std::make_unique<JumpPath>(seed, v["side_m"], v["height_m"], v["depth_m"], v["rest_s"],
                                    static_cast<double>(v.count("jumps")));
}
Made spiral(const ParameterValues& v, std::uint64_t) {
  return approached(std::make_unique<SpiralPath>(v["radius_m"], v["turns"], v["speed_m_per_s"], v["depth_m"]), v);
}
Made hand_scan(const ParameterValues& v, std::uint64_t seed) {
  return std::make_unique<HandScanPath>(seed, v["side_m"], v["depth_m"], v["reaches"], v["reach_s"], v["tremor_m"]);
}

}  // namespace

std::span<const TrajectoryEntry> trajectory_catalogue() {
  static const std::vector<TrajectoryEntry> entries{
      {"stroke",
       "to and fro along a line through the origin at constant speed",
       {length("length_m", 0.04, "of the line"),
        speed(),
        {"azimuth_rad", "rad", -2 * pi, 2 * pi, 0.0, "of the line, from x towards y"},
        {"descent_rad", "rad", -0.5 * pi, 0.5 * pi, 0.0, "of the line below the horizontal"},
        depth(),
        number("passes", 0.01, 2, "along the line"),
        approach()},
       stroke},
      {"edge-crossing",
       "strokes through the origin, each from another angle: an edge along y is crossed under all angles",
       {length("length_m", 0.02, "of a stroke"), speed(), depth(), number("strokes", 1, 12, "through the origin"),
        approach()},
       edge_crossing},
      {"raster",
       "lines along y side by side over a square about the origin",
       {length("side_m", 0.04, "of the square"), number("lines", 2, 9, "side by side"), speed(), depth(), approach()},
       raster},
      {"taps",
       "down and up at the origin as a cosine",
       {offset("height_m", 0.003, "above z = 0 at the start"), depth(), time("period_s", 0.5, "of a tap"),
        number("taps", 0.5, 6, "periods")},
       taps},
      {"push",
       "straight down, beyond a shell's other side where deep enough, aside and up again",
       {length("height_m", 0.002, "above z = 0 at the start"),
        length("depth_m", 0.005, "below z = 0"),
        {"shift_m", "m", 0.0, 1e6, 0.0, "along x while down"},
        speed()},
       push},
      {"jumps",
       "rests at seeded places, and jumps from one sample to the next",
       {length("side_m", 0.04, "of the square about the origin"), length("height_m", 0.005, "most above z = 0"),
        length("depth_m", 0.005, "most below z = 0"), time("rest_s", 0.01, "at each place"),
        number("jumps", 2, 200, "places")},
       jumps},
      {"spiral",
       "from the origin outwards at constant speed",
       {length("radius_m", 0.02, "at the end"), number("turns", 0.1, 6, "about the origin"), speed(), depth(),
        approach()},
       spiral},
      {"hand-scan",
       "minimum-jerk reaches between seeded places with 8 to 12 Hz tremor, as of a hand",
       {length("side_m", 0.04, "of the square about the origin"),
        length("depth_m", 0.001, "mean depth of the reaches' ends"),
        number("reaches", 1, 20, "one after another"),
        time("reach_s", 0.5, "of each"),
        {"tremor_m", "m", 0.0, 1e6, 5e-5, "root mean square of each axis"}},
       hand_scan},
  };
  return entries;
}

std::unique_ptr<Path> make_path(std::string_view name, const ParameterOverrides& overrides, std::uint64_t seed) {
  std::string known;
  for (const TrajectoryEntry& entry : trajectory_catalogue()) {
    if (entry.name == name)
      return entry.make(ParameterValues("trajectory " + entry.name, entry.parameters, overrides), seed);
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  throw UsageError(fmt::format("no trajectory is called '{}'; there are: {}", name, known));
}

}  // namespace touchstone::synthetic
