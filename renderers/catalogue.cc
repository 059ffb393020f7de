#include "renderers/catalogue.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/base/known_names.h"
#include "harness/rendering/measured_renderer.h"
#include "harness/rendering/moving_object.h"
#include "harness/rendering/named_declaration.h"
#include "harness/rendering/predictor.h"
#include "harness/rendering/scene.h"
#include "harness/surface/embree_surface.h"
#include "renderers/devices/haptic_device.h"
#include "renderers/effects/assemble.h"
#include "renderers/effects/catalogue.h"
#include "renderers/effects/friction.h"
#include "renderers/field/implicit.h"
#include "renderers/instrument/catalogue.h"
#include "renderers/measured.h"
#include "renderers/model_predictor.h"
#include "renderers/proxy/force_shading.h"
#include "renderers/proxy/friction_cone.h"
#include "renderers/proxy/god_object.h"
#include "renderers/spring/penalty.h"
#include "renderers/spring/spring.h"
#include "renderers/voxel/voxel.h"

namespace touchstone::renderers {
using rendering::CountedRenderer;
using rendering::Model;
using rendering::NamedDeclaration;
using rendering::Parameters;
using rendering::Renderer;
using rendering::RendererEntry;
using surface::Surface;

namespace {

double value_or(const Parameters& parameters, std::string_view name, double fallback) {
  const auto found = parameters.values().find(name);
  return found == parameters.values().end() ? fallback : found->second;
}

}  // namespace

const std::vector<RendererEntry>& renderer_catalogue() {
  // One to a line, so that lines from several hands merge.
  // clang-format off
  static const std::vector<RendererEntry> catalogue{
      god_object_entry(),
      friction_cone_entry(),
      force_shading_entry(),
      implicit_entry(),
      penalty_entry(),
      spring_linear_entry(),
      spring_quadratic_entry(),
      voxel_entry(),
      voxel_sparse_entry(),
  };
  // clang-format on
  return catalogue;
}

const RendererEntry& find_renderer(const Model& model) {
  if (model.provided && model.provided->name == model.renderer) return *model.provided;
  std::vector<std::string> known;
  for (const auto& entry : renderer_catalogue()) {
    if (entry.name == model.renderer) return entry;
    known.push_back(entry.name);
  }
  throw BadData(fmt::format("{}: /renderer: {}", model.source, unknown_name("renderer", model.renderer, known)));
}

const std::vector<NamedDeclaration>& effect_catalogue() {
  static const std::vector<NamedDeclaration> catalogue = [] {
    std::vector<NamedDeclaration> declarations;
    for (const EffectEntry& entry : contact_effects()) {
      declarations.push_back(
          {std::string(entry.name), std::string(entry.summary), entry.parameters, entry.hypothesis, entry.traits});
    }
    declarations.push_back(haptic_device_declaration());
    return declarations;
  }();
  return catalogue;
}

const std::vector<NamedDeclaration>& instrument_declarations() {
  static const std::vector<NamedDeclaration> catalogue = [] {
    std::vector<NamedDeclaration> declarations;
    for (const InstrumentEntry& entry : instrument_catalogue()) {
      declarations.push_back(
          {std::string(entry.name), std::string(entry.summary), entry.parameters, true, entry.traits});
    }
    return declarations;
  }();
  return catalogue;
}

namespace {

// The renderer with its contact effects; what lies between it and the hand comes after.
std::unique_ptr<Renderer> make_contact(const Model& model, std::shared_ptr<const Surface> surface,
                                       decltype(RendererEntry::make) RendererEntry::*make = &RendererEntry::make) {
  const RendererEntry& entry = find_renderer(model);
  const Parameters parameters(entry.parameters, base_parameters(model, entry.parameters), "renderer " + entry.name,
                              model.source, "");
  check_coefficients(value_or(parameters, "mu_static", 0.0), value_or(parameters, "mu_dynamic", 0.0),
                     model.source + ": /parameters");
  auto effects = make_effects(model);
  for (const auto& part : model.instrument)
    check_entry(part, instrument_declarations(), "instrument entry", model.source);
  if (surface->mesh() == nullptr) {
    if (const auto* const limit = find_limitation(entry.cannot, rendering::Ability::analytic_surface)) {
      throw BadData(fmt::format("{}: the renderer {} cannot run on a surface without triangles: {}", model.source,
                                entry.name, limit->reason));
    }
  }
  if (effects.empty()) return (entry.*make)(parameters, std::move(surface));
  const double offset_m = value_or(parameters, "tip_radius_m", 0.0);
  const double stiffness = value_or(parameters, "stiffness_N_per_m", 0.0);
  auto base = (entry.*make)(parameters, surface);
  if (!base) return nullptr;
  return std::make_unique<rendering::EffectStack>(std::move(base), std::move(effects), std::move(surface), offset_m,
                                                  stiffness);
}

}  // namespace

std::unique_ptr<Renderer> make_renderer(const Model& model, std::shared_ptr<const Surface> surface) {
  Model contact = model;
  const auto device = take_haptic_device(contact);
  auto renderer = make_contact(contact, std::move(surface));
  return device ? make_haptic_device(std::move(renderer), *device) : std::move(renderer);
}

namespace {

// What renders several bodies that move against each other, for a message.
std::string renderers_of_scenes() {
  std::string names;
  for (const RendererEntry& entry : renderer_catalogue()) {
    if (entry.make_scene) names += (names.empty() ? "" : ", ") + entry.name;
  }
  return names;
}

}  // namespace

std::unique_ptr<Renderer> make_scene_renderer(const Model& model, std::shared_ptr<const rendering::BodyScene> scene) {
  const RendererEntry& entry = find_renderer(model);
  // A plug-in that takes bodies gets them as they are.
  const bool native = entry.make_scene && !entry.library.empty() && model.effects.empty();
  if (!native && scene->bodies.size() == 1) {
    const rendering::SceneBody& body = scene->bodies.front();
    auto renderer = make_renderer(model, body.surface_B);
    const rendering::BodyPose pose = body.pose.first();
    if (!body.pose.moves() && pose.p_W_m.isZero(0.0) && pose.q_WB.coeffs() == Quat::Identity().coeffs())
      return renderer;
    return std::make_unique<rendering::MovingObject>(std::move(renderer), body.pose);
  }
  if (!native && !scene->moves()) return make_renderer(model, make_embree_surface(joined_mesh(*scene)));
  if (!entry.make_scene) {
    throw BadData(fmt::format(
        "{}: the renderer {} takes one object; {} has {} bodies that move against each other, which {} and plug-ins of "
        "version 2 of the interface render",
        model.source, entry.name, scene->source, scene->bodies.size(), renderers_of_scenes()));
  }
  if (!model.effects.empty()) {
    throw BadData(fmt::format(
        "{}: /effects: {} acts on the contact with one object; {} has {} bodies that move against each other: there "
        "friction is the renderer friction-cone's",
        model.source, model.effects.front().name, scene->source, scene->bodies.size()));
  }
  for (const auto& part : model.instrument)
    check_entry(part, instrument_declarations(), "instrument entry", model.source);
  const Parameters parameters(entry.parameters, model.parameters, "renderer " + entry.name, model.source, "");
  check_coefficients(value_or(parameters, "mu_static", 0.0), value_or(parameters, "mu_dynamic", 0.0),
                     model.source + ": /parameters");
  return entry.make_scene(parameters, std::move(scene));
}

CountedRenderer make_counted_renderer(const Model& model, std::shared_ptr<const Surface> surface) {
  const RendererEntry& entry = find_renderer(model);
  if (entry.make_counted == nullptr) return {nullptr, "the operations of the renderer " + entry.name};
  if (surface->mesh() == nullptr) return {nullptr, "the arithmetic of an analytic surface"};
  Model contact = model;
  const bool device = take_haptic_device(contact).has_value();
  CountedRenderer made{make_contact(contact, std::move(surface), &RendererEntry::make_counted), ""};
  if (!made.renderer)
    return {nullptr, "the renderer " + entry.name + " on a mesh with triangles that cannot be walked on"};
  if (!contact.effects.empty()) made.not_counted = "the effects of the contact";
  if (device) made.not_counted += made.not_counted.empty() ? "the haptic device" : ", the haptic device";
  return made;
}

namespace {

class BuiltInCatalogue final : public rendering::Catalogue {
 public:
  [[nodiscard]] const std::vector<RendererEntry>& renderers() const override { return renderer_catalogue(); }
  [[nodiscard]] const std::vector<NamedDeclaration>& effects() const override { return effect_catalogue(); }
  [[nodiscard]] const std::vector<NamedDeclaration>& instrument_entries() const override {
    return instrument_declarations();
  }
  [[nodiscard]] const RendererEntry& find(const Model& model) const override { return find_renderer(model); }
  [[nodiscard]] std::map<std::string, double> base_parameters(const Model& model) const override {
    return renderers::base_parameters(model, find_renderer(model).parameters);
  }
  [[nodiscard]] std::unique_ptr<Renderer> make(const Model& model,
                                               std::shared_ptr<const Surface> surface) const override {
    return make_renderer(model, std::move(surface));
  }
  [[nodiscard]] std::unique_ptr<Renderer> make_scene(const Model& model,
                                                     std::shared_ptr<const rendering::BodyScene> scene) const override {
    return make_scene_renderer(model, std::move(scene));
  }
  [[nodiscard]] CountedRenderer make_counted(const Model& model,
                                             std::shared_ptr<const Surface> surface) const override {
    return make_counted_renderer(model, std::move(surface));
  }
  [[nodiscard]] rendering::MeasuredRenderer make_measured(const Model& model,
                                                          std::shared_ptr<const Surface> surface) const override {
    return make_measured_renderer(model, surface);
  }
  [[nodiscard]] std::unique_ptr<rendering::Predictor> make_predictor(std::shared_ptr<const Surface> surface,
                                                                     MotionColumns motion) const override {
    return make_model_predictor(std::move(surface), std::move(motion));
  }
};

}  // namespace

const rendering::Catalogue& built_in_catalogue() {
  static const BuiltInCatalogue catalogue;
  return catalogue;
}

}  // namespace touchstone::renderers
