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

#include "harness/base/error.h"
#include "harness/plugin/plugin_channel.h"
#include "harness/plugin/plugin_library.h"

namespace {

using namespace touchstone;
using namespace touchstone::plugin;

constexpr int kMemoryFd = 3;
constexpr int kLifelineFd = 4;
constexpr int kUsage = 2;

// A plug-in that hangs must not outlive the program.
void end_with_the_program() {
  std::thread([] {
    char nothing = 0;
    while (::read(kLifelineFd, &nothing, 1) > 0) {
    }
    ::_exit(0);
  }).detach();
}

std::byte* map_memory(std::size_t& size) {
  struct stat status {};
  if (::fstat(kMemoryFd, &status) != 0) return nullptr;
  size = static_cast<std::size_t>(status.st_size);
  void* const mapped = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, kMemoryFd, 0);
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

// Serves requests until the program is gone.
[[noreturn]] void serve(std::byte* memory) {
  PluginChannel& channel = *std::launder(reinterpret_cast<PluginChannel*>(memory));
  // Whoever writes to the program's mesh is found at once.
  ::mprotect(memory + channel.arrays_at, channel.size - channel.arrays_at, PROT_READ);
  const touchstone_creation creation{channel.index,
                                     0,
                                     reinterpret_cast<const char*>(memory + channel.model_text_at),
                                     reinterpret_cast<const double*>(memory + channel.parameters_at),
                                     channel.parameter_count,
                                     reinterpret_cast<const double*>(memory + channel.vertices_at),
                                     channel.vertex_count,
                                     reinterpret_cast<const std::int32_t*>(memory + channel.triangles_at),
                                     channel.triangle_count};
  std::unique_ptr<const PluginLibrary> library;
  touchstone_renderer* renderer = nullptr;
  for (std::uint32_t seen = 0;; ++seen) {
    while (!channel.asked.await(seen, std::chrono::hours(1))) {
    }
    channel.outcome = PluginOutcome::good;
    switch (channel.request) {
      case PluginRequest::create: {
        try {
          library = std::make_unique<const PluginLibrary>(reinterpret_cast<const char*>(memory + channel.library_at));
          std::string why;
          renderer = library->create(creation, why);
          if (renderer == nullptr) refuse(channel, why);
        } catch (const std::exception& error) {
          refuse(channel, error.what());
        }
        break;
      }
      case PluginRequest::reset:
        if (!library->reset(renderer)) refuse(channel, library->error(renderer));
        break;
      case PluginRequest::step: {
        // Its own copies: the plug-in does not see the memory of the handshake.
        const touchstone_tip tip = channel.tip;
        touchstone_result result{};
        if (!library->step(renderer, tip, result)) refuse(channel, library->error(renderer));
        channel.result = result;
        break;
      }
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
    return kUsage;
  }
  end_with_the_program();
  if (task == "run") serve(memory);
  describe(argv[2], memory, size);
  // Without the library's clean-up: it has said what it is.
  ::_exit(0);
}
