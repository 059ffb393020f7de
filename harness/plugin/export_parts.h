// What the headers that make plug-ins of C++ renderers have in common: plugin_export.h (points over one object),
// scene_export.h (points over bodies that move) and tool_export.h (tools with a shape). Not for itself.
#pragma once

#include <touchstone/plugin2.h>

#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/plugin/plugin_values.h"
#include "harness/rendering/limitation.h"
#include "harness/rendering/parameters.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::plugin::export_parts {

inline surface::TriangleMesh mesh_of(const touchstone2_mesh& given) {
  surface::TriangleMesh mesh;
  mesh.source = "the program's mesh";
  for (std::size_t i = 0; i < given.vertex_count; ++i) {
    const double* const v = given.vertices_m + 3 * i;
    mesh.vertices_W_m.emplace_back(v[0], v[1], v[2]);
  }
  for (std::size_t i = 0; i < given.triangle_count; ++i) {
    const std::int32_t* const t = given.triangles + 3 * i;
    mesh.triangles.push_back({t[0], t[1], t[2]});
  }
  return mesh;
}

// An entry's parameters and limitations in C, which point into the entry.
template <class Entry>
std::vector<touchstone_parameter> parameters_of(const Entry& entry) {
  std::vector<touchstone_parameter> out;
  out.reserve(entry.parameters.size());
  for (const rendering::ParameterDeclaration& p : entry.parameters)
    out.push_back({p.name.c_str(), p.unit.c_str(), p.minimum, p.maximum, p.initial, p.meaning.c_str()});
  return out;
}
inline std::vector<touchstone_limitation> limitations_of(const std::vector<rendering::Limitation>& cannot) {
  std::vector<touchstone_limitation> out;
  out.reserve(cannot.size());
  for (const rendering::Limitation& limit : cannot)
    out.push_back({ability_name(limit.ability).data(), limit.reason.c_str()});
  return out;
}

// The description of version 2 that points into the entry and into what the two functions above made of it.
template <class Entry, class Kind>
touchstone2_description description_of(const Entry& entry, Kind tip_kind,
                                       const std::vector<touchstone_parameter>& parameters,
                                       const std::vector<touchstone_limitation>& limitations) {
  touchstone2_description out{};
  out.size = sizeof out;
  out.tip_kind = tip_kind;
  out.name = entry.name.c_str();
  out.summary = entry.summary.c_str();
  out.source = entry.source.c_str();
  out.parameters = parameters.data();
  out.parameter_count = parameters.size();
  out.limitations = limitations.data();
  out.limitation_count = limitations.size();
  return out;
}

// The values that the program gives, in the order of the declarations.
template <class Entry>
rendering::Parameters given_parameters(const Entry& entry, const double* values, std::size_t count) {
  std::map<std::string, double> given;
  for (std::size_t i = 0; i < count; ++i) given[entry.parameters.at(i).name] = values[i];
  return rendering::Parameters(entry.parameters, given, "renderer " + entry.name, "the program's model", "");
}

// A renderer's entry and the parts of its description in C, which point into it: it stays where it was made.
template <class Entry>
class EntryInC {
 public:
  EntryInC(const EntryInC&) = delete;
  EntryInC& operator=(const EntryInC&) = delete;

 protected:
  explicit EntryInC(Entry entry)
      : entry_(std::move(entry)), parameters_(parameters_of(entry_)), limitations_(limitations_of(entry_.cannot)) {}
  ~EntryInC() = default;

  Entry entry_;
  std::vector<touchstone_parameter> parameters_;
  std::vector<touchstone_limitation> limitations_;
};

// `Exported`: an entry with its description in C.
template <class Exported>
using ExportedList = std::vector<std::unique_ptr<const Exported>>;

template <class Exported, class... Entries>
ExportedList<Exported> export_all(Entries... entries) {
  ExportedList<Exported> list;
  (list.push_back(std::make_unique<const Exported>(std::move(entries))), ...);
  return list;
}

inline std::string& creation_error() {
  thread_local std::string text;
  return text;
}

constexpr const char* unknown_exception = "it threw something that is no std::exception";

// A new Handle of what the entry that is asked for makes; nullptr, with creation_error(), where it throws.
template <class Handle, class Exported, class Creation>
Handle* create(const ExportedList<Exported>& list, const Creation& creation) noexcept {
  try {
    return new Handle{list.at(creation.index)->make(creation), {}};
  } catch (const std::exception& error) {
    creation_error() = error.what();
    return nullptr;
  } catch (...) {
    creation_error() = unknown_exception;
    return nullptr;
  }
}

// 0 when it went well, else the handle's error says why.
template <class Handle>
int reset(Handle& handle) noexcept {
  try {
    handle.renderer->reset();
    return 0;
  } catch (const std::exception& error) {
    handle.error = error.what();
    return 1;
  } catch (...) {
    handle.error = unknown_exception;
    return 1;
  }
}

template <class Handle>
const char* error_of(const Handle* handle) noexcept {
  return handle == nullptr ? creation_error().c_str() : handle->error.c_str();
}

}  // namespace touchstone::plugin::export_parts

// The functions of the C interface. PREFIX: touchstone or touchstone2, with which a version's names begin; INPUT: what
// its step takes; ROOM: the namespace here that has Exported and step().
#define TOUCHSTONE_EXPORT_PLUGIN(VERSION, PREFIX, INPUT, ROOM, ...)                                                \
  using touchstone_exported_entry = touchstone::plugin::ROOM::Exported;                                            \
  static const touchstone::plugin::export_parts::ExportedList<touchstone_exported_entry>& touchstone_exported() {  \
    static const auto list = touchstone::plugin::export_parts::export_all<touchstone_exported_entry>(__VA_ARGS__); \
    return list;                                                                                                   \
  }                                                                                                                \
  extern "C" {                                                                                                     \
  uint32_t touchstone_plugin_version(void) { return VERSION; }                                                     \
  const PREFIX##_description* PREFIX##_describe(uint32_t index) {                                                  \
    return index < touchstone_exported().size() ? touchstone_exported()[index]->description() : nullptr;           \
  }                                                                                                                \
  PREFIX##_renderer* PREFIX##_create(const PREFIX##_creation* creation) {                                          \
    return touchstone::plugin::export_parts::create<PREFIX##_renderer>(touchstone_exported(), *creation);          \
  }                                                                                                                \
  int PREFIX##_reset(PREFIX##_renderer* renderer) { return touchstone::plugin::export_parts::reset(*renderer); }   \
  int PREFIX##_step(PREFIX##_renderer* renderer, const INPUT* input, PREFIX##_result* result) {                    \
    return touchstone::plugin::ROOM::step(*renderer, *input, *result);                                             \
  }                                                                                                                \
  void PREFIX##_destroy(PREFIX##_renderer* renderer) { delete renderer; }                                          \
  const char* PREFIX##_error(const PREFIX##_renderer* renderer) {                                                  \
    return touchstone::plugin::export_parts::error_of(renderer);                                                   \
  }                                                                                                                \
  }                                                                                                                \
  static_assert(true)
