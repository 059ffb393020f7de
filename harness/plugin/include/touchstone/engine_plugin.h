// Makes a plug-in of version 1 of a C++ class, without the rest of this library: for adapters to engines that have
// types of their own (examples/chai3d, examples/hapi). C++17; needs <touchstone/plugin.h> alone. In one .cc of a shared
// library:
//
//   struct touchstone_renderer {
//     explicit touchstone_renderer(const touchstone_creation& creation);            // may throw
//     void restart();                                                                // may throw
//     void step(const touchstone_tip& tip, touchstone_result& result);               // may throw; the result is zero
//     std::string error;
//   };
//   TOUCHSTONE_EXPORT_ENGINE(descriptions());  // an array of touchstone_description, that lives as long as the library
#ifndef TOUCHSTONE_ENGINE_PLUGIN_H
#define TOUCHSTONE_ENGINE_PLUGIN_H

#include <touchstone/plugin.h>

#include <cstring>
#include <exception>
#include <string>

namespace touchstone::plugin::engine_export {

inline std::string& creation_error() {
  thread_local std::string error;
  return error;
}

// Engines have exceptions of their own, which say nothing here.
constexpr const char* unknown_exception = "the engine threw something that is no std::exception";

// What is thrown below becomes an error of the renderer.
template <class Renderer, class Body>
int guarded(Renderer* renderer, const Body& body) noexcept {
  try {
    body();
    return 0;
  } catch (const std::exception& thrown) {
    renderer->error = thrown.what();
    return 1;
  } catch (...) {
    renderer->error = unknown_exception;
    return 1;
  }
}

template <class Renderer>
Renderer* create(const touchstone_creation& creation) noexcept {
  try {
    return new Renderer(creation);
  } catch (const std::exception& thrown) {
    creation_error() = thrown.what();
    return nullptr;
  } catch (...) {
    creation_error() = unknown_exception;
    return nullptr;
  }
}

}  // namespace touchstone::plugin::engine_export

#define TOUCHSTONE_EXPORT_ENGINE(descriptions)                                                               \
  extern "C" {                                                                                               \
  uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION; }                             \
  const touchstone_description* touchstone_describe(uint32_t index) {                                        \
    return index < (descriptions).size() ? &(descriptions)[index] : nullptr;                                 \
  }                                                                                                          \
  touchstone_renderer* touchstone_create(const touchstone_creation* creation) {                              \
    return touchstone::plugin::engine_export::create<touchstone_renderer>(*creation);                        \
  }                                                                                                          \
  int touchstone_reset(touchstone_renderer* renderer) {                                                      \
    return touchstone::plugin::engine_export::guarded(renderer, [&] { renderer->restart(); });               \
  }                                                                                                          \
  int touchstone_step(touchstone_renderer* renderer, const touchstone_tip* tip, touchstone_result* result) { \
    return touchstone::plugin::engine_export::guarded(renderer, [&] {                                        \
      std::memset(result, 0, sizeof *result);                                                                \
      renderer->step(*tip, *result);                                                                         \
    });                                                                                                      \
  }                                                                                                          \
  void touchstone_destroy(touchstone_renderer* renderer) { delete renderer; }                                \
  const char* touchstone_error(const touchstone_renderer* renderer) {                                        \
    return renderer == nullptr ? touchstone::plugin::engine_export::creation_error().c_str()                 \
                               : renderer->error.c_str();                                                    \
  }                                                                                                          \
  }                                                                                                          \
  static_assert(true, "")

#endif
