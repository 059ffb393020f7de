// Messages of forces and poses as tables, one for each topic, whatever file holds them; and chunks of such files
// unpacked.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "import_table.h"
#include "ros_message.h"

namespace touchstone::importing {

class RosTables {
 public:
  // `kind`: of the tables' format, "ROS 2 bag".
  RosTables(std::string source, std::string kind) : source_(std::move(source)), kind_(std::move(kind)) {}

  // For the message where no topic can be read.
  void note_topic(const std::string& name, const std::string& type);
  // A message whose type is not one of forces or poses is passed over. Throws BadData naming topic and message where it
  // is damaged, or has another number of values than the topic's first.
  void add(const std::string& topic, const std::string& type, RosEncoding encoding, std::span<const std::byte> message,
           double recorded_s);
  // Each topic's messages in the order in which they were recorded; throws BadData where there are none.
  std::vector<ImportTable> finish();

 private:
  struct Topic {
    ImportTable table;
    std::vector<double> recorded_s;
  };
  std::string source_, kind_, list_;
  std::map<std::string, Topic> topics_;
};

// The bytes of a chunk that is compressed by "bz2", "lz4" or "zstd" (of frames, undone by libarchive), `size` of them;
// nothing where another number comes out. By pieces: a damaged size is no reason to ask for gigabytes.
std::optional<std::string> unpack_chunk(std::string_view packed, std::string_view compression, std::uint64_t size);

}  // namespace touchstone::importing
