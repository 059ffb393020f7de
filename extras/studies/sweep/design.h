// Which cases a sweep runs. Every case has a number that depends on nothing but the specification, so that runs can
// stop, go on and be spread over machines.
//   {"schema": "touchstone-sweep/1", "design": "grid",
//    "surfaces": {"ball": {"name": "sphere", "parameters": {"radius_m": 0.03}, "triangles": 2000}},
//    "trajectories": {"scan": {"name": "hand-scan", "offset_m": [0, 0, 0.03]}},
//    "models": {"spring": {touchstone-model/1}},
//    "vary": [{"set": "/model/parameters/stiffness_N_per_m", "values": [300, 600]},
//             {"set": "/scale", "from": 0.01, "to": 100, "count": 5, "spacing": "log"}],
//    "seeds": [1, 2, 3], "truth": true}
// Surfaces and trajectories are those of golden cases (harness/golden/golden_case.h); files are relative to the
// specification. "set" is a JSON pointer into a case: /surface/..., /trajectory/..., /model/..., /scale, /speed.
// Of tools with a shape (harness/tool) a case is a contact whose answer is known, and a renderer of tools:
//   {"schema": "touchstone-tool-sweep/1", "design": "grid",
//    "contacts": {"corner": {"case": "box-corner"}},
//    "renderers": {"voxels": {"renderer": "voxmap-pointshell", "parameters": {"voxel_m": 5e-4},
//                             "stiffness_N_per_m": 1000, "rotational_stiffness_Nm_per_rad": 2}},
//    "vary": [{"set": "/renderer/parameters/voxel_m", "values": [2.5e-4, 5e-4]},
//             {"set": "/contacts/scale", "values": [0.5, 1, 2]}]}
// "set" begins with /renderer/ or /contacts/; a contact has a "scale" (1) and, if it is a "peg", a "clearance_m".
// Designs:
//   grid             every combination; the last of surfaces, trajectories, models, vary..., seeds runs fastest
//   latin-hypercube  "cases": how many, "design_seed"; "vary" by "from" and "to" (McKay, Beckman and Conover 1979: each
//                    of the n strata of each axis once); surfaces, trajectories, models, seeds and "values" evenly
//   list             "cases": [{"surface": "ball", "trajectory": "scan", "model": "spring", "seed": 3,
//                    "set": {"/scale": 2}}, ...]; what has one choice need not be named
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::sweep {

struct SweepCase {
  std::uint64_t number = 0;
  std::string surface;  // the names in the specification; of tools: the contact's
  std::string trajectory;
  std::string model;                  // of tools: the renderer's
  std::optional<std::uint64_t> seed;  // of the trajectory
  std::vector<double> varied;         // as SweepDesign::varied()
  // {"surface", "trajectory", "model", "scale", "speed"}, of tools {"contacts", "renderer"}, with everything set: the
  // case can be run from this alone.
  std::string document;
  // The parts that cases may share, as text: equal text, equal structure.
  std::string surface_key;
  std::string trajectory_key;
};

class SweepDesign {
 public:
  // Throws BadData with the place.
  explicit SweepDesign(const std::filesystem::path& file);
  ~SweepDesign();
  SweepDesign(const SweepDesign&) = delete;
  SweepDesign& operator=(const SweepDesign&) = delete;

  [[nodiscard]] std::uint64_t size() const noexcept;
  // The case with that number, below size(). Thread-safe.
  [[nodiscard]] SweepCase at(std::uint64_t number) const;
  // The JSON pointers that vary, in order.
  [[nodiscard]] const std::vector<std::string>& varied() const noexcept;
  // "touchstone-tool-sweep/1".
  [[nodiscard]] bool of_tools() const noexcept;
  // Whether the exact answer is asked for beside the rendered one.
  [[nodiscard]] bool truth() const noexcept;
  // Canonical, for provenance; its SHA-256 names the sweep.
  [[nodiscard]] const std::string& text() const noexcept;
  [[nodiscard]] const std::filesystem::path& folder() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchstone::sweep
