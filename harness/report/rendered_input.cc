#include "harness/report/rendered_input.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <new>
#include <nlohmann/json.hpp>

#include "harness/recording/dataset.h"
#include "harness/report/json_numbers.h"
#include "harness/report/quantity.h"

namespace touchstone::report {
using recording::InTrajectoryMode;

InputHash::InputHash() : state_(XXH3_createState()) {
  if (state_ == nullptr) throw std::bad_alloc();
  XXH3_128bits_reset(static_cast<XXH3_state_t*>(state_));
}

InputHash::~InputHash() { XXH3_freeState(static_cast<XXH3_state_t*>(state_)); }

void InputHash::add_vertex(const Vec3& p_W_m) {
  XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), p_W_m.data(), 3 * sizeof(double));
}

void InputHash::add(double t_s, const Vec3& in_W_m, const Vec3& f_measured_W_N, bool judged) {
  const std::array<double, 8> row{t_s,
                                  in_W_m.x(),
                                  in_W_m.y(),
                                  in_W_m.z(),
                                  f_measured_W_N.x(),
                                  f_measured_W_N.y(),
                                  f_measured_W_N.z(),
                                  judged ? 1.0 : 0.0};
  XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), row.data(), sizeof row);
}

std::string InputHash::text() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(static_cast<const XXH3_state_t*>(state_));
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string input_text(const RenderedInput& input) {
  std::string text;
  const auto mode = recording::find_in_trajectory(input.in_trajectory);
  if (!mode) return "not known";
  switch (*mode) {
    case InTrajectoryMode::measured:
      text = "the measured positions as they are";
      break;
    case InTrajectoryMode::whole_force:
      text = fmt::format("whole-force: p_out - F / k, the whole measured force, at {}",
                         display_setting(input.stiffness_N_per_m, "N/m"));
      break;
    case InTrajectoryMode::synthesize:
      text = fmt::format("synthesize: p_out - F_n / k, the normal force (equation 2), at {}",
                         display_setting(input.stiffness_N_per_m, "N/m"));
      break;
  }
  return text + (input.tip_radius_m > 0.0 ? fmt::format("; ball of {}", display_setting(input.tip_radius_m, "m"))
                                          : std::string("; point tip"));
}

std::string why_not_comparable(const RenderedInput& one, const RenderedInput& other) {
  if (one.hash.empty() || other.hash.empty()) return "it is not known which input the renderer was given";
  if (one.hash == other.hash) return "";
  if (input_text(one) != input_text(other)) {
    return fmt::format("different inputs: {} against {}", input_text(one), input_text(other));
  }
  if (one.contact_threshold_N != other.contact_threshold_N) {
    return fmt::format("different contact thresholds: {} against {}", display_setting(one.contact_threshold_N, "N"),
                       display_setting(other.contact_threshold_N, "N"));
  }
  return "different recordings, meshes, time ranges or registrations of the instrument";
}

nlohmann::json input_to_json(const RenderedInput& input) {
  return {{"in_trajectory", input.in_trajectory},
          {"stiffness_N_per_m", exact_number(input.stiffness_N_per_m)},
          {"tip_radius_m", exact_number(input.tip_radius_m)},
          {"contact_threshold_N", exact_number(input.contact_threshold_N)},
          {"hash", input.hash}};
}

RenderedInput input_from_json(JsonObject in) {
  RenderedInput out;
  out.in_trajectory = in.text("in_trajectory");
  out.stiffness_N_per_m = in.number("stiffness_N_per_m");
  out.tip_radius_m = in.number("tip_radius_m");
  out.contact_threshold_N = in.number("contact_threshold_N");
  out.hash = in.text("hash");
  in.finish();
  return out;
}

}  // namespace touchstone::report
