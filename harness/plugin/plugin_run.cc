#include "harness/plugin/plugin_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "harness/rendering/renderer_failed.h"

namespace touchstone::plugin {
namespace {

// A member of the answer, for checks and messages.
struct Member {
  const char* name;
  std::span<const double> values;
};

std::array<Member, 6> members(const touchstone2_result& result) noexcept {
  return {{{"f_W_N", result.f_W_N},
           {"torque_W_Nm", result.torque_W_Nm},
           {"proxy.p_W_m", result.proxy.p_W_m},
           {"proxy.q_WB", result.proxy.q_WB},
           {"n_W", result.n_W},
           {"depth_m", {&result.depth_m, 1}}}};
}

bool finite(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

bool finite(const touchstone2_result& result) noexcept {
  const auto all = members(result);
  const std::span contacts(result.contacts, result.contact_count);
  return std::ranges::all_of(all, [](const Member& member) { return finite(member.values); }) &&
         std::ranges::all_of(contacts, [](const touchstone2_contact& contact) {
           return finite(contact.p_W_m) && finite(contact.n_W) && finite(contact.f_W_N);
         });
}

std::string first_not_finite(const touchstone2_result& result) {
  for (const Member& member : members(result)) {
    for (std::size_t i = 0; i < member.values.size(); ++i) {
      if (std::isfinite(member.values[i])) continue;
      return member.values.size() == 1 ? fmt::format("{} = {}", member.name, member.values[i])
                                       : fmt::format("{}[{}] = {}", member.name, i, member.values[i]);
    }
  }
  return "a contact with a number that is not finite";
}

}  // namespace

PluginRun::PluginRun(std::unique_ptr<PluginConnection> connection, std::string name,
                     std::shared_ptr<const PluginCreation> creation, std::size_t contact_capacity)
    : creation_(std::move(creation)),
      connection_(std::move(connection)),
      name_(std::move(name)),
      contacts_(contact_capacity) {}

void PluginRun::reset() {
  step_ = 0;
  if (state_ == State::broken) throw rendering::RendererFailed(failure());
  state_ = State::good;
  if (connection_->reset()) return;
  state_ = State::broken;
  throw rendering::RendererFailed(failure());
}

const touchstone2_result* PluginRun::step(double t_s, const touchstone2_pose& tip,
                                          std::span<const touchstone2_pose> bodies) noexcept {
  if (state_ != State::good) return nullptr;
  ++step_;
  last_input_ = {sizeof(touchstone2_input), 0, t_s, tip, bodies.data(), bodies.size()};
  last_result_ = {};
  last_result_.size = sizeof(touchstone2_result);
  last_result_.proxy = tip;
  last_result_.contacts = contacts_.data();
  last_result_.contact_capacity = contacts_.size();
  if (!connection_->step(last_input_, last_result_)) {
    state_ = State::broken;
  } else if (last_result_.contact_count > contacts_.size()) {
    state_ = State::too_many_contacts;
  } else if (!finite(last_result_)) {
    state_ = State::not_finite;
  }
  return state_ == State::good ? &last_result_ : nullptr;
}

std::string PluginRun::failure() const {
  std::string what;
  switch (state_) {
    case State::good:
      return {};
    case State::broken:
      what = connection_->failure();
      break;
    case State::not_finite:
      what = fmt::format("answered {}, which is no finite number", first_not_finite(last_result_));
      break;
    case State::too_many_contacts:
      what = fmt::format("says that it wrote {} contacts, where there is room for {}", last_result_.contact_count,
                         contacts_.size());
      break;
  }
  if (step_ == 0) return fmt::format("{} {}", name_, what);
  const double* const p = last_input_.tip.p_W_m;
  return fmt::format("{} {}, at step {} of its run: t_s = {}, p_W_m = {} {} {}", name_, what, step_, last_input_.t_s,
                     p[0], p[1], p[2]);
}

}  // namespace touchstone::plugin
