#include "harness/plugin/plugin_description.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "harness/base/error.h"

namespace touchstone::plugin {
using rendering::Ability;
using rendering::ParameterDeclaration;

namespace {

// More than any renderer has; a count beyond it is memory that is none.
constexpr std::size_t most_entries = 1000;

class Place {
 public:
  Place(const std::filesystem::path& library, std::uint32_t index)
      : text_(fmt::format("{}: renderer {}", library.string(), index)) {}
  void name(std::string_view name) { text_ += fmt::format(" ({})", name); }

  [[noreturn]] void refuse(const std::string& what) const { throw BadData(fmt::format("{}: {}", text_, what)); }
  std::string text(const char* given, std::string_view what, bool required) const {
    if (given == nullptr || (required && *given == '\0')) refuse(fmt::format("{} is missing", what));
    return given;
  }

 private:
  std::string text_;
};

ParameterDeclaration read_parameter(const touchstone_parameter& given, std::size_t index, const Place& place) {
  const std::string what = fmt::format("parameter {}", index);
  ParameterDeclaration out{place.text(given.name, what + ": name", true),
                           place.text(given.unit, what + ": unit", true),
                           given.minimum,
                           given.maximum,
                           given.initial,
                           place.text(given.meaning, what + ": meaning", false)};
  const bool finite = std::isfinite(out.minimum) && std::isfinite(out.maximum) && std::isfinite(out.initial);
  if (!finite || !(out.minimum <= out.initial && out.initial <= out.maximum)) {
    place.refuse(fmt::format("{} ({}): minimum {}, initial {}, maximum {} must be finite and in this order", what,
                             out.name, out.minimum, out.initial, out.maximum));
  }
  return out;
}

void put(std::string& out, const void* data, std::size_t size) { out.append(static_cast<const char*>(data), size); }
void put(std::string& out, std::uint64_t value) { put(out, &value, sizeof value); }
void put(std::string& out, double value) { put(out, std::bit_cast<std::uint64_t>(value)); }
void put(std::string& out, const std::string& text) {
  put(out, std::uint64_t{text.size()});
  put(out, text.data(), text.size());
}

class Unpacker {
 public:
  Unpacker(std::string_view bytes, const std::filesystem::path& library) : bytes_(bytes), library_(library) {}

  std::string_view take(std::size_t size) {
    if (size > bytes_.size()) {
      throw BadData(fmt::format("{}: what the plug-in said about itself arrived incomplete", library_.string()));
    }
    const std::string_view part = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return part;
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  double real() { return std::bit_cast<double>(number()); }
  std::string text() { return std::string(take(number())); }
  [[nodiscard]] bool finished() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
  const std::filesystem::path& library_;
};

}  // namespace

namespace {

// What both versions' descriptions have.
template <class Description>
PluginDescription read_common(const Description& description, Place& place) {
  PluginDescription out;
  out.name = place.text(description.name, "its name", true);
  place.name(out.name);
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (!std::ranges::all_of(out.name, plain)) place.refuse("a name is made of letters, digits, - and _");
  out.summary = place.text(description.summary, "its summary", true);
  out.source = place.text(description.source, "its source", false);
  if (description.parameter_count > most_entries || description.limitation_count > most_entries) {
    place.refuse(fmt::format("it declares {} parameters and {} limitations; at most {} of each are believed",
                             description.parameter_count, description.limitation_count, most_entries));
  }
  if ((description.parameter_count > 0 && description.parameters == nullptr) ||
      (description.limitation_count > 0 && description.limitations == nullptr)) {
    place.refuse("it declares parameters or limitations, but its pointer to them is NULL");
  }
  for (std::size_t i = 0; i < description.parameter_count; ++i) {
    ParameterDeclaration parameter = read_parameter(description.parameters[i], i, place);
    if (std::ranges::find(out.parameters, parameter.name, &ParameterDeclaration::name) != out.parameters.end()) {
      place.refuse(fmt::format("the parameter {} stands twice", parameter.name));
    }
    out.parameters.push_back(std::move(parameter));
  }
  for (std::size_t i = 0; i < description.limitation_count; ++i) {
    const std::string what = fmt::format("limitation {}", i);
    out.limitations.emplace_back(place.text(description.limitations[i].ability, what + ": ability", true),
                                 place.text(description.limitations[i].reason, what + ": reason", true));
  }
  return out;
}

}  // namespace

PluginDescription read_description(const touchstone_description& description, const std::filesystem::path& library,
                                   std::uint32_t index) {
  Place place(library, index);
  return read_common(description, place);
}

PluginDescription read_description(const touchstone2_description& description, const std::filesystem::path& library,
                                   std::uint32_t index) {
  Place place(library, index);
  PluginDescription out = read_common(description, place);
  out.version = TOUCHSTONE_PLUGIN_VERSION_2;
  switch (description.tip_kind) {
    case TOUCHSTONE2_POINT:
      break;
    case TOUCHSTONE2_TOOL:
      out.renders_tools = true;
      break;
    default:
      place.refuse(fmt::format("its tip_kind is {}; {} (a point or ball) or {} (a tool) was expected",
                               description.tip_kind, int{TOUCHSTONE2_POINT}, int{TOUCHSTONE2_TOOL}));
  }
  out.epsilon_m = description.epsilon_m;
  if (description.world_unit_m != 0.0) out.world_unit_m = description.world_unit_m;
  if (!(std::isfinite(out.epsilon_m) && out.epsilon_m >= 0.0)) {
    place.refuse(fmt::format("its epsilon_m is {}; a length of 0 or more was expected", out.epsilon_m));
  }
  if (!(std::isfinite(out.world_unit_m) && out.world_unit_m > 0.0)) {
    place.refuse(fmt::format("its world_unit_m is {}; a length above 0, or 0 for metres, was expected",
                             description.world_unit_m));
  }
  return out;
}

bool takes_several_bodies(const PluginDescription& description) {
  return description.version == TOUCHSTONE_PLUGIN_VERSION_2 &&
         std::ranges::find(description.limitations, several_bodies, &std::pair<std::string, std::string>::first) ==
             description.limitations.end();
}

std::vector<rendering::Limitation> limitations_of(const PluginDescription& description,
                                                  const std::filesystem::path& library) {
  std::vector<rendering::Limitation> out;
  for (const auto& [ability, reason] : description.limitations) {
    if (description.version == TOUCHSTONE_PLUGIN_VERSION_2 && ability == several_bodies) continue;
    const auto* const found = std::ranges::find(rendering::ability_names, ability);
    if (found == rendering::ability_names.end()) {
      throw BadData(fmt::format("{}: renderer {}: there is no ability \"{}\"; there are: {}", library.string(),
                                description.name, ability, fmt::join(rendering::ability_names, " ")));
    }
    out.push_back({static_cast<Ability>(found - rendering::ability_names.begin()), reason});
  }
  if (find_limitation(out, Ability::analytic_surface) == nullptr) {
    out.push_back({Ability::analytic_surface, "a plug-in receives triangles"});
  }
  return out;
}

std::string pack(std::span<const PluginDescription> descriptions) {
  std::string out;
  put(out, std::uint64_t{descriptions.size()});
  for (const PluginDescription& one : descriptions) {
    for (const std::string* const text : {&one.name, &one.summary, &one.source}) put(out, *text);
    put(out, std::uint64_t{one.parameters.size()});
    for (const ParameterDeclaration& parameter : one.parameters) {
      for (const std::string* const text : {&parameter.name, &parameter.unit, &parameter.meaning}) put(out, *text);
      for (const double value : {parameter.minimum, parameter.maximum, parameter.initial}) put(out, value);
    }
    put(out, std::uint64_t{one.limitations.size()});
    for (const auto& [ability, reason] : one.limitations) put(out, ability), put(out, reason);
    put(out, std::uint64_t{one.version});
    put(out, std::uint64_t{one.renders_tools});
    for (const double length_m : {one.epsilon_m, one.world_unit_m}) put(out, length_m);
  }
  return out;
}

std::vector<PluginDescription> unpack(std::string_view bytes, const std::filesystem::path& library) {
  Unpacker from(bytes, library);
  std::vector<PluginDescription> out;
  for (std::uint64_t left = from.number(); left > 0; --left) {
    PluginDescription& one = out.emplace_back();
    for (std::string* const text : {&one.name, &one.summary, &one.source}) *text = from.text();
    for (std::uint64_t n = from.number(); n > 0; --n) {
      ParameterDeclaration& parameter = one.parameters.emplace_back();
      for (std::string* const text : {&parameter.name, &parameter.unit, &parameter.meaning}) *text = from.text();
      for (double* const value : {&parameter.minimum, &parameter.maximum, &parameter.initial}) *value = from.real();
    }
    for (std::uint64_t n = from.number(); n > 0; --n) {
      std::string ability = from.text();
      one.limitations.emplace_back(std::move(ability), from.text());
    }
    one.version = static_cast<unsigned>(from.number());
    one.renders_tools = from.number() != 0;
    for (double* const length_m : {&one.epsilon_m, &one.world_unit_m}) *length_m = from.real();
  }
  if (!from.finished())
    throw BadData(fmt::format("{}: what the plug-in said about itself has bytes too many", library.string()));
  return out;
}

}  // namespace touchstone::plugin
