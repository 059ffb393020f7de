// The child process in which a plug-in runs: touchstone-plugin-host describe LIBRARY, or touchstone-plugin-host run.
// Descriptor 3 is the memory shared with the program, descriptor 4 a pipe that ends when the program is gone.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>
#include <thread>
#include <vector>

#include "harness/base/error.h"
#include "harness/plugin/plugin_channel.h"
#include "harness/plugin/plugin_library.h"

namespace {

using namespace touchstone;
using namespace touchstone::plugin;

constexpr int memory_fd = 3;
constexpr int lifeline_fd = 4;
constexpr int usage_status = 2;

// A plug-in that hangs must not outlive the program.
void end_with_the_program() {
  std::thread([] {
    char nothing = 0;
    while (::read(lifeline_fd, &nothing, 1) > 0) {
    }
    ::_exit(0);
  }).detach();
}

std::byte* map_memory(std::size_t& size) {
  struct stat status {};
  if (::fstat(memory_fd, &status) != 0) return nullptr;
  size = static_cast<std::size_t>(status.st_size);
  void* const mapped = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory_fd, 0);
  return mapped == MAP_FAILED ? nullptr : static_cast<std::byte*>(mapped);
}

void write_out(std::byte* memory, std::size_t size, char kind, std::string_view text) {
  const std::uint64_t length = std::min(text.size(), size - 1 - sizeof(std::uint64_t));
  std::memcpy(memory + 1, &length, sizeof length);
  std::memcpy(memory + 1 + sizeof length, text.data(), length);
  // Last: whoever reads the letter finds the rest.
  std::memcpy(memory, &kind, 1);
}

void describe(const char* library, std::byte* memory, std::size_t size) {
  try {
    const PluginLibrary loaded(library);
    write_out(memory, size, 'D', pack(loaded.descriptions()));
  } catch (const std::exception& error) {
    write_out(memory, size, 'E', error.what());
  }
}

void refuse(PluginChannel& channel, const std::string& why) {
  const std::size_t length = std::min(why.size(), PluginChannel::text_size - 1);
  std::memcpy(channel.text, why.data(), length);
  channel.text[length] = '\0';
  channel.outcome = PluginOutcome::refused;
}

// What the creation's structures point to, in this process's addresses.
struct Creation {
  std::vector<touchstone2_body> bodies;
  touchstone2_tool tool{};
  touchstone2_creation creation{};
};

touchstone2_mesh mesh_of(const std::byte* memory, const SharedMesh& mesh) {
  return {reinterpret_cast<const double*>(memory + mesh.vertices_at), mesh.vertex_count,
          reinterpret_cast<const std::int32_t*>(memory + mesh.triangles_at), mesh.triangle_count};
}

void unfold(const std::byte* memory, const PluginChannel& channel, Creation& out) {
  const auto* const bodies = reinterpret_cast<const SharedBody*>(memory + channel.bodies_at);
  for (std::uint64_t i = 0; i < channel.body_count; ++i) {
    out.bodies.push_back({sizeof(touchstone2_body), bodies[i].moves,
                          reinterpret_cast<const char*>(memory + bodies[i].name_at), mesh_of(memory, bodies[i].mesh),
                          bodies[i].pose});
  }
  out.tool = channel.tool;
  out.tool.mesh = mesh_of(memory, channel.tool_mesh);
  out.creation = {sizeof(touchstone2_creation),
                  channel.index,
                  reinterpret_cast<const char*>(memory + channel.model_text_at),
                  reinterpret_cast<const double*>(memory + channel.parameters_at),
                  channel.parameter_count,
                  out.bodies.data(),
                  out.bodies.size(),
                  channel.has_tool != 0 ? &out.tool : nullptr};
}

// One step with the plug-in's own copies: it does not see the memory of the handshake.
class Stepper {
 public:
  Stepper(std::byte* memory, PluginChannel& channel)
      : channel_(channel),
        shared_poses_(reinterpret_cast<const touchstone2_pose*>(memory + channel.poses_at)),
        shared_contacts_(reinterpret_cast<touchstone2_contact*>(memory + channel.contacts_at)),
        poses_(channel.body_count),
        contacts_(channel.contact_capacity) {}

  void step(const PluginLibrary& library, PluginHandle renderer) {
    std::copy_n(shared_poses_, poses_.size(), poses_.begin());
    touchstone2_input input = channel_.input;
    input.bodies = poses_.data();
    input.body_count = poses_.size();
    touchstone2_result result = channel_.result;
    result.contacts = contacts_.data();
    result.contact_capacity = contacts_.size();
    if (!library.step(renderer, input, result)) refuse(channel_, library.error(renderer));
    std::copy_n(contacts_.begin(), std::min(result.contact_count, contacts_.size()), shared_contacts_);
    channel_.result = result;
  }

 private:
  PluginChannel& channel_;
  const touchstone2_pose* shared_poses_;
  touchstone2_contact* shared_contacts_;
  std::vector<touchstone2_pose> poses_;
  std::vector<touchstone2_contact> contacts_;
};

// Serves requests until the program is gone.
[[noreturn]] void serve(std::byte* memory) {
  PluginChannel& channel = *std::launder(reinterpret_cast<PluginChannel*>(memory));
  // Whoever writes to the program's meshes is found at once.
  ::mprotect(memory + channel.arrays_at, channel.size - channel.arrays_at, PROT_READ);
  Creation creation;
  unfold(memory, channel, creation);
  Stepper stepper(memory, channel);
  std::unique_ptr<const PluginLibrary> library;
  PluginHandle renderer = nullptr;
  for (std::uint32_t seen = 0;; ++seen) {
    while (!channel.asked.await(seen, std::chrono::hours(1))) {
    }
    channel.outcome = PluginOutcome::good;
    switch (channel.request) {
      case PluginRequest::create: {
        try {
          library = std::make_unique<const PluginLibrary>(reinterpret_cast<const char*>(memory + channel.library_at));
          std::string why;
          renderer = library->create(creation.creation, why);
          if (renderer == nullptr) refuse(channel, why);
        } catch (const std::exception& error) {
          refuse(channel, error.what());
        }
        break;
      }
      case PluginRequest::reset:
        if (!library->reset(renderer)) refuse(channel, library->error(renderer));
        break;
      case PluginRequest::step:
        stepper.step(*library, renderer);
        break;
      case PluginRequest::destroy:
        library->destroy(renderer);
        channel.answered.ring();
        ::_exit(0);
    }
    channel.answered.ring();
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view task = argc > 1 ? argv[1] : "";
  std::size_t size = 0;
  std::byte* const memory =
      (task == "describe" && argc == 3) || (task == "run" && argc == 2) ? map_memory(size) : nullptr;
  if (memory == nullptr) {
    std::fputs("touchstone-plugin-host: started by touchstone to run a plug-in (--plugin); of no use by itself\n",
               stderr);
    return usage_status;
  }
  end_with_the_program();
  if (task == "run") serve(memory);
  describe(argv[2], memory, size);
  // Without the library's clean-up: it has said what it is.
  ::_exit(0);
}
