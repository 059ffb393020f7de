// A model file names the renderer, its parameters, its contact effects in order, and how the measurement was made: the
// one description from which every command, golden case and report runs. Format: "touchstone-model/1" (JSON).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::rendering {

struct DeclaredEffect;

// An effect or instrument entry: its name and the parameters set for it.
struct NamedParameters {
  std::string name;
  std::map<std::string, double> parameters;
  std::string place;                 // JSON pointer in the file, e.g. /effects/0, for messages
  std::filesystem::path image = {};  // a picture's file where the effect takes one ("image"), as seen from here
  // What a user declares in place of the catalogue ("law": the text of an effect file, or its name, relative to the
  // model file); empty: the catalogue knows the name.
  std::shared_ptr<const DeclaredEffect> law = {};
};

struct RendererEntry;

struct Model {
  std::string renderer;
  std::map<std::string, double> parameters;
  std::vector<NamedParameters> effects;           // of the contact, in the order in which they act
  std::vector<NamedParameters> instrument;        // how the measurement was made; only the comparison runs it
  std::string source;                             // the file, for messages
  std::shared_ptr<const RendererEntry> provided;  // by a plug-in that the user loaded; empty for the catalogue's own
};

// Strict: an unknown key, a wrong type or a number that is not finite throws BadData with its place. Names and ranges
// are checked by who makes the renderer (renderers/catalogue.h), because only the catalogue knows them.
Model load_model(const std::filesystem::path& path);
// The files that the text names, pictures and declared effects, are relative to `folder`; `source` is for messages.
Model parse_model(std::string_view text, std::string_view source, const std::filesystem::path& folder);
// As the text of the file `source`: what it names lies beside that.
Model parse_model(std::string_view text, std::string_view source);

// The text of a model file in `folder` (empty: the current one); load_model() from there gives the same model back.
// Pictures stay where they are, and are named as that folder sees them. A declared effect is part of the text.
std::string model_to_json(const Model& model, const std::filesystem::path& folder = {});

// Copies the pictures that the model names into `folder`, each under its own name, and lets the model name the copies:
// for a folder that is to be complete in itself. Throws BadData where a picture cannot be read, UsageError where
// another file of its name stands there already, which is left as it is.
void take_pictures_along(Model& model, const std::filesystem::path& folder);

}  // namespace touchstone::rendering
