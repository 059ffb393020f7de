// A renderer of a tool with a shape: poses of the handle in, wrenches out, one step per servo tick. Frames, signs and
// the point that torques are about: pose.h.
// reset() and step() are not virtual: they check their input and keep the contract; the do_*() functions render.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "harness/tool/pose.h"

namespace touchstone::tool {

struct ToolState {
  double t_s = 0.0;
  Pose handle;
};

// One place where the tool's proxy touches the object.
struct ToolContact {
  Vec3 p_W_m = Vec3::Zero();
  Vec3 n_W = Vec3::Zero();    // unit, out of the object
  Vec3 f_W_N = Vec3::Zero();  // on the tool
};

enum class ToolStatus : std::uint8_t {
  ok,
  refused,  // not finite, not a rotation, or time did not advance: the wrench is zero and the state is as it was
  failed,   // the renderer broke down (a plug-in that crashed or hung): the wrench is zero, failure() says how
};

struct ToolResult {
  Vec3 f_W_N = Vec3::Zero();              // on the tool by the object
  Vec3 torque_W_Nm = Vec3::Zero();        // about the handle's origin
  Pose proxy;                             // the handle's pose itself when free
  std::span<const ToolContact> contacts;  // of the renderer; valid until its next step. In a fixed order
  bool contact = false;
  ToolStatus status = ToolStatus::ok;
};

class ToolRenderer {
 public:
  // Orientations whose length differs from 1 by no more than this are normalised; others are refused (as in
  // recordings).
  static constexpr double quaternion_tolerance = 1e-3;

  virtual ~ToolRenderer() = default;

  // Forgets everything: the next step is the first one of a run, and puts the proxy at the handle.
  void reset() {
    have_last_ = false;
    do_reset();
  }

  // One servo tick. Allocates nothing, takes no lock, does no I/O, never throws.
  ToolResult step(const ToolState& state) noexcept {
    const double length = state.handle.q_WT.norm();
    const bool valid = state.handle.finite() && std::abs(length - 1.0) <= quaternion_tolerance &&
                       std::isfinite(state.t_s) && (!have_last_ || state.t_s > last_t_s_);
    if (!valid) {
      ToolResult refused;
      refused.status = ToolStatus::refused;
      return refused;
    }
    const ToolState checked{state.t_s, {state.handle.p_W_m, Quat(state.handle.q_WT.coeffs() / length)}};
    ToolResult result = do_step(checked, have_last_ ? state.t_s - last_t_s_ : 0.0);
    have_last_ = true;
    last_t_s_ = state.t_s;
    return result;
  }

  // Empty: not known, as of every plug-in.
  [[nodiscard]] virtual std::optional<std::size_t> memory_bytes() const noexcept { return std::nullopt; }

  // Why steps answer `failed`; empty where they do not. Makes a text: not for the servo loop.
  [[nodiscard]] std::string failure() const { return do_failure(); }

 protected:
  virtual void do_reset() = 0;
  [[nodiscard]] virtual std::string do_failure() const { return {}; }
  // `dt_s`: since the step before, 0 at the first.
  virtual ToolResult do_step(const ToolState& state, double dt_s) noexcept = 0;

 private:
  bool have_last_ = false;
  double last_t_s_ = 0.0;
};

}  // namespace touchstone::tool
