#include "harness/rendering/model.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/base/json_reader.h"
#include "harness/rendering/declared_effect.h"

namespace touchstone::rendering {
namespace {

constexpr const char* model_schema = "touchstone-model/1";

std::map<std::string, double> read_parameters(JsonObject& owner) {
  std::map<std::string, double> parameters;
  if (!owner.has("parameters")) return parameters;
  JsonObject object = owner.object("parameters");
  for (const auto& name : object.keys()) parameters[name] = object.number(name);
  return parameters;
}

std::shared_ptr<const DeclaredEffect> read_law(JsonObject& entry, const std::string& name, bool instrument,
                                               const std::filesystem::path& folder) {
  if (!entry.has("law")) return nullptr;
  const nlohmann::json& value = entry.raw("law");
  auto law = value.is_string() ? load_effect(folder / value.get<std::string>())
                               : read_effect(value, entry.source(), entry.place() + "/law");
  if (law.name != name)
    entry.fail_at("law", "it declares \"" + law.name + "\", the entry's name is \"" + name + "\"; give both one name");
  if (law.is_instrument() != instrument) {
    entry.fail_at("law", "it acts on the " + std::string(law.is_instrument() ? "measurement" : "contact") +
                             ": the entry belongs under \"" + (instrument ? "effects" : "instrument") + "\"");
  }
  return std::make_shared<const DeclaredEffect>(std::move(law));
}

std::vector<NamedParameters> read_entries(JsonObject& root, const char* key, const std::filesystem::path& folder) {
  std::vector<NamedParameters> entries;
  if (!root.has(key)) return entries;
  for (JsonObject& object : root.objects(key)) {
    NamedParameters entry;
    entry.name = object.text("name");
    entry.parameters = read_parameters(object);
    entry.place = object.place();
    if (const auto image = object.optional_text("image"); image && !image->empty()) entry.image = folder / *image;
    entry.law = read_law(object, entry.name, std::string_view(key) == "instrument", folder);
    object.finish();
    entries.push_back(std::move(entry));
  }
  return entries;
}

// A file's name as `folder` sees it. Links are followed, since ".." is taken from where they lead.
std::string seen_from(const std::filesystem::path& folder, const std::filesystem::path& file) {
  if (folder.empty()) return file.generic_string();
  return std::filesystem::weakly_canonical(file)
      .lexically_proximate(std::filesystem::weakly_canonical(folder))
      .generic_string();
}

nlohmann::ordered_json to_json(const std::vector<NamedParameters>& entries, const std::filesystem::path& folder) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& entry : entries) {
    nlohmann::ordered_json object{{"name", entry.name}, {"parameters", entry.parameters}};
    if (!entry.image.empty()) object["image"] = seen_from(folder, entry.image);
    if (entry.law != nullptr) object["law"] = effect_document(*entry.law);
    list.push_back(std::move(object));
  }
  return list;
}

}  // namespace

Model load_model(const std::filesystem::path& path) {
  note_input_file(path);
  return parse_model(read_file(path), path.string());
}

Model parse_model(std::string_view text, std::string_view source) {
  return parse_model(text, source, std::filesystem::path(source).parent_path());
}

Model parse_model(std::string_view text, std::string_view source, const std::filesystem::path& folder) {
  const nlohmann::json document = parse_json(text, source);
  JsonObject root(document, std::string(source), "");
  root.schema(model_schema);
  Model model;
  model.source = source;
  model.renderer = root.text("renderer");
  model.parameters = read_parameters(root);
  model.effects = read_entries(root, "effects", folder);
  model.instrument = read_entries(root, "instrument", folder);
  root.finish();
  return model;
}

std::string model_to_json(const Model& model, const std::filesystem::path& folder) {
  nlohmann::ordered_json document;
  document["schema"] = model_schema;
  document["renderer"] = model.renderer;
  document["parameters"] = model.parameters;
  document["effects"] = to_json(model.effects, folder);
  document["instrument"] = to_json(model.instrument, folder);
  return document.dump(2) + "\n";
}

void take_pictures_along(Model& model, const std::filesystem::path& folder) {
  for (NamedParameters& effect : model.effects) {
    if (effect.image.empty()) continue;
    const std::string picture = read_file(effect.image);
    const auto copy = folder / effect.image.filename();
    if (!std::filesystem::exists(copy)) {
      write_file(copy, picture);
    } else if (read_file(copy) != picture) {
      throw UsageError(fmt::format("{}: another file of this name stands there already; {} was to be copied to it",
                                   copy.string(), effect.image.string()));
    }
    effect.image = copy;
  }
}

}  // namespace touchstone::rendering
