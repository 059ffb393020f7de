#include "harness/plugin/plugin_in_process.h"

#include <fmt/format.h>

#include <optional>

#include "harness/plugin/plugin_channel.h"
#include "harness/rendering/renderer_failed.h"

namespace touchstone::plugin {
namespace {

class InProcess final : public PluginConnection {
 public:
  InProcess(std::shared_ptr<const PluginLibrary> library, const touchstone2_creation& creation)
      : library_(std::move(library)) {
    std::string why;
    renderer_ = library_->create(creation, why);
    if (renderer_ == nullptr) {
      throw rendering::RendererFailed(fmt::format("{}: the plug-in makes no renderer {}: {}", library_->path().string(),
                                                  library_->descriptions()[creation.index].name, why));
    }
  }
  ~InProcess() override { library_->destroy(renderer_); }
  InProcess(const InProcess&) = delete;
  InProcess& operator=(const InProcess&) = delete;

  bool reset() noexcept override {
    if (!failed_in_ && !library_->reset(renderer_)) failed_in_ = PluginRequest::reset;
    return !failed_in_;
  }
  bool step(const touchstone2_input& input, touchstone2_result& result) noexcept override {
    if (!failed_in_ && !library_->step(renderer_, input, result)) failed_in_ = PluginRequest::step;
    return !failed_in_;
  }
  [[nodiscard]] std::string failure() const override {
    return fmt::format("{} failed: {}", name_of(*failed_in_, library_->version()), library_->error(renderer_));
  }

 private:
  std::shared_ptr<const PluginLibrary> library_;
  PluginHandle renderer_ = nullptr;
  std::optional<PluginRequest> failed_in_;
};

}  // namespace

std::unique_ptr<PluginConnection> make_plugin_in_process(std::shared_ptr<const PluginLibrary> library,
                                                         const touchstone2_creation& creation) {
  return std::make_unique<InProcess>(std::move(library), creation);
}

}  // namespace touchstone::plugin
