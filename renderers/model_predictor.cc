#include "renderers/model_predictor.h"

#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/rendering/effect_stack.h"
#include "harness/rendering/renderer_failed.h"
#include "renderers/catalogue.h"
#include "renderers/effects/assemble.h"
#include "renderers/instrument/assemble.h"

namespace touchstone::renderers {
using rendering::InstrumentStage;
using rendering::Model;
using rendering::NamedParameters;
using rendering::Parameters;
using rendering::Prediction;
using rendering::StepResult;
using surface::Surface;

namespace {

// What the base renderer made of every sample, at one stiffness.
struct Trace {
  std::string key;
  double stiffness_N_per_m = 0.0;
  std::vector<StepResult> steps;

  static constexpr std::size_t most_bytes = 16'000'000;
  [[nodiscard]] std::size_t bytes() const { return steps.size() * sizeof(StepResult); }
};

// What a contact depends on in a model; the rest of the instrument acts on its force afterwards.
struct ContactKey {
  std::string renderer;
  const rendering::RendererEntry* provided = nullptr;
  std::map<std::string, double> parameters;
  std::vector<NamedParameters> entries;

  [[nodiscard]] bool operator==(const ContactKey& other) const {
    const auto same = [](const NamedParameters& a, const NamedParameters& b) {
      return a.name == b.name && a.law == b.law && a.parameters == b.parameters;
    };
    return renderer == other.renderer && provided == other.provided && parameters == other.parameters &&
           std::equal(entries.begin(), entries.end(), other.entries.begin(), other.entries.end(), same);
  }
};

struct Contact {
  ContactKey key;
  Prediction prediction;  // before the instrument

  static constexpr std::size_t most_bytes = 8'000'000;
  [[nodiscard]] std::size_t bytes() const { return prediction.f_W_N.size() * (2 * sizeof(Vec3) + 2 * sizeof(double)); }
};

// What predictors were asked for last; for many threads. Each predictor keeps its last item, whatever that needs; all
// others of all predictors share a number of bytes, and the one that was not asked for the longest goes first. A search
// holds some forty predictors (noise_model.h), so that a number of items for each would need as much more.
template <class Item>
class Kept {
 public:
  Kept() = default;
  ~Kept() {
    const std::lock_guard lock(shelf().mutex);
    for (const auto& place : mine_) {
      shelf().bytes -= place->bytes;
      shelf().places.erase(place);
    }
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;

  template <class Is>
  std::shared_ptr<const Item> find(const Is& is) {
    const std::lock_guard lock(shelf().mutex);
    const auto found = std::find_if(mine_.begin(), mine_.end(), [&](const auto& place) { return is(*place->item); });
    if (found == mine_.end()) return nullptr;
    shelf().places.splice(shelf().places.begin(), shelf().places, *found);
    return (*found)->item;
  }

  std::shared_ptr<const Item> keep(std::shared_ptr<const Item> item) {
    Places gone;  // freed without the lock
    const std::lock_guard lock(shelf().mutex);
    shelf().places.push_front({this, item, item->bytes()});
    mine_.push_back(shelf().places.begin());
    shelf().bytes += item->bytes();
    for (auto place = shelf().places.end(); place != shelf().places.begin() && shelf().bytes > Item::most_bytes;) {
      --place;
      auto& owned = place->owner->mine_;
      if (owned.size() == 1) continue;
      std::erase(owned, place);
      shelf().bytes -= place->bytes;
      const auto next = std::next(place);
      gone.splice(gone.begin(), shelf().places, place);
      place = next;
    }
    return item;
  }

 private:
  struct Place {
    Kept* owner;
    std::shared_ptr<const Item> item;
    std::size_t bytes;
  };
  using Places = std::list<Place>;
  struct Shelf {
    std::mutex mutex;
    Places places;  // what was asked for last comes first
    std::size_t bytes = 0;
  };
  static Shelf& shelf() {
    static Shelf all;
    return all;
  }

  std::vector<typename Places::iterator> mine_;
};

struct Instrument {
  std::vector<rendering::StagedInstrument> effects;
};

Instrument instrument_in_order(const Model& model) {
  Instrument instrument{make_instrument(model)};
  std::ranges::stable_sort(instrument.effects, {}, [](const auto& one) { return one.first; });
  return instrument;
}

struct Scaling {
  bool scales = false;
  double stiffness_N_per_m = 0.0;  // at which every trace is made, whichever model asks for it first
};

// What was tried of the catalogue's renderers on surfaces that are alive.
struct KnownScalings {
  struct One {
    std::weak_ptr<const Surface> surface;
    std::string renderer;
    Scaling scaling;
  };
  std::mutex mutex;
  std::vector<One> of;
};

KnownScalings& known_scalings() {
  static KnownScalings known;
  return known;
}

class ModelPredictor final : public rendering::Predictor {
 public:
  ModelPredictor(std::shared_ptr<const Surface> surface, MotionColumns motion)
      : surface_(std::move(surface)), motion_(std::move(motion)) {}

  Prediction predict(const Model& model) override {
    stop_if_asked();  // the searches of minutes are thousands of these
    const Instrument instrument = instrument_in_order(model);
    Prediction prediction = contact_of(model, instrument)->prediction;
    const rendering::MotionView view{motion_.t_s, motion_.p_W_m, motion_.q_WS, &accelerations_};
    for (const auto& [stage, effect] : instrument.effects) effect->apply(view, prediction.f_W_N);
    return prediction;
  }

 private:
  // A fit varies one parameter after the other, and half of them are the sensor's, which leave the contact as it is.
  std::shared_ptr<const Contact> contact_of(const Model& model, const Instrument& instrument) {
    ContactKey key{model.renderer, model.provided.get(), model.parameters, model.effects};
    for (const NamedParameters& entry : model.instrument) {
      const InstrumentStage stage = stage_of(entry);
      if (stage == InstrumentStage::pose || stage == InstrumentStage::geometry) key.entries.push_back(entry);
    }
    if (auto known = contacts_.find([&](const Contact& contact) { return contact.key == key; })) return known;
    return contacts_.keep(std::make_shared<Contact>(Contact{std::move(key), run_contact(model, instrument)}));
  }

  Prediction run_contact(const Model& model, const Instrument& instrument) {
    auto effects = make_effects(model);
    for (const auto& [stage, effect] : instrument.effects) {
      if (auto inside = effect->contact_effect())
        effects.push_back({std::move(inside), rendering::EffectPhase::depth, true});
    }
    const rendering::RendererEntry& entry = find_renderer(model);
    Model base = model;
    base.parameters = base_parameters(model, entry.parameters);
    base.effects.clear();
    base.instrument.clear();
    const Parameters parameters(entry.parameters, base.parameters, "renderer " + entry.name, model.source, "");
    const double stiffness = value_or(parameters, "stiffness_N_per_m");
    const double offset = value_or(parameters, "tip_radius_m");
    const auto trace = trace_of(base, parameters, offset, instrument, model);
    const double scale = trace->stiffness_N_per_m == stiffness ? 1.0 : stiffness / trace->stiffness_N_per_m;

    std::optional<rendering::EffectChain> chain;
    if (!effects.empty()) chain.emplace(std::move(effects), surface_, offset, stiffness);
    return play(*trace, scale, chain, instrument);
  }

  static double value_or(const Parameters& parameters, std::string_view name) {
    const auto found = parameters.values().find(name);
    return found == parameters.values().end() ? 0.0 : found->second;
  }

  // The trace with its forces scaled to another stiffness, then the effects.
  [[nodiscard]] Prediction play(const Trace& trace, double scale, std::optional<rendering::EffectChain>& effects,
                                const Instrument& instrument) const {
    Prediction prediction;
    const std::size_t n = trace.steps.size();
    prediction.f_W_N.resize(n);
    prediction.n_W.resize(n);
    prediction.depth_m.resize(n);
    prediction.normal_N.resize(n);
    if (effects) effects->reset();
    for (std::size_t i = 0; i < n; ++i) {
      StepResult step = trace.steps[i];
      step.f_W_N *= scale;
      if (effects) effects->act(true_tip(instrument, i), step);
      prediction.f_W_N[i] = step.f_W_N;
      // A free step of the trace may carry the normal of the nearest surface: only contact has one here.
      prediction.n_W[i] = step.contact ? step.n_W : Vec3(Vec3::Zero());
      prediction.depth_m[i] = step.contact ? step.depth_m : 0.0;
      prediction.normal_N[i] = step.contact ? step.f_W_N.dot(step.n_W) : 0.0;
    }
    return prediction;
  }

  std::shared_ptr<const Trace> trace_of(Model base, const Parameters& parameters, double offset,
                                        const Instrument& instrument, const Model& model) {
    const Scaling scaling = scaling_of(base);
    std::string key = base.renderer;
    for (const auto& [name, value] : parameters.values()) {
      if (name != "stiffness_N_per_m" || !scaling.scales) key += fmt::format(" {}={}", name, value);
    }
    for (const NamedParameters& entry : model.instrument) {
      if (stage_of(entry) != InstrumentStage::pose) continue;
      for (const auto& [name, value] : entry.parameters) key += fmt::format(" {}.{}={}", entry.name, name, value);
    }
    if (auto known = traces_.find([&](const Trace& trace) { return trace.key == key; })) return known;
    if (scaling.scales) base.parameters["stiffness_N_per_m"] = scaling.stiffness_N_per_m;
    auto trace = std::make_shared<Trace>();
    trace->key = key;
    trace->stiffness_N_per_m = scaling.scales ? scaling.stiffness_N_per_m : value_or(parameters, "stiffness_N_per_m");
    trace->steps = run(base, instrument, motion_.size());
    add_gaps(*trace, offset, instrument);
    return traces_.keep(std::move(trace));
  }

  [[nodiscard]] rendering::TipState true_tip(const Instrument& instrument, std::size_t i) const {
    Vec3 p_W_m = motion_.p_W_m[i];
    for (const auto& [stage, effect] : instrument.effects) p_W_m = effect->true_position(p_W_m);
    return {motion_.t_s[i], p_W_m, motion_.q_WS.empty() ? Quat::Identity() : motion_.q_WS[i]};
  }

  // Of the first `count` samples.
  [[nodiscard]] std::vector<StepResult> run(const Model& base, const Instrument& instrument, std::size_t count) {
    auto renderer = make_renderer(base, surface_);
    renderer->reset();
    std::vector<StepResult> steps;
    steps.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const rendering::TipState tip = true_tip(instrument, i);
      steps.push_back(renderer->step(tip));
      if (steps.back().status == rendering::StepStatus::failed) {
        throw rendering::RendererFailed(fmt::format("t = {} s: {}", tip.t_s, renderer->failure()));
      }
      if (steps.back().status == rendering::StepStatus::refused || !steps.back().f_W_N.allFinite()) {
        throw BadData(fmt::format("the renderer {} refused the sample at t = {} s", base.renderer, tip.t_s));
      }
    }
    const std::lock_guard lock(alive_mutex_);
    last_ = std::move(renderer);
    return steps;
  }

  // Near the surface a free step carries gap and normal, so that effects that reach beyond contact need no query.
  void add_gaps(Trace& trace, double offset, const Instrument& instrument) const {
    for (std::size_t i = 0; i < trace.steps.size(); ++i) {
      StepResult& step = trace.steps[i];
      if (step.contact) continue;
      const surface::SurfacePoint closest = surface_->closest(true_tip(instrument, i).p_W_m);
      step.n_W = closest.n_W;
      step.depth_m = offset - closest.distance_m;
    }
  }

  // Whether doubling the stiffness doubles the force and leaves the proxy where it is, tried on a part of the motion.
  // It is the renderer's nature: where the tip touched, other predictors of the surface, of which a search has some
  // forty, need not try it again.
  Scaling scaling_of(const Model& base) {
    const std::lock_guard own_lock(scaling_mutex_);
    const auto own = scaling_.find(base.renderer);
    if (own != scaling_.end()) return own->second;
    KnownScalings& known = known_scalings();
    const std::lock_guard lock(known.mutex);
    std::erase_if(known.of, [](const auto& one) { return one.surface.expired(); });
    for (const auto& one : known.of) {
      if (base.provided == nullptr && one.surface.lock() == surface_ && one.renderer == base.renderer)
        return scaling_[base.renderer] = one.scaling;
    }
    Scaling scaling;
    bool touched = false;
    const auto given = base.parameters.find("stiffness_N_per_m");
    if (given != base.parameters.end()) {
      scaling.stiffness_N_per_m = given->second;
      const std::size_t some = std::min<std::size_t>(motion_.size(), tried_samples);
      Model doubled = base;
      doubled.parameters["stiffness_N_per_m"] = 2.0 * given->second;
      const auto once = run(base, {}, some);
      const auto twice = run(doubled, {}, some);
      scaling.scales = true;
      for (std::size_t i = 0; i < some; ++i) {
        touched = touched || once[i].contact;
        const double bound = 1e-12 * once[i].f_W_N.norm();
        scaling.scales = scaling.scales && (twice[i].f_W_N - 2.0 * once[i].f_W_N).norm() <= bound;
      }
    }
    if (base.provided == nullptr && touched) known.of.push_back({surface_, base.renderer, scaling});
    return scaling_[base.renderer] = scaling;
  }

  static constexpr std::size_t tried_samples = 2000;

  std::shared_ptr<const Surface> surface_;
  MotionColumns motion_;
  rendering::AccelerationMemo accelerations_;
  Kept<Trace> traces_;
  Kept<Contact> contacts_;
  std::mutex scaling_mutex_;
  std::map<std::string, Scaling> scaling_;
  // Alive, so that what renderers share of a surface (its examined mesh) is not made anew for every geometry.
  std::mutex alive_mutex_;
  std::unique_ptr<rendering::Renderer> last_;
};

}  // namespace

std::unique_ptr<rendering::Predictor> make_model_predictor(std::shared_ptr<const Surface> surface,
                                                           MotionColumns motion) {
  return std::make_unique<ModelPredictor>(std::move(surface), std::move(motion));
}

}  // namespace touchstone::renderers
