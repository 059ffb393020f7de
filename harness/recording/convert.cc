#include "harness/recording/convert.h"

#include "harness/recording/recording_stream.h"
#include "harness/recording/recording_writer.h"

namespace touchstone::recording {

Conversion convert_recording(const std::filesystem::path& in, const std::filesystem::path& out,
                             const ColumnUnits& units, const ClockPolicy& clock,
                             const std::function<void(std::uint64_t)>& progress) {
  RecordingStream stream = RecordingStream::open(in, {.clock = clock});
  std::vector<ColumnGroup> groups;
  for (std::size_t g = 0; g < group_count; ++g) {
    const auto group = static_cast<ColumnGroup>(g);
    if (stream.has(group)) groups.push_back(group);
  }
  RecordingWriter writer(out, groups, units);
  SampleBlock block;
  while (stream.next(block)) {
    writer.append(block);
    if (progress) progress(stream.samples());
  }
  writer.commit();
  return {stream.samples(), stream.clock(), stream.notes()};
}

}  // namespace touchstone::recording
