#include "harness/discrepancy/law_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace touchstone::discrepancy {
using rendering::ActsOn;

namespace {

// So far beyond its scale no term goes.
constexpr double widest = 1e4;
// A constant that decides the shape may leave the range of its starts by this factor.
constexpr double beyond_starts = 20.0;

class Term {
 public:
  Term(std::string name, ActsOn acts_on, std::string summary, std::initializer_list<Carrier> carriers) {
    term_.effect.name = "empirical-" + std::move(name);
    term_.effect.acts_on = acts_on;
    term_.effect.summary = std::move(summary);
    term_.effect.source = "found in a recording; no physics";
    term_.effect.empirical = true;
    term_.carriers = carriers;
    term_.constants = {{}};
  }

  // The force is proportional to it; `scale` makes a force as large as the recording's.
  Term& linear(const std::string& name, const std::string& unit, double scale) {
    declare({name, unit, -widest * scale, widest * scale, scale, "size"}, {scale});
    term_.linear.push_back(name);
    return *this;
  }
  // Above zero, from each of these starts.
  Term& constant(const std::string& name, const std::string& unit, const std::vector<double>& starts,
                 const std::string& meaning) {
    const auto [low, high] = std::minmax_element(starts.begin(), starts.end());
    const double lower = *low / beyond_starts;
    declare({name, unit, lower, std::max(*high * beyond_starts, 1.1e3 * lower), starts.front(), meaning}, starts);
    cross(name, starts);
    return *this;
  }
  // Constants of either sign that go together: each of the starts has a value for every name.
  Term& together(const std::vector<std::string>& names, const std::vector<std::string>& units,
                 const std::vector<double>& most, const std::vector<std::vector<double>>& starts,
                 const std::string& meaning) {
    std::vector<std::map<std::string, double>> all;
    for (const auto& known : term_.constants) {
      for (const auto& start : starts) {
        all.push_back(known);
        for (std::size_t i = 0; i < names.size(); ++i) all.back()[names[i]] = start[i];
      }
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double first = starts.front()[i];
      declare({names[i], units[i], -most[i], most[i], first, meaning}, {first});
    }
    term_.constants = std::move(all);
    return *this;
  }
  Term& state(const std::string& name, const std::string& unit, const std::string& rate) {
    term_.effect.states.push_back({name, unit, 0.0, rate});
    return *this;
  }
  Term& formula(const std::string& output, const std::string& text) {
    term_.effect.formulas.push_back({output, text});
    return *this;
  }
  // Read back as a user's file would be: units checked, parameters sorted.
  [[nodiscard]] LawTerm read() && {
    term_.effect = rendering::parse_effect(effect_to_json(term_.effect), term_.effect.name);
    return std::move(term_);
  }

 private:
  void declare(rendering::ParameterDeclaration parameter, std::vector<double> starts) {
    term_.effect.parameters.push_back(std::move(parameter));
    term_.effect.starts.push_back(std::move(starts));
  }
  void cross(const std::string& name, const std::vector<double>& starts) {
    std::vector<std::map<std::string, double>> all;
    for (const auto& known : term_.constants) {
      for (const double start : starts) {
        all.push_back(known);
        all.back()[name] = start;
      }
    }
    term_.constants = std::move(all);
  }

  LawTerm term_;
};

std::vector<double> times(double scale, std::initializer_list<double> shares) {
  std::vector<double> all;
  for (const double share : shares) all.push_back(scale * share);
  return all;
}

constexpr std::array<const char*, 3> axes{"x", "y", "z"};

// Directions that are not each other's opposites: the axes, the diagonals of the faces and of the cube, of both signs.
std::vector<Vec3> directions() {
  std::vector<Vec3> all;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) all.push_back(Vec3(x, y, z).normalized());
      }
    }
  }
  return all;
}

class Library {
 public:
  Library(const ViewScales& scales, const WavePeaks& waves) : s_(scales), waves_(waves) {}

  std::vector<LawTerm> all() {
    if (s_.depth_m > 0.0 && s_.load_N > 0.0) along_the_normal();
    if (s_.speed_m_per_s > 0.0 && s_.load_N > 0.0 && s_.extent_m > 0.0) along_the_surface();
    on_the_tool();
    on_the_sensor();
    return std::move(terms_);
  }

 private:
  void add(Term& term) { terms_.push_back(std::move(term).read()); }

  void along_the_normal() {
    const double D = s_.depth_m;
    const double F = s_.load_N;
    add(Term("layer", ActsOn::normal_force, "a stiffness of its own beyond a depth", {Carrier::depth})
            .linear("k", "N/m", F / D)
            .constant("from", "m", times(D, {0.2, 0.35, 0.5, 0.65, 0.8}), "depth from which it acts")
            .formula("normal_N", "k * max(0, depth_m - from)"));
    add(Term("depth-powers", ActsOn::normal_force, "square and cube of the depth", {Carrier::depth})
            .linear("c2", "N/m^2", F / (D * D))
            .linear("c3", "N/m^3", F / (D * D * D))
            .formula("normal_N", "c2 * depth_m^2 + c3 * depth_m^3"));
    add(Term("first-touch", ActsOn::normal_force, "a force that is there within a short depth", {Carrier::depth})
            .linear("force", "N", F)
            .constant("over", "m", times(D, {0.03, 0.1, 0.3}), "depth over which it rises")
            .formula("normal_N", "force * (1 - exp(-depth_m / over))"));
    add(Term("softening", ActsOn::normal_force, "a share of the load that comes or goes over time", {Carrier::time})
            .linear("share", "1", 1.0)
            .constant("over", "s", times(s_.duration_s, {0.05, 0.1, 0.2, 0.4, 0.8}), "time constant")
            .formula("normal_N", "share * normal_N * (1 - exp(-t_s / over))"));
    // Of the depth, and of the load: a spring that gives way where the motion turns back.
    for (const bool load : {false, true}) {
      add(Term(load ? "load-hysteresis" : "depth-hysteresis", ActsOn::normal_force,
               "a force that differs between pressing and leaving", {Carrier::past, Carrier::depth})
              .linear("size", load ? "1" : "N", load ? 1.0 : F)
              .constant("over", "m", times(D, {0.02, 0.05, 0.1, 0.2, 0.4}), "depth over which it turns")
              .state("z", "m", "depth_rate_m_per_s - abs(depth_rate_m_per_s) * z / over")
              .formula("normal_N", load ? "size * normal_N * z / over" : "size * z / over"));
    }
    add(Term("leaning", ActsOn::normal_force, "a share of the load that goes with the surface's slope",
             {Carrier::surface})
            .linear("h1", "1", 1.0)
            .linear("h2", "1", 1.0)
            .linear("h3", "1", 1.0)
            .linear("h4", "1", 1.0)
            .linear("h5", "1", 1.0)
            .formula("normal_N", "normal_N * (h1 * nx + h2 * ny + h3 * nx^2 + h4 * nx * ny + h5 * ny^2)"));
    // Of a tool along z that bends: on a slope s the load N displaces the tip by c N s downhill, and a spring k there
    // presses with N = k (d - c N s^2), so that N / (k d) = 1 / (1 + c k s^2).
    add(Term("bend", ActsOn::normal_force, "a share of the load that is lost with the square of the slope",
             {Carrier::surface})
            .linear("c", "1", 1.0)
            .formula("normal_N", "-normal_N * c * (nx^2 + ny^2) / (1 + abs(c) * (nx^2 + ny^2))"));
    // A tip that lags behind the tracked place within its play presses where it stands.
    Term play("play", ActsOn::normal_force, "play between what is tracked and what presses, along the object's axes",
              {Carrier::past, Carrier::surface});
    for (const char* axis : axes) play.linear(fmt::format("p{}", axis), "m", 0.3 * D);
    play.constant("over", "m", times(D, {0.05, 0.15, 0.4}), "way over which it turns");
    std::string sum;
    for (const char* axis : axes) {
      play.state(fmt::format("z{}", axis), "m", fmt::format("v{0}_m_per_s - abs(v{0}_m_per_s) * z{0} / over", axis));
      sum += fmt::format("{0}p{1} * n{1} * z{1} / over", sum.empty() ? "" : " + ", axis);
    }
    add(play.formula("normal_N", "stiffness_N_per_m * (" + sum + ")"));
    if (!(s_.speed_m_per_s > 0.0)) return;
    add(Term("lift", ActsOn::normal_force, "a share of the load that goes with sliding speed", {Carrier::speed})
            .linear("share", "1", 1.0)
            .constant("over", "m/s", times(s_.speed_m_per_s, {0.3, 1.0, 3.0}), "speed over which it rises")
            .formula("normal_N", "share * normal_N * speed_m_per_s / (speed_m_per_s + over)"));
  }

  void along_the_surface() {
    const double D = s_.depth_m;
    const double F = s_.load_N;
    const double V = s_.speed_m_per_s;
    add(Term("drag-powers", ActsOn::friction, "a drag that grows faster than the speed", {Carrier::speed})
            .linear("c2", "N s^2/m^2", F / (V * V))
            .linear("c3", "N s^3/m^3", F / (V * V * V))
            .formula("along_N", "-(c2 * speed_m_per_s^2 + c3 * speed_m_per_s^3)"));
    if (D > 0.0) {
      add(Term("ploughing", ActsOn::friction, "a pull against the way that follows the depth",
               {Carrier::depth, Carrier::past})
              .linear("c0", "N", F)
              .linear("c2", "N/m^2", F / (D * D))
              .constant("over", "m/s", times(V, {0.05, 0.2}), "speed over which it sets in")
              .formula("along_N", "-(c0 + c2 * depth_m^2) * tanh(speed_m_per_s / over)"));
    }
    for (const bool load : {false, true}) {
      Term bristle(load ? "load-bristle" : "bristle", ActsOn::friction,
                   "a pull back to where the motion turned, that gives way beyond a path", {Carrier::past});
      bristle.linear("size", load ? "1" : "N", load ? 1.0 : F)
          .constant("over", "m", times(s_.extent_m, {0.005, 0.02, 0.05, 0.1, 0.2, 0.4}),
                    "path over which it gives way");
      for (const char* axis : axes) {
        bristle.state(fmt::format("z{}", axis), "m", fmt::format("v{0}_m_per_s - speed_m_per_s * z{0} / over", axis));
        bristle.formula(fmt::format("{}_N", axis),
                        fmt::format("-size * {}z{} / over", load ? "normal_N * " : "", axis));
      }
      add(bristle);
    }
  }

  // On the tool, touching or not.
  void on_the_tool() {
    const double F = s_.load_N > 0.0 ? s_.load_N : 1.0;
    const double V = s_.speed_m_per_s;
    if (V > 0.0) {
      Term drag("drag", ActsOn::tool, "a drag on the tool, touching or not", {Carrier::speed});
      Term quick("quick-drag", ActsOn::tool, "a drag on the tool with the square of its speed", {Carrier::speed});
      Term dry("dry-drag", ActsOn::tool, "a constant force against the tool's way, touching or not",
               {Carrier::speed, Carrier::past});
      drag.linear("c", "N s/m", F / V);
      quick.linear("c", "N s^2/m^2", F / (V * V));
      dry.linear("force", "N", F).constant("over", "m/s", times(V, {0.05, 0.2, 0.6}), "speed over which it sets in");
      const std::string square = "vx_m_per_s^2 + vy_m_per_s^2 + vz_m_per_s^2";
      for (const char* axis : axes) {
        drag.formula(fmt::format("{}_N", axis), fmt::format("-c * v{}_m_per_s", axis));
        quick.formula(fmt::format("{}_N", axis), fmt::format("-c * sqrt({}) * v{}_m_per_s", square, axis));
        dry.formula(fmt::format("{}_N", axis), fmt::format("-force * v{}_m_per_s / sqrt({} + over^2)", axis, square));
      }
      add(drag);
      add(quick);
      add(dry);
    }
    if (!(s_.extent_m > 0.0)) return;
    const double L = s_.extent_m;
    Term pull("pull", ActsOn::tool, "a pull towards a place", {Carrier::place});
    pull.linear("k", "N/m", F / L);
    for (const char* axis : axes) pull.linear(fmt::format("f{}", axis), "N", F);
    Term gradient("gradient", ActsOn::tool, "a force that changes evenly over the place", {Carrier::place});
    for (const char* axis : axes) {
      pull.formula(fmt::format("{}_N", axis), fmt::format("f{0} - k * {0}_m", axis));
      std::string sum;
      for (const char* along : axes) {
        gradient.linear(fmt::format("g{}{}", axis, along), "N/m", F / L);
        sum += fmt::format("{0}g{1}{2} * {2}_m", sum.empty() ? "" : " + ", axis, along);
      }
      gradient.linear(fmt::format("f{}", axis), "N", F);
      gradient.formula(fmt::format("{}_N", axis), fmt::format("f{} + {}", axis, sum));
    }
    add(pull);
    add(gradient);
    taut(F);
    cogging(F);
  }

  // A cable that is slack on one side of a plane.
  void taut(double F) {
    const double L = s_.extent_m;
    std::vector<std::vector<double>> planes;
    for (const Vec3& direction : directions()) {
      for (const double share : {-0.2, 0.0, 0.2}) {
        planes.push_back({direction.x(), direction.y(), direction.z(), direction.dot(s_.middle_W_m) + share * L});
      }
    }
    Term taut("taut", ActsOn::tool, "a pull that sets in beyond a plane", {Carrier::place});
    taut.together({"ux", "uy", "uz", "from"}, {"1", "1", "1", "m"}, {2.0, 2.0, 2.0, 10.0 * L + s_.middle_W_m.norm()},
                  planes, "the plane's normal and its distance from the object's origin");
    for (const char* axis : axes) {
      taut.linear(fmt::format("k{}", axis), "N/m", F / L);
      taut.formula(fmt::format("{}_N", axis), fmt::format("k{} * max(0, ux * x_m + uy * y_m + uz * z_m - from)", axis));
    }
    add(taut);
  }

  // A force that repeats over a length, as of a motor's poles or a thread.
  void cogging(double F) {
    if (waves_.wave_per_m.empty()) return;
    std::vector<std::vector<double>> starts;
    double most = 0.0;
    for (const Vec3& wave : waves_.wave_per_m) {
      starts.push_back({wave.x(), wave.y(), wave.z()});
      most = std::max(most, 2.0 * wave.norm());
    }
    Term term("cogging", ActsOn::tool, "a force that repeats over a length", {Carrier::place});
    term.together({"wx", "wy", "wz"}, {"1/m", "1/m", "1/m"}, {most, most, most}, starts,
                  "waves per metre along the object's axes");
    for (const char* axis : axes) {
      term.linear(fmt::format("s{}", axis), "N", F).linear(fmt::format("c{}", axis), "N", F);
      term.formula(fmt::format("{}_N", axis),
                   fmt::format("s{0} * sin(2 * pi * (wx * x_m + wy * y_m + wz * z_m)) + c{0} * cos(2 * pi * (wx * x_m "
                               "+ wy * y_m + wz * z_m))",
                               axis));
    }
    add(term);
  }

  void on_the_sensor() {
    const double F = s_.load_N > 0.0 ? s_.load_N : 1.0;
    if (!(s_.duration_s > 0.0)) return;
    Term drift("drift", ActsOn::sensor, "a reading that creeps towards another zero", {Carrier::time});
    drift.constant("over", "s", times(s_.duration_s, {0.05, 0.1, 0.2, 0.4, 0.8}), "time constant");
    for (const char* axis : axes) {
      drift.linear(fmt::format("f{}", axis), "N", F).linear(fmt::format("g{}", axis), "N", F);
      drift.formula(fmt::format("{}_N", axis), fmt::format("f{0} + g{0} * (1 - exp(-t_s / over))", axis));
    }
    add(drift);
    if (waves_.frequency_Hz.empty()) return;
    Term line("line", ActsOn::sensor, "a reading that swings at one frequency", {Carrier::time});
    line.constant("frequency", "Hz", waves_.frequency_Hz, "frequency");
    for (const char* axis : axes) {
      line.linear(fmt::format("s{}", axis), "N", F).linear(fmt::format("c{}", axis), "N", F);
      line.formula(fmt::format("{}_N", axis),
                   fmt::format("s{0} * sin(2 * pi * frequency * t_s) + c{0} * cos(2 * pi * frequency * t_s)", axis));
    }
    add(line);
  }

  const ViewScales& s_;
  const WavePeaks& waves_;
  std::vector<LawTerm> terms_;
};

}  // namespace

std::string to_string(Carrier carrier) {
  switch (carrier) {
    case Carrier::time:
      return "time";
    case Carrier::place:
      return "place";
    case Carrier::depth:
      return "depth";
    case Carrier::speed:
      return "speed";
    case Carrier::load:
      return "load";
    case Carrier::surface:
      return "slope of the surface";
    case Carrier::past:
      break;
  }
  return "past of the motion";
}

std::vector<LawTerm> law_terms(const ViewScales& scales, const WavePeaks& waves) {
  return Library(scales, waves).all();
}

}  // namespace touchstone::discrepancy
