#include "renderers/effects/formula_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <thread>
#include <utility>

namespace touchstone::renderers {
using rendering::ActsOn;
using rendering::ContactState;
using rendering::DeclaredEffect;
using rendering::DeclaredFormula;
using rendering::DeclaredState;
using rendering::EffectPhase;
using rendering::ParameterDeclaration;

FormulaLaw::FormulaLaw(DeclaredEffect effect) : effect_(std::move(effect)) {
  for (const rendering::DeclaredVariable& variable : variables_of(effect_.acts_on)) names_.emplace_back(variable.name);
  const std::size_t first_parameter = names_.size();
  for (const ParameterDeclaration& parameter : effect_.parameters) names_.push_back(parameter.name);
  for (const DeclaredState& state : effect_.states) names_.push_back(state.name);
  values_.resize(names_.size());
  // From here on no value moves.
  parameters_ = values_.data() + first_parameter;
  std::vector<rendering::FormulaVariable> variables;
  for (std::size_t i = 0; i < names_.size(); ++i) variables.push_back({names_[i], &values_[i]});
  for (const DeclaredState& state : effect_.states)
    states_.push_back(
        {state.start, rendering::Formula(state.rate, variables, effect_.name), slot(state.name), 0.0, 0.0});
  for (const DeclaredFormula& formula : effect_.formulas)
    outputs_.push_back({formula.output, rendering::Formula(formula.text, variables, effect_.name)});
}

void FormulaLaw::set(std::span<const double> values) noexcept {
  std::copy_n(values.begin(), effect_.parameters.size(), parameters_);
  reset();
}

bool FormulaLaw::is_of(const DeclaredEffect& effect) const noexcept {
  const auto same_name = [](const ParameterDeclaration& a, const ParameterDeclaration& b) { return a.name == b.name; };
  const auto same_state = [](const DeclaredState& a, const DeclaredState& b) {
    return a.name == b.name && a.start == b.start && a.rate == b.rate;
  };
  const auto same_formula = [](const DeclaredFormula& a, const DeclaredFormula& b) {
    return a.output == b.output && a.text == b.text;
  };
  return effect_.acts_on == effect.acts_on && std::ranges::equal(effect_.formulas, effect.formulas, same_formula) &&
         std::ranges::equal(effect_.states, effect.states, same_state) &&
         std::ranges::equal(effect_.parameters, effect.parameters, same_name);
}

double* FormulaLaw::slot(std::string_view variable) {
  const auto found = std::find(names_.begin(), names_.end(), variable);
  if (found == names_.end()) throw std::logic_error(fmt::format("no variable {} in a declared effect", variable));
  return &values_[static_cast<std::size_t>(found - names_.begin())];
}

void FormulaLaw::reset() noexcept {
  for (State& state : states_) *state.value = state.start;
}

void FormulaLaw::advance(double dt_s) noexcept {
  if (!(dt_s > 0.0)) return;
  constexpr double relative = 1e-6;  // of the state and of what it would change by: neither rounding nor curvature
  for (State& state : states_) {
    const double here = *state.value;
    state.rate_now = state.rate.value();
    state.slope_now = 0.0;
    const double step = relative * (std::abs(here) + dt_s * std::abs(state.rate_now));
    if (!(step > 0.0)) continue;
    *state.value = here + step;
    state.slope_now = (state.rate.value() - state.rate_now) / step;
    *state.value = here;
  }
  for (State& state : states_) {
    // A state that grows by itself is not damped: only what decays needs the implicit step.
    const double decay = std::max(-state.slope_now, 0.0);
    *state.value += dt_s * state.rate_now / (1.0 + dt_s * decay);
  }
}

bool FormulaLaw::has(std::string_view output) const noexcept {
  return std::any_of(outputs_.begin(), outputs_.end(), [&](const Output& one) { return one.name == output; });
}

double FormulaLaw::value(std::string_view output) const noexcept {
  for (const Output& one : outputs_) {
    if (one.name == output) return one.formula.value();
  }
  return 0.0;
}

namespace {

constexpr std::size_t kept_laws = 16;  // a search tries some ten terms of a law in turn

}  // namespace

// Of each thread: none waits for another. The law that was used last is at the end.
struct ReadyLaw::Idle {
  std::thread::id owner = std::this_thread::get_id();
  std::vector<std::unique_ptr<FormulaLaw>> laws;
  Idle() { laws.reserve(kept_laws); }
};

ReadyLaw::ReadyLaw(const DeclaredEffect& effect, std::span<const double> values) {
  static thread_local const auto of_thread = std::make_shared<Idle>();
  idle_ = of_thread;
  auto& laws = of_thread->laws;
  const auto found = std::find_if(laws.rbegin(), laws.rend(), [&](const auto& law) { return law->is_of(effect); });
  if (found == laws.rend()) {
    law_ = std::make_unique<FormulaLaw>(effect);
  } else {
    law_ = std::move(*found);
    laws.erase(std::next(found).base());
  }
  law_->set(values);
}

ReadyLaw::~ReadyLaw() {
  // A renderer may outlive its thread, or end in another.
  const auto idle = idle_.lock();
  if (idle == nullptr || idle->owner != std::this_thread::get_id()) return;
  if (idle->laws.size() == kept_laws) idle->laws.erase(idle->laws.begin());
  idle->laws.push_back(std::move(law_));
}

namespace {

class FormulaEffect final : public rendering::Effect {
 public:
  FormulaEffect(const DeclaredEffect& effect, std::span<const double> values)
      : acts_on_(effect.acts_on), law_(effect, values), along_(law_->has("along_N")) {}

  void reset() noexcept override {
    law_->reset();
    touching_ = false;
  }

  void apply(ContactState& contact) noexcept override {
    // The surface that a depth is added to is near the one that is touched: across the gap, too, it has a normal.
    const bool acts = acts_on_ == ActsOn::depth ? !contact.n_W.isZero() : contact.contact;
    if (!acts) {
      touching_ = false;
      return;
    }
    if (!touching_) law_->reset();
    const Vec3 v_W = contact.dt_s > 0.0 ? Vec3(contact.tip_step_W_m / contact.dt_s) : Vec3(Vec3::Zero());
    const Vec3 along_W = v_W - contact.n_W.dot(v_W) * contact.n_W;
    fill(contact, v_W, along_W.norm());
    if (touching_) law_->advance(contact.dt_s);
    touching_ = true;
    act(contact, along_W);
  }

 private:
  void fill(const ContactState& contact, const Vec3& v_W, double speed) noexcept {
    *t_ = contact.t_s;
    for (int axis = 0; axis < 3; ++axis) {
      *p_[static_cast<std::size_t>(axis)] = contact.tip_W_m[axis];
      *v_[static_cast<std::size_t>(axis)] = v_W[axis];
      *n_[static_cast<std::size_t>(axis)] = contact.n_W[axis];
    }
    *depth_ = contact.depth_m;
    *depth_rate_ = contact.depth_rate_m_per_s;
    *speed_ = speed;
    *normal_ = contact.normal_force_N;
    *stiffness_ = contact.stiffness_N_per_m;
  }

  void act(ContactState& contact, const Vec3& along_W) noexcept {
    switch (acts_on_) {
      case ActsOn::depth:
        contact.depth_m += law_->value("depth_m");
        return;
      case ActsOn::stiffness:
        contact.normal_force_N *= law_->value("factor");
        return;
      case ActsOn::normal_force:
        contact.normal_force_N += law_->value("normal_N");
        return;
      case ActsOn::friction:
        act_along(contact, along_W);
        return;
      case ActsOn::tool:
      case ActsOn::sensor:
        return;  // instrument entries
    }
  }

  void act_along(ContactState& contact, const Vec3& along_W) noexcept {
    const double speed = along_W.norm();
    if (along_ && speed > 0.0) contact.tangential_W_N += law_->value("along_N") / speed * along_W;
    const Vec3 f_W_N(law_->value("x_N"), law_->value("y_N"), law_->value("z_N"));
    contact.tangential_W_N += f_W_N - contact.n_W.dot(f_W_N) * contact.n_W;
  }

  ActsOn acts_on_;
  ReadyLaw law_;
  bool along_;
  bool touching_ = false;
  double* t_ = law_->slot("t_s");
  std::array<double*, 3> p_{law_->slot("x_m"), law_->slot("y_m"), law_->slot("z_m")};
  std::array<double*, 3> v_{law_->slot("vx_m_per_s"), law_->slot("vy_m_per_s"), law_->slot("vz_m_per_s")};
  std::array<double*, 3> n_{law_->slot("nx"), law_->slot("ny"), law_->slot("nz")};
  double* depth_ = law_->slot("depth_m");
  double* depth_rate_ = law_->slot("depth_rate_m_per_s");
  double* speed_ = law_->slot("speed_m_per_s");
  double* normal_ = law_->slot("normal_N");
  double* stiffness_ = law_->slot("stiffness_N_per_m");
};

EffectPhase phase_of(ActsOn acts_on) {
  switch (acts_on) {
    case ActsOn::depth:
      return EffectPhase::depth;
    case ActsOn::stiffness:
      return EffectPhase::stiffness;
    case ActsOn::normal_force:
      return EffectPhase::normal_force;
    case ActsOn::friction:
    case ActsOn::tool:
    case ActsOn::sensor:
      break;
  }
  return EffectPhase::friction;
}

}  // namespace

rendering::StackedEffect make_formula_effect(const DeclaredEffect& effect, std::span<const double> values) {
  return {std::make_unique<FormulaEffect>(effect, values), phase_of(effect.acts_on), effect.acts_on == ActsOn::depth};
}

}  // namespace touchstone::renderers
