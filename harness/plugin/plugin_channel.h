// The memory that the program shares with the child process in which a plug-in runs, and the handshake over it. One
// side waits while the other works: it looks at a word for a short while, which costs a fraction of a microsecond, and
// then sleeps in the kernel (futex) until it is woken.
#pragma once

#include <touchstone/plugin2.h>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace touchstone::plugin {

enum class PluginRequest : std::uint32_t { create, reset, step, destroy };
// As the interface spells the function: "touchstone2_step".
const char* name_of(PluginRequest request, unsigned version) noexcept;
enum class PluginOutcome : std::uint32_t { good, refused };  // refused: `text` says why

// A word that one side counts up and the other waits for.
struct alignas(64) Doorbell {
  std::atomic<std::uint32_t> count{0};
  std::atomic<std::uint32_t> sleepers{0};

  void ring() noexcept;
  // Waits until the count is no longer `seen`; false when it still is after `limit`.
  [[nodiscard]] bool await(std::uint32_t seen, std::chrono::nanoseconds limit) noexcept;
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

// A mesh in the shared memory: bytes from its start.
struct SharedMesh {
  std::uint64_t vertices_at = 0, vertex_count = 0;
  std::uint64_t triangles_at = 0, triangle_count = 0;
};

struct SharedBody {
  std::uint64_t name_at = 0;  // text
  SharedMesh mesh;
  touchstone2_pose pose{};
  std::uint32_t moves = 0;
};

// At the start of the shared memory. The bodies' poses and the contacts of a step follow; then, from `arrays_at`, what
// the creation points to, which is read-only for the child.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): each doorbell has a cache line for itself
struct PluginChannel {
  static constexpr std::size_t text_size = 1024;

  Doorbell asked;
  PluginRequest request = PluginRequest::create;
  touchstone2_input input{};  // its pointers are the child's own
  Doorbell answered;
  PluginOutcome outcome = PluginOutcome::good;
  touchstone2_result result{};  // its pointers are each side's own
  char text[text_size] = {};

  std::uint64_t size = 0;      // of the whole memory
  std::uint64_t poses_at = 0;  // one per body
  std::uint64_t contacts_at = 0, contact_capacity = 0;
  std::uint64_t arrays_at = 0;      // where the read-only part begins: a multiple of the page size
  std::uint64_t library_at = 0;     // text
  std::uint64_t model_text_at = 0;  // text
  std::uint64_t parameters_at = 0, parameter_count = 0;
  std::uint64_t bodies_at = 0, body_count = 0;  // SharedBody
  std::uint32_t index = 0;
  std::uint32_t has_tool = 0;
  touchstone2_tool tool{};  // without its mesh
  SharedMesh tool_mesh;
};

}  // namespace touchstone::plugin
