// Which input a result was made with. Two results may be held against each other only if the renderers were given the
// same positions over the same object and are judged by the same forces; this says whether they were.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "harness/base/json_reader.h"
#include "harness/base/vec.h"

namespace touchstone::report {

struct RenderedInput {
  std::string in_trajectory;       // "synthesize", "whole-force", "measured"; "" in a result of an older program
  double stiffness_N_per_m = 0.0;  // that it was made with; 0 for "measured"
  double tip_radius_m = 0.0;       // 0: a point
  double contact_threshold_N = 0.0;
  std::string hash;  // of every time, in-position and measured force, and of the object's vertices: InputHash

  friend bool operator==(const RenderedInput&, const RenderedInput&) = default;
};

// In words, for a report: "p_out - F / k, the whole force, at 500 N/m; point tip".
std::string input_text(const RenderedInput& input);

// Why results of these two inputs must not be compared; empty if they may be: the hashes are the same.
std::string why_not_comparable(const RenderedInput& one, const RenderedInput& other);

// Takes in what a renderer is given and judged by, sample by sample. XXH3 with 128 bits.
class InputHash {
 public:
  InputHash();
  ~InputHash();
  InputHash(const InputHash&) = delete;
  InputHash& operator=(const InputHash&) = delete;

  void add_vertex(const Vec3& p_W_m);
  // `judged`: the sample lies in the time ranges that the metrics see.
  void add(double t_s, const Vec3& in_W_m, const Vec3& f_measured_W_N, bool judged);
  // 32 hexadecimal digits.
  [[nodiscard]] std::string text() const;

 private:
  void* state_;
};

// The inputs as a result file has them. Reading throws BadData with the place for what is missing or of another type.
nlohmann::json input_to_json(const RenderedInput& input);
RenderedInput input_from_json(JsonObject in);

}  // namespace touchstone::report
