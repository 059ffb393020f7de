// Version 2 of the interface: what the program itself speaks.
#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/plugin/plugin_functions.h"

namespace touchstone::plugin {
namespace {

class Functions2 final : public PluginFunctions {
 public:
  Functions2(const std::filesystem::path& library, const FindSymbol& find) : library_(library) {
    const auto look = [&](auto*& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find(name));
    };
    look(describe_, "touchstone2_describe");
    look(create_, "touchstone2_create");
    look(reset_, "touchstone2_reset");
    look(step_, "touchstone2_step");
    look(destroy_, "touchstone2_destroy");
    look(error_, "touchstone2_error");
  }

  std::vector<PluginDescription> describe() override {
    std::vector<PluginDescription> out;
    for (std::uint32_t i = 0; i < most_plugin_renderers; ++i) {
      const touchstone2_description* const one = describe_(i);
      if (one == nullptr) break;
      // A later header has more at its end, which is not looked at; less has never been.
      if (one->size < sizeof(touchstone2_description)) {
        throw BadData(
            fmt::format("{}: it says that it follows version {} of the plug-in interface, but the size of its "
                        "touchstone2_description is {} where that version has {}; build it again with the "
                        "<touchstone/plugin2.h> of "
                        "this program, and set size to sizeof(touchstone2_description)",
                        library_.string(), TOUCHSTONE_PLUGIN_VERSION_2, one->size, sizeof(touchstone2_description)));
      }
      out.push_back(read_description(*one, library_, i));
    }
    return out;
  }

  PluginHandle create(const touchstone2_creation& creation) override { return create_(&creation); }
  int reset(PluginHandle renderer) override { return reset_(static_cast<touchstone2_renderer*>(renderer)); }
  int step(PluginHandle renderer, const touchstone2_input& input, touchstone2_result& result) override {
    return step_(static_cast<touchstone2_renderer*>(renderer), &input, &result);
  }
  void destroy(PluginHandle renderer) override { destroy_(static_cast<touchstone2_renderer*>(renderer)); }
  const char* error(PluginHandle renderer) override { return error_(static_cast<touchstone2_renderer*>(renderer)); }

 private:
  std::filesystem::path library_;
  decltype(touchstone2_describe)* describe_ = nullptr;
  decltype(touchstone2_create)* create_ = nullptr;
  decltype(touchstone2_reset)* reset_ = nullptr;
  decltype(touchstone2_step)* step_ = nullptr;
  decltype(touchstone2_destroy)* destroy_ = nullptr;
  decltype(touchstone2_error)* error_ = nullptr;
};

}  // namespace

std::unique_ptr<PluginFunctions> plugin_functions_2(const std::filesystem::path& library, const FindSymbol& find) {
  return std::make_unique<Functions2>(library, find);
}

}  // namespace touchstone::plugin
