// Steps of a plug-in's renderer, with what comes back looked at before it is believed.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "harness/plugin/plugin_connection.h"
#include "harness/plugin/plugin_creation.h"

namespace touchstone::plugin {

// A run of steps over a connection. A step that fails, or answers with what is no finite number, makes this and every
// later step fail; failure() says how and where in the run.
class PluginRun {
 public:
  // `name` is for messages: "libmine.so: the renderer my-renderer". `creation` is what the connection was made of.
  PluginRun(std::unique_ptr<PluginConnection> connection, std::string name,
            std::shared_ptr<const PluginCreation> creation, std::size_t contact_capacity);

  // Throws RendererFailed.
  void reset();
  // nullptr when it failed; else valid until the next step. `bodies`: where each body of the creation is now.
  const touchstone2_result* step(double t_s, const touchstone2_pose& tip,
                                 std::span<const touchstone2_pose> bodies) noexcept;
  // One body, whose frame is that of the world.
  const touchstone2_result* step(double t_s, const touchstone2_pose& tip) noexcept {
    return step(t_s, tip, {&identity_pose, 1});
  }
  [[nodiscard]] std::string failure() const;

 private:
  enum class State : std::uint8_t { good, broken, not_finite, too_many_contacts };

  std::shared_ptr<const PluginCreation> creation_;
  std::unique_ptr<PluginConnection> connection_;
  std::string name_;
  std::vector<touchstone2_contact> contacts_;
  State state_ = State::good;
  std::uint64_t step_ = 0;
  touchstone2_input last_input_{};
  touchstone2_result last_result_{};
};

}  // namespace touchstone::plugin
