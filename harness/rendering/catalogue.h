// Everything that a model file may name: renderers, contact effects and instrument entries, and how to make what a
// model describes. The harness knows no concrete renderer; it is given a catalogue. renderers/catalogue.h has the one
// of this project, built_in_catalogue(); a program with renderers of its own may give another.
//
// All functions throw BadData, with the place in the model file, for a renderer, effect or instrument entry that the
// catalogue does not know, for a parameter that nothing reads or that is out of range, and for a surface that the
// renderer cannot run on. Many threads may ask one catalogue at once.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/rendering/model.h"
#include "harness/rendering/parameters.h"
#include "harness/rendering/renderer.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/rendering/scene.h"
#include "harness/surface/surface.h"

namespace touchstone::rendering {

struct NamedDeclaration;  // harness/rendering/named_declaration.h
class MeasuredRenderer;   // harness/rendering/measured_renderer.h
class Predictor;          // harness/rendering/predictor.h

// A renderer whose floating-point operations are counted (operations.h): the same forces to the bit. No renderer if
// they are not counted; `not_counted` then says why, else what of the model is left out of the count.
struct CountedRenderer {
  std::unique_ptr<Renderer> renderer;
  std::string not_counted;
};

class Catalogue {
 public:
  Catalogue() = default;
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;
  virtual ~Catalogue() = default;

  [[nodiscard]] virtual const std::vector<RendererEntry>& renderers() const = 0;
  // What model files may say under "effects" and "instrument", and set there.
  [[nodiscard]] virtual const std::vector<NamedDeclaration>& effects() const = 0;
  [[nodiscard]] virtual const std::vector<NamedDeclaration>& instrument_entries() const = 0;

  // The model's plug-in entry if it has one (Model::provided), else the catalogue's.
  [[nodiscard]] virtual const RendererEntry& find(const Model& model) const = 0;
  // The renderer's own parameters: those that the model sets, and those that its effects set in the renderer
  // (tip-radius adds to tip_radius_m).
  [[nodiscard]] virtual std::map<std::string, double> base_parameters(const Model& model) const = 0;

  // The model's renderer with its effects over the surface. Instrument entries are checked, not run.
  [[nodiscard]] virtual std::unique_ptr<Renderer> make(const Model& model,
                                                       std::shared_ptr<const surface::Surface> surface) const = 0;
  // The same over a scene. Any renderer with any effects where the bodies do not move against each other: over one
  // body, or over several at rest, which are one object then. Else the renderer must be able to
  // (RendererEntry::make_scene), without effects.
  [[nodiscard]] virtual std::unique_ptr<Renderer> make_scene(const Model& model,
                                                             std::shared_ptr<const BodyScene> scene) const = 0;
  [[nodiscard]] virtual CountedRenderer make_counted(const Model& model,
                                                     std::shared_ptr<const surface::Surface> surface) const = 0;
  // With the instrument entries, for a comparison with a recording.
  [[nodiscard]] virtual MeasuredRenderer make_measured(const Model& model,
                                                       std::shared_ptr<const surface::Surface> surface) const = 0;
  // What a recording along `motion` should show if a model were true. `motion`: the positions of the in-trajectory.
  [[nodiscard]] virtual std::unique_ptr<Predictor> make_predictor(std::shared_ptr<const surface::Surface> surface,
                                                                  MotionColumns motion) const = 0;
};

// The names of the catalogue's renderers, in its order.
std::vector<std::string> renderer_names(const Catalogue& catalogue);

}  // namespace touchstone::rendering
