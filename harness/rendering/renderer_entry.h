// What a program knows of a kind of renderer before it makes one: its name, its parameters, what it cannot do, and how
// to make it. Entries come from the catalogue of renderers/ and from plug-ins (harness/plugin).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/rendering/limitation.h"
#include "harness/rendering/parameters.h"
#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"

namespace touchstone::rendering {

struct BodyScene;  // harness/rendering/scene.h

struct RendererEntry {
  std::string name;     // as model files spell it
  std::string summary;  // one line
  std::string source;   // the publication that the algorithm follows
  std::vector<ParameterDeclaration> parameters;
  std::vector<Limitation> cannot;
  using Make = std::function<std::unique_ptr<Renderer>(const Parameters&, std::shared_ptr<const surface::Surface>)>;
  Make make;
  // The same with harness/base/counted.h's scalar: the same bits, and every operation of a step counted. Empty: its
  // operations are not counted; it may answer nullptr where they are not with these parameters or on this mesh.
  Make make_counted = {};
  // Without effects it answers like a frictionless god-object at rest, so that its error on a surface in closed form is
  // known (generators.h). Its parameters are then stiffness_N_per_m and, for a ball, tip_radius_m.
  bool has_exact_answer = false;
  // Nothing but its friction: with the default coefficient of 0 it is another renderer once more. It is compared where
  // a coefficient (mu_static, mu_dynamic) is known.
  bool needs_friction = false;
  // Lengths below it are nothing to the renderer; 0: none but rounding, or a parameter named epsilon_m says it.
  double epsilon_m = 0.0;
  // One unit of the engine's own world, said beside its results.
  double world_unit_m = 1.0;
  // Over several bodies that may move against each other. Empty: it cannot. Throws BadData for parameters with which it
  // cannot.
  using MakeScene = std::function<std::unique_ptr<Renderer>(const Parameters&, std::shared_ptr<const BodyScene>)>;
  MakeScene make_scene = {};
  // Of a plug-in: its shared library, and where its sources are if the library lies elsewhere.
  std::filesystem::path library = {};
  std::filesystem::path library_source = {};
};

}  // namespace touchstone::rendering
