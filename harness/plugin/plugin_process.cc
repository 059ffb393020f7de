#include "harness/plugin/plugin_process.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <new>
#include <thread>

#include "harness/base/error.h"
#include "harness/plugin/child_process.h"
#include "harness/plugin/plugin_channel.h"
#include "harness/plugin/shared_memory.h"
#include "harness/rendering/renderer_failed.h"

namespace touchstone::plugin {
namespace {

// How often a waiting program looks whether the child still lives.
constexpr std::chrono::milliseconds kLookAfter{5};
constexpr std::chrono::milliseconds kLastWait{1000};
constexpr std::size_t most_described = std::size_t{1} << 20;

const char* function_of(PluginRequest request) {
  switch (request) {
    case PluginRequest::create:
      return "touchstone_create";
    case PluginRequest::reset:
      return "touchstone_reset";
    case PluginRequest::step:
      return "touchstone_step";
    case PluginRequest::destroy:
      return "touchstone_destroy";
  }
  return "?";
}

// Lays out the shared memory and fills it.
class Layout {
 public:
  std::uint64_t add(std::size_t bytes) {
    const std::uint64_t at = (end_ + 63) / 64 * 64;
    end_ = at + bytes;
    return at;
  }
  std::uint64_t next_page() {
    const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    return end_ = (end_ + page - 1) / page * page;
  }
  [[nodiscard]] std::uint64_t end() const { return end_; }

 private:
  std::uint64_t end_ = 0;
};

std::unique_ptr<SharedMemory> share(const std::filesystem::path& library, const touchstone_creation& creation) {
  const std::string path = std::filesystem::absolute(library).string();
  const std::size_t text_size = std::strlen(creation.model_text) + 1;
  PluginChannel at;
  Layout layout;
  layout.add(sizeof(PluginChannel));
  at.arrays_at = layout.next_page();
  at.library_at = layout.add(path.size() + 1);
  at.model_text_at = layout.add(text_size);
  at.parameter_count = creation.parameter_count;
  at.parameters_at = layout.add(creation.parameter_count * sizeof(double));
  at.vertex_count = creation.vertex_count;
  at.vertices_at = layout.add(3 * creation.vertex_count * sizeof(double));
  at.triangle_count = creation.triangle_count;
  at.triangles_at = layout.add(3 * creation.triangle_count * sizeof(std::int32_t));
  at.size = layout.end();

  auto memory = std::make_unique<SharedMemory>(at.size);
  auto* const channel = new (memory->data()) PluginChannel();
  channel->size = at.size;
  channel->arrays_at = at.arrays_at;
  channel->library_at = at.library_at;
  channel->model_text_at = at.model_text_at;
  channel->parameters_at = at.parameters_at;
  channel->parameter_count = at.parameter_count;
  channel->vertices_at = at.vertices_at;
  channel->vertex_count = at.vertex_count;
  channel->triangles_at = at.triangles_at;
  channel->triangle_count = at.triangle_count;
  channel->index = creation.index;
  const auto fill = [&](std::uint64_t place, const void* data, std::size_t bytes) {
    if (bytes > 0) std::memcpy(memory->data() + place, data, bytes);
  };
  fill(at.library_at, path.c_str(), path.size() + 1);
  fill(at.model_text_at, creation.model_text, text_size);
  fill(at.parameters_at, creation.parameters, creation.parameter_count * sizeof(double));
  fill(at.vertices_at, creation.vertices_W_m, 3 * creation.vertex_count * sizeof(double));
  fill(at.triangles_at, creation.triangles, 3 * creation.triangle_count * sizeof(std::int32_t));
  return memory;
}

class InChild final : public PluginConnection {
 public:
  InChild(const std::filesystem::path& library, const touchstone_creation& creation, const PluginLimits& limits,
          const std::filesystem::path& host)
      : limits_(limits),
        memory_(share(library, creation)),
        channel_(*std::launder(reinterpret_cast<PluginChannel*>(memory_->data()))),
        child_(host, {"run"}, memory_->fd()) {
    if (ask(PluginRequest::create, limits_.create)) return;
    throw RendererFailed(fmt::format("{}: {}", library.string(), failure()));
  }

  ~InChild() override {
    // A failure here has no run left to spoil; the child is ended in any case.
    if (!failed_) ask(PluginRequest::destroy, kLastWait);
  }
  InChild(const InChild&) = delete;
  InChild& operator=(const InChild&) = delete;

  bool reset() noexcept override { return !failed_ && ask(PluginRequest::reset, limits_.step); }

  bool step(const touchstone_tip& tip, touchstone_result& result) noexcept override {
    if (failed_) return false;
    channel_.tip = tip;
    if (!ask(PluginRequest::step, limits_.step)) return false;
    result = channel_.result;
    return true;
  }

  [[nodiscard]] std::string failure() const override {
    const char* const function = function_of(channel_.request);
    if (hung_) return fmt::format("did not come back from {} within {} s and was ended", function, waited_.count());
    if (died_) return fmt::format("{} in {}", child_.how_it_ended(), function);
    // The text is the child's: it may have no end.
    const char* const end = std::find(std::begin(channel_.text), std::end(channel_.text), '\0');
    return fmt::format("{} failed: {}", function, std::string(static_cast<const char*>(channel_.text), end));
  }

 private:
  bool ask(PluginRequest request, std::chrono::milliseconds limit) noexcept {
    channel_.request = request;
    const std::uint32_t before = channel_.answered.count.load(std::memory_order_acquire);
    channel_.asked.ring();
    if (!channel_.answered.await(before, kLookAfter) && !await_long(before, limit)) return false;
    failed_ = channel_.outcome != PluginOutcome::good;
    return !failed_;
  }

  // No answer in the usual time: does the child live, and for how long is it waited?
  bool await_long(std::uint32_t before, std::chrono::milliseconds limit) noexcept {
    const auto begin = std::chrono::steady_clock::now();
    do {
      const bool ended = child_.ended();
      // The end may follow the answer: looked at last.
      if (channel_.answered.await(before, kLookAfter)) return true;
      if (ended) {
        failed_ = died_ = true;
        return false;
      }
    } while (std::chrono::steady_clock::now() - begin < limit);
    child_.kill();
    failed_ = hung_ = true;
    waited_ = limit;
    return false;
  }

  PluginLimits limits_;
  std::unique_ptr<SharedMemory> memory_;
  PluginChannel& channel_;
  ChildProcess child_;
  bool failed_ = false;
  bool died_ = false;
  bool hung_ = false;
  std::chrono::duration<double> waited_{0.0};
};

}  // namespace

std::filesystem::path find_plugin_host() {
  if (const char* const named = std::getenv("TOUCHSTONE_PLUGIN_HOST"); named != nullptr && *named != '\0') return named;
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::array<std::filesystem::path, 2> places{folder / "touchstone-plugin-host",
                                                    folder.parent_path() / "libexec/touchstone/touchstone-plugin-host"};
  for (const auto& place : places) {
    if (std::filesystem::exists(place, error)) return place;
  }
  throw UsageError(fmt::format(
      "the program that plug-ins run in was found neither at {} nor at {}; install it there, name it in the "
      "environment variable TOUCHSTONE_PLUGIN_HOST, or run plug-ins in this process",
      places[0].string(), places[1].string()));
}

std::vector<PluginDescription> describe_plugin(const std::filesystem::path& library, const PluginLimits& limits,
                                               const std::filesystem::path& host) {
  // The child writes one letter and the rest: E and a message, or D and descriptions.
  const SharedMemory memory(most_described);
  ChildProcess child(host, {"describe", library.string()}, memory.fd());
  const auto begin = std::chrono::steady_clock::now();
  while (!child.ended()) {
    if (std::chrono::steady_clock::now() - begin > limits.create) {
      child.kill();
      throw RendererFailed(fmt::format("{}: the plug-in did not come back from being loaded and described within {} s",
                                       library.string(), std::chrono::duration<double>(limits.create).count()));
    }
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const auto* const bytes = reinterpret_cast<const char*>(memory.data());
  std::uint64_t size = 0;
  std::memcpy(&size, bytes + 1, sizeof size);
  const bool whole = (*bytes == 'E' || *bytes == 'D') && size <= most_described - 1 - sizeof size;
  if (!whole) {
    throw RendererFailed(
        fmt::format("{}: the plug-in {} while it was loaded and described", library.string(), child.how_it_ended()));
  }
  const std::string_view text(bytes + 1 + sizeof size, size);
  if (*bytes == 'E') throw BadData(std::string(text));
  return unpack(text, library);
}

std::unique_ptr<PluginConnection> make_plugin_process(const std::filesystem::path& library,
                                                      const touchstone_creation& creation, const PluginLimits& limits,
                                                      const std::filesystem::path& host) {
  return std::make_unique<InChild>(library, creation, limits, host);
}

}  // namespace touchstone::plugin
