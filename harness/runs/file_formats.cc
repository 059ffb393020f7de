#include "harness/runs/file_formats.h"

#include <array>

namespace touchstone::runs {
namespace {

constexpr auto farm_fields = std::to_array<FormatField>({
    {"prologue?", "list of texts", "", "lines of shell before the program"},
    {"inside?", "list of texts", "", "words before it, such as those of a container"},
    {"program?", "text", "", "where the tasks find it; this program by default"},
    {"node_store?", "text", "", "folder of the node that takes results first"},
    {"kubernetes?", "object", "", "for job.yaml"},
    {"kubernetes.image", "text", "", "of the container"},
    {"kubernetes.claim", "text", "", "persistent volume claim"},
    {"kubernetes.mount", "text", "", "where it is mounted"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-farm/1", "farm.json",
       "what a task does around the program on any farm of computers (docs/how-to/many-cases.md)", "",
       "`sweep --farm`, `atlas`, `blind`", farm_fields},
  });
  return formats;
}

}  // namespace touchstone::runs
