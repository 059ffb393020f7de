// An adapter to an engine whose exceptions are of no standard type, and one that throws at the third step or when it is
// made: what engine_plugin.h makes of it.
#include <touchstone/engine_plugin.h>

#include <array>

struct touchstone_renderer {
  explicit touchstone_renderer(const touchstone_creation& creation) {
    if (creation.index == 1) throw 7;
  }
  void restart() { steps = 0; }
  void step(const touchstone_tip& /*tip*/, touchstone_result& /*result*/) {
    if (++steps == 3) throw 7;
  }
  int steps = 0;
  std::string error;
};

static const std::array<touchstone_description, 2>& descriptions() {
  static const std::array<touchstone_description, 2> all{
      {{TOUCHSTONE_PLUGIN_SIZES, "throws-in-step", "nothing, then an exception", "none", nullptr, 0, nullptr, 0},
       {TOUCHSTONE_PLUGIN_SIZES, "throws-in-create", "an exception", "none", nullptr, 0, nullptr, 0}}};
  return all;
}

TOUCHSTONE_EXPORT_ENGINE(descriptions());
