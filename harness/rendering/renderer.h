// The renderer under test: positions in, forces out, one step per servo tick.
// reset() and step() are not virtual: they check their input and keep the contract; the do_*() functions render.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "harness/base/vec.h"

namespace touchstone::rendering {

// A parameter that a model file may set.
struct ParameterDeclaration {
  std::string name;      // carries its unit: stiffness_N_per_m
  std::string unit;      // "N/m", "1"
  double minimum = 0.0;  // inclusive
  double maximum = 0.0;  // inclusive
  double initial = 0.0;  // the default
  std::string meaning;
};

struct TipState {
  double t_s = 0.0;
  Vec3 p_W_m = Vec3::Zero();  // ball centre where the tip is a ball
  Quat q_WS = Quat::Identity();
};

enum class StepStatus : std::uint8_t {
  ok,
  refused,  // the input was not finite or time did not advance: force is zero and the state is as it was
  failed,   // the renderer broke down (a plug-in that crashed or hung): force is zero, failure() says how
};

struct StepResult {
  Vec3 f_W_N = Vec3::Zero();        // force on the probe by the object
  Vec3 contact_W_m = Vec3::Zero();  // surface contact point (god-object); the tip itself when free.
                                    // For a ball tip: the centre of the ball at the proxy
  Vec3 n_W = Vec3::Zero();          // outward unit normal of the contact; zero when free
  double depth_m = 0.0;             // penetration along the force's normal part, >= 0
  bool contact = false;
  StepStatus status = StepStatus::ok;
};

class Renderer {
 public:
  virtual ~Renderer() = default;

  // Forgets everything: the next step is the first one of a run.
  void reset() {
    have_last_ = false;
    do_reset();
  }

  // One servo tick. Allocates nothing, takes no lock, does no I/O, never throws. A tip that is not finite, or a time
  // that does not advance, is refused (see StepStatus).
  StepResult step(const TipState& tip) noexcept {
    const bool valid = tip.p_W_m.allFinite() && tip.q_WS.coeffs().allFinite() && tip.t_s - tip.t_s == 0.0 &&
                       (!have_last_ || tip.t_s > last_t_s_);
    if (!valid) {
      StepResult refused;
      refused.status = StepStatus::refused;
      return refused;
    }
    StepResult result = do_step(tip);
    have_last_ = true;
    last_t_s_ = tip.t_s;
    return result;
  }

  // Of the structures that this renderer keeps for itself beside those of the surface; 0: none worth the name. Empty:
  // not known, as of every plug-in.
  [[nodiscard]] virtual std::optional<std::size_t> memory_bytes() const noexcept { return std::nullopt; }

  // Why steps answer `failed`; empty where they do not. Makes a text: not for the servo loop.
  [[nodiscard]] std::string failure() const { return do_failure(); }

 protected:
  virtual void do_reset() = 0;
  virtual StepResult do_step(const TipState& tip) noexcept = 0;
  [[nodiscard]] virtual std::string do_failure() const { return {}; }

 private:
  bool have_last_ = false;
  double last_t_s_ = 0.0;
};

}  // namespace touchstone::rendering
