// Designs of many cases: which a specification runs. A case chooses one of each of its parts (a surface, a motion, a
// model), by name, and sets numbers in it. Every case has a number that depends on nothing but the specification, so
// that runs can stop, go on and be spread over machines.
//   {"schema": "touchstone-sweep/1", "design": "grid",
//    "surfaces": {"ball": {...}}, "trajectories": {"scan": {...}}, "models": {"spring": {...}},
//    "vary": [{"set": "/model/parameters/stiffness_N_per_m", "values": [300, 600]},
//             {"set": "/scale", "from": 0.01, "to": 100, "count": 5, "spacing": "log"}],
//    "seeds": [1, 2, 3], "truth": true}
// "set" is a JSON pointer into a case. Designs:
//   grid             every combination; the last of the parts, vary..., seeds runs fastest
//   latin-hypercube  "cases": how many, "design_seed"; "vary" by "from" and "to" (McKay, Beckman and Conover 1979: each
//                    of the n strata of each axis once); parts, seeds and "values" evenly
//   list             "cases": [{"surface": "ball", "trajectory": "scan", "model": "spring", "seed": 3,
//                    "set": {"/scale": 2}}, ...]; what has one choice need not be named
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/json_reader.h"

namespace touchstone::runs {

// What the cases of one kind of specification are made of.
struct DesignParts {
  struct Part {
    std::string name;     // of the case's key: "surface"
    std::string choices;  // of the specification's: "surfaces"
    // Reads one as a case will, so that a slip is an error of the specification, with its line, and not of every case.
    std::function<void(JsonObject, const std::filesystem::path& folder)> check;
    std::uint64_t stream = 0;  // of the random numbers that a hypercube orders it by; below 3, another for each part
  };
  std::string schema;                // "touchstone-sweep/1"
  std::vector<Part> parts;           // the last runs fastest
  std::vector<std::string> numbers;  // keys of a case beside the parts, 1 unless they are set: "scale"
  std::string seeded;                // the part that takes a "seed"; empty: none does
  bool may_ask_for_truth = false;
};

struct SweepCase {
  std::uint64_t number = 0;
  std::vector<std::string> chosen;    // the name of each part in the specification
  std::optional<std::uint64_t> seed;  // of the part that takes one
  std::vector<double> varied;         // as SweepDesign::varied()
  // The parts and numbers by their names with everything set: the case can be run from this alone.
  std::string document;
};

class SweepDesign {
 public:
  // Files of parts are relative to the specification. Throws BadData with the place.
  SweepDesign(const std::filesystem::path& file, const DesignParts& parts);
  ~SweepDesign();
  SweepDesign(const SweepDesign&) = delete;
  SweepDesign& operator=(const SweepDesign&) = delete;

  [[nodiscard]] std::uint64_t size() const noexcept;
  // The case with that number, below size(). Thread-safe.
  [[nodiscard]] SweepCase at(std::uint64_t number) const;
  // The JSON pointers that vary, in order.
  [[nodiscard]] const std::vector<std::string>& varied() const noexcept;
  // Whether the exact answer is asked for beside the rendered one.
  [[nodiscard]] bool truth() const noexcept;
  // Canonical, for provenance; its SHA-256 names the sweep.
  [[nodiscard]] const std::string& text() const noexcept;
  [[nodiscard]] const std::filesystem::path& folder() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchstone::runs
