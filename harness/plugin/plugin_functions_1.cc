// Version 1 of the interface: points and balls over one body that stands still.
#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"
#include "harness/plugin/plugin_functions.h"

namespace touchstone::plugin {
namespace {

void check_size(const std::filesystem::path& library, const char* what, std::uint32_t given, std::size_t expected) {
  if (given == expected) return;
  throw BadData(fmt::format(
      "{}: it says that it follows version {} of the plug-in interface, but its {} has {} bytes where that "
      "version has {}; build it again with the <touchstone/plugin.h> of this program, and set the sizes with "
      "TOUCHSTONE_PLUGIN_SIZES",
      library.string(), TOUCHSTONE_PLUGIN_VERSION, what, given, expected));
}

class Functions1 final : public PluginFunctions {
 public:
  Functions1(const std::filesystem::path& library, const FindSymbol& find) : library_(library) {
    const auto look = [&](auto*& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find(name));
    };
    look(describe_, "touchstone_describe");
    look(create_, "touchstone_create");
    look(reset_, "touchstone_reset");
    look(step_, "touchstone_step");
    look(destroy_, "touchstone_destroy");
    look(error_, "touchstone_error");
  }

  std::vector<PluginDescription> describe() override {
    std::vector<PluginDescription> out;
    for (std::uint32_t i = 0; i < most_plugin_renderers; ++i) {
      const touchstone_description* const one = describe_(i);
      if (one == nullptr) break;
      check_size(library_, "touchstone_description", one->description_size, sizeof(touchstone_description));
      check_size(library_, "touchstone_creation", one->creation_size, sizeof(touchstone_creation));
      check_size(library_, "touchstone_tip", one->tip_size, sizeof(touchstone_tip));
      check_size(library_, "touchstone_result", one->result_size, sizeof(touchstone_result));
      out.push_back(read_description(*one, library_, i));
    }
    return out;
  }

  PluginHandle create(const touchstone2_creation& creation) override {
    const touchstone2_mesh& mesh = creation.bodies[0].mesh;
    const touchstone_creation given{creation.index,           0,
                                    creation.model_text,      creation.parameters,
                                    creation.parameter_count, mesh.vertices_m,
                                    mesh.vertex_count,        mesh.triangles,
                                    mesh.triangle_count};
    return create_(&given);
  }

  int reset(PluginHandle renderer) override { return reset_(static_cast<touchstone_renderer*>(renderer)); }

  int step(PluginHandle renderer, const touchstone2_input& input, touchstone2_result& result) override {
    touchstone_tip tip{};
    tip.t_s = input.t_s;
    std::ranges::copy(input.tip.p_W_m, tip.p_W_m);
    std::ranges::copy(input.tip.q_WB, tip.q_WS);
    touchstone_result made{};
    const int status = step_(static_cast<touchstone_renderer*>(renderer), &tip, &made);
    std::ranges::copy(made.f_W_N, result.f_W_N);
    std::ranges::copy(made.contact_W_m, result.proxy.p_W_m);
    std::ranges::copy(made.n_W, result.n_W);
    result.depth_m = made.depth_m;
    result.contact = made.contact;
    return status;
  }

  void destroy(PluginHandle renderer) override { destroy_(static_cast<touchstone_renderer*>(renderer)); }
  const char* error(PluginHandle renderer) override { return error_(static_cast<touchstone_renderer*>(renderer)); }

 private:
  std::filesystem::path library_;
  decltype(touchstone_describe)* describe_ = nullptr;
  decltype(touchstone_create)* create_ = nullptr;
  decltype(touchstone_reset)* reset_ = nullptr;
  decltype(touchstone_step)* step_ = nullptr;
  decltype(touchstone_destroy)* destroy_ = nullptr;
  decltype(touchstone_error)* error_ = nullptr;
};

}  // namespace

std::unique_ptr<PluginFunctions> plugin_functions_1(const std::filesystem::path& library, const FindSymbol& find) {
  return std::make_unique<Functions1>(library, find);
}

}  // namespace touchstone::plugin
