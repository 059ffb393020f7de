#include "harness/plugin/plugin_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <exception>

#include "harness/base/error.h"

namespace touchstone::plugin {
namespace {

constexpr const char* kThrew = "a C++ exception left the plug-in; catch it inside and return an error";

void check_size(const std::filesystem::path& library, const char* what, std::uint32_t given, std::size_t expected) {
  if (given == expected) return;
  throw BadData(fmt::format(
      "{}: it says that it follows version {} of the plug-in interface, but its {} has {} bytes where that "
      "version has {}; build it again with the <touchstone/plugin.h> of this program, and set the sizes with "
      "TOUCHSTONE_PLUGIN_SIZES",
      library.string(), TOUCHSTONE_PLUGIN_VERSION, what, given, expected));
}

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
    find(version_, "touchstone_plugin_version");
    check_version();
    find(describe_, "touchstone_describe");
    find(create_, "touchstone_create");
    find(reset_, "touchstone_reset");
    find(step_, "touchstone_step");
    find(destroy_, "touchstone_destroy");
    find(error_, "touchstone_error");
    constexpr std::uint32_t most_renderers = 1000;
    for (std::uint32_t i = 0; i < most_renderers; ++i) {
      const touchstone_description* const one = describe_(i);
      if (one == nullptr) break;
      check_size(path_, "touchstone_description", one->description_size, sizeof(touchstone_description));
      check_size(path_, "touchstone_creation", one->creation_size, sizeof(touchstone_creation));
      check_size(path_, "touchstone_tip", one->tip_size, sizeof(touchstone_tip));
      check_size(path_, "touchstone_result", one->result_size, sizeof(touchstone_result));
      descriptions_.push_back(read_description(*one, path_, i));
    }
    if (descriptions_.empty()) {
      throw BadData(fmt::format("{}: touchstone_describe(0) gives NULL: the plug-in has no renderer", path.string()));
    }
  } catch (...) {
    ::dlclose(handle_);
    throw;
  }
}

PluginLibrary::~PluginLibrary() { ::dlclose(handle_); }

void* PluginLibrary::symbol(const char* name) const {
  void* const found = ::dlsym(handle_, name);
  if (found != nullptr) return found;
  if (version_ == nullptr) {
    throw BadData(fmt::format(
        "{}: is a shared library, but no plug-in of Touchstone: it exports no {} (see <touchstone/plugin.h>; "
        "functions of a C++ file need extern \"C\")",
        path_.string(), name));
  }
  throw BadData(fmt::format(
      "{}: it says that it follows version {} of the plug-in interface, but exports no {}, which that version has",
      path_.string(), version_(), name));
}

void PluginLibrary::check_version() const {
  const std::uint32_t version = version_();
  if (version == TOUCHSTONE_PLUGIN_VERSION) return;
  throw BadData(fmt::format(
      "{}: it follows version {} of the plug-in interface, this program version {}; build it again with the "
      "<touchstone/plugin.h> of this program",
      path_.string(), version, TOUCHSTONE_PLUGIN_VERSION));
}

touchstone_renderer* PluginLibrary::create(const touchstone_creation& creation, std::string& why) const {
  try {
    touchstone_renderer* const made = create_(&creation);
    if (made == nullptr) why = error(nullptr);
    return made;
  } catch (...) {
    why = kThrew;
    return nullptr;
  }
}

void PluginLibrary::destroy(touchstone_renderer* renderer) const noexcept {
  try {
    destroy_(renderer);
  } catch (...) {
    // Nothing is left to be told about it.
    return;
  }
}

bool PluginLibrary::reset(touchstone_renderer* renderer) const noexcept {
  try {
    return reset_(renderer) == 0;
  } catch (...) {
    return false;
  }
}

bool PluginLibrary::step(touchstone_renderer* renderer, const touchstone_tip& tip,
                         touchstone_result& result) const noexcept {
  try {
    return step_(renderer, &tip, &result) == 0;
  } catch (...) {
    return false;
  }
}

std::string PluginLibrary::error(const touchstone_renderer* renderer) const {
  try {
    const char* const text = error_(renderer);
    return text == nullptr || *text == '\0' ? "it gives no reason (a C++ exception, or no touchstone_error text)"
                                            : text;
  } catch (...) {
    return kThrew;
  }
}

}  // namespace touchstone::plugin
