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
using rendering::RendererFailed;

namespace {

// How often a waiting program looks whether the child still lives.
constexpr std::chrono::milliseconds look_after{5};
constexpr std::chrono::milliseconds last_wait{1000};
constexpr std::size_t most_described = std::size_t{1} << 20;

// Finds places in memory that is not there yet, and fills it.
class Layout {
 public:
  std::uint64_t add(const void* data, std::size_t bytes) {
    const std::uint64_t at = (end_ + 63) / 64 * 64;
    end_ = at + bytes;
    if (data != nullptr && bytes > 0) pieces_.push_back({at, data, bytes});
    return at;
  }
  std::uint64_t add(const char* text) { return add(text, std::strlen(text) + 1); }
  SharedMesh add(const touchstone2_mesh& mesh) {
    return {add(mesh.vertices_m, 3 * mesh.vertex_count * sizeof(double)), mesh.vertex_count,
            add(mesh.triangles, 3 * mesh.triangle_count * sizeof(std::int32_t)), mesh.triangle_count};
  }
  std::uint64_t next_page() {
    const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    return end_ = (end_ + page - 1) / page * page;
  }
  [[nodiscard]] std::uint64_t end() const { return end_; }
  void copy_to(std::byte* memory) const {
    for (const Piece& piece : pieces_) std::memcpy(memory + piece.at, piece.data, piece.bytes);
  }

 private:
  struct Piece {
    std::uint64_t at;
    const void* data;
    std::size_t bytes;
  };
  std::uint64_t end_ = 0;
  std::vector<Piece> pieces_;
};

std::unique_ptr<SharedMemory> share(const std::filesystem::path& library, const touchstone2_creation& creation,
                                    std::size_t contact_capacity) {
  const std::string path = std::filesystem::absolute(library).string();
  Layout layout;
  layout.add(nullptr, sizeof(PluginChannel));
  const std::uint64_t poses_at = layout.add(nullptr, creation.body_count * sizeof(touchstone2_pose));
  const std::uint64_t contacts_at = layout.add(nullptr, contact_capacity * sizeof(touchstone2_contact));
  const std::uint64_t arrays_at = layout.next_page();
  const std::uint64_t library_at = layout.add(path.c_str());
  const std::uint64_t model_text_at = layout.add(creation.model_text);
  const std::uint64_t parameters_at = layout.add(creation.parameters, creation.parameter_count * sizeof(double));
  std::vector<SharedBody> bodies;
  for (std::size_t i = 0; i < creation.body_count; ++i) {
    const touchstone2_body& body = creation.bodies[i];
    bodies.push_back({layout.add(body.name), layout.add(body.mesh), body.pose, body.moves});
  }
  const std::uint64_t bodies_at = layout.add(bodies.data(), bodies.size() * sizeof(SharedBody));
  const SharedMesh tool_mesh = creation.tool != nullptr ? layout.add(creation.tool->mesh) : SharedMesh{};

  auto memory = std::make_unique<SharedMemory>(layout.end());
  layout.copy_to(memory->data());
  auto* const channel = new (memory->data()) PluginChannel();
  channel->size = layout.end();
  channel->poses_at = poses_at;
  channel->contacts_at = contacts_at;
  channel->contact_capacity = contact_capacity;
  channel->arrays_at = arrays_at;
  channel->library_at = library_at;
  channel->model_text_at = model_text_at;
  channel->parameters_at = parameters_at;
  channel->parameter_count = creation.parameter_count;
  channel->bodies_at = bodies_at;
  channel->body_count = creation.body_count;
  channel->index = creation.index;
  if (creation.tool != nullptr) {
    channel->has_tool = 1;
    channel->tool = *creation.tool;
    channel->tool_mesh = tool_mesh;
  }
  return memory;
}

class InChild final : public PluginConnection {
 public:
  InChild(const std::filesystem::path& library, unsigned version, const touchstone2_creation& creation,
          std::size_t contact_capacity, const PluginLimits& limits, const std::filesystem::path& host)
      : version_(version),
        limits_(limits),
        memory_(share(library, creation, contact_capacity)),
        channel_(*std::launder(reinterpret_cast<PluginChannel*>(memory_->data()))),
        child_(host, {"run"}, memory_->fd()) {
    if (ask(PluginRequest::create, limits_.create)) return;
    throw RendererFailed(fmt::format("{}: {}", library.string(), failure()));
  }

  ~InChild() override {
    // A failure here has no run left to spoil; the child is ended in any case.
    if (!failed_) ask(PluginRequest::destroy, last_wait);
  }
  InChild(const InChild&) = delete;
  InChild& operator=(const InChild&) = delete;

  bool reset() noexcept override { return !failed_ && ask(PluginRequest::reset, limits_.step); }

  bool step(const touchstone2_input& input, touchstone2_result& result) noexcept override {
    if (failed_) return false;
    std::copy_n(input.bodies, std::min<std::size_t>(input.body_count, channel_.body_count), poses());
    channel_.input = input;
    channel_.result = result;
    if (!ask(PluginRequest::step, limits_.step)) return false;
    touchstone2_contact* const contacts = result.contacts;
    const std::size_t capacity = result.contact_capacity;
    result = channel_.result;
    result.contacts = contacts;
    result.contact_capacity = capacity;
    const std::size_t known = std::min<std::size_t>({result.contact_count, capacity, channel_.contact_capacity});
    std::copy_n(shared_contacts(), known, contacts);
    return true;
  }

  [[nodiscard]] std::string failure() const override {
    const char* const function = name_of(channel_.request, version_);
    if (hung_) return fmt::format("did not come back from {} within {} s and was ended", function, waited_.count());
    if (died_) return fmt::format("{} in {}", child_.how_it_ended(), function);
    // The text is the child's: it may have no end.
    const char* const end = std::find(std::begin(channel_.text), std::end(channel_.text), '\0');
    return fmt::format("{} failed: {}", function, std::string(static_cast<const char*>(channel_.text), end));
  }

 private:
  [[nodiscard]] touchstone2_pose* poses() const noexcept {
    return reinterpret_cast<touchstone2_pose*>(memory_->data() + channel_.poses_at);
  }
  [[nodiscard]] const touchstone2_contact* shared_contacts() const noexcept {
    return reinterpret_cast<const touchstone2_contact*>(memory_->data() + channel_.contacts_at);
  }

  bool ask(PluginRequest request, std::chrono::milliseconds limit) noexcept {
    channel_.request = request;
    const std::uint32_t before = channel_.answered.count.load(std::memory_order_acquire);
    channel_.asked.ring();
    if (!channel_.answered.await(before, look_after) && !await_long(before, limit)) return false;
    failed_ = channel_.outcome != PluginOutcome::good;
    return !failed_;
  }

  // No answer in the usual time: does the child live, and for how long is it waited?
  bool await_long(std::uint32_t before, std::chrono::milliseconds limit) noexcept {
    const auto begin = std::chrono::steady_clock::now();
    do {
      const bool ended = child_.ended();
      // The end may follow the answer: looked at last.
      if (channel_.answered.await(before, look_after)) return true;
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

  unsigned version_;
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

std::unique_ptr<PluginConnection> make_plugin_process(const std::filesystem::path& library, unsigned version,
                                                      const touchstone2_creation& creation,
                                                      std::size_t contact_capacity, const PluginLimits& limits,
                                                      const std::filesystem::path& host) {
  return std::make_unique<InChild>(library, version, creation, contact_capacity, limits, host);
}

}  // namespace touchstone::plugin
