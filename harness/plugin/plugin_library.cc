#include "harness/plugin/plugin_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <exception>

#include "harness/base/error.h"

namespace touchstone::plugin {
namespace {

constexpr const char* threw = "a C++ exception left the plug-in; catch it inside and return an error";

}  // namespace

PluginLibrary::PluginLibrary(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw BadData(fmt::format("{}: there is no such plug-in", path.string()));
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    throw BadData(fmt::format("{}: is no file; a plug-in is a shared library (.so)", path.string()));
  }
  // With a slash, so that no other library of that name is found instead.
  handle_ = ::dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ == nullptr) {
    const char* const why = ::dlerror();
    throw BadData(fmt::format("{}: cannot be loaded as a shared library: {}", path.string(),
                              why == nullptr ? "no reason given" : why));
  }
  try {
    load();
  } catch (...) {
    ::dlclose(handle_);
    throw;
  }
}

PluginLibrary::~PluginLibrary() { ::dlclose(handle_); }

void PluginLibrary::load() {
  version_ = reinterpret_cast<decltype(touchstone_plugin_version)*>(symbol("touchstone_plugin_version"))();
  const FindSymbol find = [this](const char* name) { return symbol(name); };
  switch (version_) {
    case TOUCHSTONE_PLUGIN_VERSION:
      functions_ = plugin_functions_1(path_, find);
      break;
    case TOUCHSTONE_PLUGIN_VERSION_2:
      functions_ = plugin_functions_2(path_, find);
      break;
    default:
      throw BadData(fmt::format(
          "{}: it follows version {} of the plug-in interface, this program versions {} and {}; build it again with "
          "the <touchstone/plugin.h> or <touchstone/plugin2.h> of this program",
          path_.string(), version_, TOUCHSTONE_PLUGIN_VERSION, TOUCHSTONE_PLUGIN_VERSION_2));
  }
  descriptions_ = functions_->describe();
  if (descriptions_.empty()) {
    throw BadData(fmt::format("{}: it describes no renderer: its description of renderer 0 is NULL", path_.string()));
  }
}

void* PluginLibrary::symbol(const char* name) const {
  void* const found = ::dlsym(handle_, name);
  if (found != nullptr) return found;
  if (version_ == 0) {
    throw BadData(fmt::format(
        "{}: is a shared library, but no plug-in of Touchstone: it exports no {} (see <touchstone/plugin.h>; "
        "functions of a C++ file need extern \"C\")",
        path_.string(), name));
  }
  throw BadData(fmt::format(
      "{}: it says that it follows version {} of the plug-in interface, but exports no {}, which that version has",
      path_.string(), version_, name));
}

PluginHandle PluginLibrary::create(const touchstone2_creation& creation, std::string& why) const {
  try {
    const PluginHandle made = functions_->create(creation);
    if (made == nullptr) why = error(nullptr);
    return made;
  } catch (...) {
    why = threw;
    return nullptr;
  }
}

void PluginLibrary::destroy(PluginHandle renderer) const noexcept {
  try {
    functions_->destroy(renderer);
  } catch (...) {
    // Nothing is left to be told about it.
    return;
  }
}

bool PluginLibrary::reset(PluginHandle renderer) const noexcept {
  try {
    return functions_->reset(renderer) == 0;
  } catch (...) {
    return false;
  }
}

bool PluginLibrary::step(PluginHandle renderer, const touchstone2_input& input,
                         touchstone2_result& result) const noexcept {
  try {
    return functions_->step(renderer, input, result) == 0;
  } catch (...) {
    return false;
  }
}

std::string PluginLibrary::error(PluginHandle renderer) const {
  try {
    const char* const text = functions_->error(renderer);
    return text == nullptr || *text == '\0' ? "it gives no reason (a C++ exception, or no text of its error function)"
                                            : text;
  } catch (...) {
    return threw;
  }
}

}  // namespace touchstone::plugin
