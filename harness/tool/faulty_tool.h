// Faults planted in a renderer of a tool, so that the checks of tool_checks.h can be seen to find them.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {

enum class ToolFault : std::uint8_t {
  wrong_lever_arm,
  torque_sign,
  torque_frame,
  rotation_order,
  stale_contact,
  friction_lost,  // of renderers that have it, as the next
  friction_doubled,
};
inline constexpr std::array<std::string_view, 7> tool_fault_names{"wrong-lever-arm", "torque-sign",   "torque-frame",
                                                                  "rotation-order",  "stale-contact", "friction-lost",
                                                                  "friction-doubled"};

class FaultyTool : public ToolRenderer {
 public:
  // `center_T_m`: of mass, which the wrong lever arm takes for the origin.
  FaultyTool(std::unique_ptr<ToolRenderer> right, ToolFault fault, const Vec3& center_T_m)
      : right_(std::move(right)), fault_(fault), center_T_m_(center_T_m) {
    kept_.reserve(most_kept);
  }

 protected:
  void do_reset() override {
    right_->reset();
    kept_.clear();
  }
  ToolResult do_step(const ToolState& state, double /*dt_s*/) noexcept override {
    ToolState given = state;
    if (fault_ == ToolFault::rotation_order) given.handle.q_WT = reversed_order(state.handle.q_WT);
    ToolResult result = right_->step(given);
    if (fault_ == ToolFault::torque_sign) result.torque_W_Nm = -result.torque_W_Nm;
    if (fault_ == ToolFault::torque_frame) result.torque_W_Nm = state.handle.q_WT.conjugate() * result.torque_W_Nm;
    if (fault_ == ToolFault::wrong_lever_arm) {
      result.torque_W_Nm = wrench_about({result.f_W_N, result.torque_W_Nm}, state.handle.q_WT * center_T_m_).torque_Nm;
    }
    if (fault_ == ToolFault::stale_contact) {
      if (kept_.empty())
        kept_.assign(result.contacts.begin(), result.contacts.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                            most_kept, result.contacts.size())));
      result.contacts = kept_;
    }
    if (fault_ == ToolFault::friction_lost) add_friction(result, -1.0);
    if (fault_ == ToolFault::friction_doubled) add_friction(result, 1.0);
    return result;
  }

 private:
  static constexpr std::size_t most_kept = 512;

  // A multiple of the friction of the contacts that are listed.
  void add_friction(ToolResult& result, double times) noexcept {
    kept_.clear();
    for (ToolContact contact : result.contacts.first(std::min(most_kept, result.contacts.size()))) {
      const Vec3 more = times * (contact.f_W_N - contact.f_W_N.dot(contact.n_W) * contact.n_W);
      contact.f_W_N += more;
      result.f_W_N += more;
      result.torque_W_Nm += (contact.p_W_m - result.proxy.p_W_m).cross(more);
      kept_.push_back(contact);
    }
    result.contacts = kept_;
  }

  // The same three turns about x, y and z, in the other order.
  static Quat reversed_order(const Quat& q) {
    const Vec3 turns = q.toRotationMatrix().eulerAngles(2, 1, 0);
    using Turn = Eigen::AngleAxisd;
    return Quat(Turn(turns[2], Vec3::UnitX()) * Turn(turns[1], Vec3::UnitY()) * Turn(turns[0], Vec3::UnitZ()));
  }

  std::unique_ptr<ToolRenderer> right_;
  ToolFault fault_;
  Vec3 center_T_m_;
  std::vector<ToolContact> kept_;
};

// The subject with the fault of this name planted in each renderer that it makes. Throws UsageError for a name that is
// not known, and for a fault of friction where there is none.
inline ToolSubject with_fault(ToolSubject subject, std::string_view name) {
  const auto* const found = std::ranges::find(tool_fault_names, name);
  if (found == tool_fault_names.end())
    throw UsageError(fmt::format("--fault {}: not known; `touchstone tool list` shows what is", name));
  const auto fault = static_cast<ToolFault>(found - tool_fault_names.begin());
  if ((fault == ToolFault::friction_lost || fault == ToolFault::friction_doubled) && !(subject.mu > 0.0)) {
    throw UsageError(fmt::format("--fault {}: {} has no friction; give --parameter mu=0.3 of a renderer that has mu",
                                 name, subject.name));
  }
  subject.make = [make = std::move(subject.make), fault](const Tool& tool, const surface::TriangleMesh& object_W,
                                                         const Coupling& coupling) {
    return std::make_unique<FaultyTool>(make(tool, object_W, coupling), fault, tool.mass.center_T_m);
  };
  subject.make_in_unit = [make = std::move(subject.make_in_unit), fault](const Tool& tool,
                                                                         const surface::TriangleMesh& object_W,
                                                                         const Coupling& coupling, double unit_m) {
    return std::make_unique<FaultyTool>(make(tool, object_W, coupling, unit_m), fault, tool.mass.center_T_m);
  };
  return subject;
}

}  // namespace touchstone::tool
