// Bags of ROS 2 as MCAP (the specification at mcap.dev/spec: records of an opcode, a length of 64 bits and content, all
// little-endian; chunks hold records, plain or compressed by lz4 or zstd). Messages of forces and poses, in CDR or as
// ROS 1 serializes them, become one table for each topic.
#include <fmt/format.h>
#include <zlib.h>

#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"
#include "ros_tables.h"

namespace touchstone::importing {
namespace {

constexpr std::string_view mcap_magic = "\x89MCAP0\r\n";

enum McapRecord : unsigned char {
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  data_end = 0x0f
};

std::uint32_t crc_of(std::string_view bytes) {
  uLong crc = crc32(0, nullptr, 0);
  constexpr std::size_t piece = std::numeric_limits<uInt>::max();
  for (; !bytes.empty(); bytes.remove_prefix(std::min(piece, bytes.size()))) {
    const auto size = static_cast<uInt>(std::min(piece, bytes.size()));
    crc = crc32(crc, reinterpret_cast<const Bytef*>(bytes.data()), size);
  }
  return static_cast<std::uint32_t>(crc);
}

class McapReader {
 public:
  McapReader(std::string source, std::string_view file)
      : source_(std::move(source)), file_(file), tables_(source_, "ROS 2 bag (MCAP)") {}

  std::vector<ImportTable> read() {
    if (file_.size() < 2 * mcap_magic.size() || !file_.ends_with(mcap_magic)) {
      throw BadData(fmt::format(
          "{}: ends at byte {} without the mark of a file that was closed: it was cut short, or its recorder "
          "was; `mcap recover` saves what there is",
          source_, file_.size()));
    }
    std::string_view rest = file_.substr(mcap_magic.size(), file_.size() - 2 * mcap_magic.size());
    bool ended = false;
    while (!rest.empty() && !ended) {
      at_ = rest.data();
      const auto opcode = take<unsigned char>(rest);
      std::string_view content = take_bytes(rest, take<std::uint64_t>(rest));
      if (opcode == chunk) {
        read_chunk(content);
      } else if (opcode == data_end) {
        const auto crc = take<std::uint32_t>(content);
        const auto before = static_cast<std::size_t>(at_ - file_.data());
        if (crc != 0 && crc != crc_of(file_.substr(0, before)))
          damaged("the check sum of the data before it is another");
        ended = true;
      } else {
        read_record(opcode, content);
      }
    }
    if (!ended) damaged("no record ends the data");
    return tables_.finish();
  }

 private:
  struct Channel {
    std::string topic, type, encoding;
  };

  [[noreturn]] void damaged(const std::string& why) const {
    const bool in_chunk = !chunk_.empty() && at_ >= chunk_.data() && at_ <= chunk_.data() + chunk_.size();
    const std::string place = in_chunk ? fmt::format("byte {} of the chunk at byte {}", at_ - chunk_.data(), chunk_at_)
                                       : fmt::format("byte {}", at_ - file_.data());
    throw BadData(fmt::format("{}: damaged MCAP file: the record at {}: {}; `mcap recover` may save the rest", source_,
                              place, why));
  }
  template <class T>
  T take(std::string_view& bytes) const {
    if (bytes.size() < sizeof(T)) damaged("it ends too early");
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    bytes.remove_prefix(sizeof(T));
    return value;
  }
  std::string_view take_bytes(std::string_view& bytes, std::uint64_t size) const {
    if (size > bytes.size()) damaged(fmt::format("it has {} bytes where {} are left", size, bytes.size()));
    const std::string_view taken = bytes.substr(0, static_cast<std::size_t>(size));
    bytes.remove_prefix(taken.size());
    return taken;
  }
  std::string_view take_text(std::string_view& bytes) const { return take_bytes(bytes, take<std::uint32_t>(bytes)); }

  void read_chunk(std::string_view content) {
    take_bytes(content, 2 * sizeof(std::uint64_t));  // times of its first and last message
    const auto size = take<std::uint64_t>(content);
    const auto crc = take<std::uint32_t>(content);
    const std::string_view compression = take_text(content);
    const std::string_view packed = take_bytes(content, take<std::uint64_t>(content));
    std::optional<std::string> unpacked;
    if (!compression.empty()) {
      if (compression != "lz4" && compression != "zstd") {
        damaged(fmt::format("a chunk is compressed by '{}'; lz4 and zstd are known", compression));
      }
      unpacked = unpack_chunk(packed, compression, size);
      if (!unpacked) damaged(fmt::format("its {} bytes of data do not unpack to {} bytes", packed.size(), size));
    }
    std::string_view records = unpacked ? std::string_view(*unpacked) : packed;
    if (crc != 0 && crc != crc_of(records)) damaged("the check sum of its records is another");
    chunk_ = records;
    chunk_at_ = static_cast<std::size_t>(at_ - file_.data());
    while (!records.empty()) {
      at_ = records.data();
      const auto opcode = take<unsigned char>(records);
      read_record(opcode, take_bytes(records, take<std::uint64_t>(records)));
    }
    chunk_ = {};
  }

  void read_record(unsigned char opcode, std::string_view content) {
    if (opcode == schema) {
      const auto id = take<std::uint16_t>(content);
      schemas_[id] = take_text(content);
    } else if (opcode == channel) {
      const auto id = take<std::uint16_t>(content);
      const auto of_schema = schemas_.find(take<std::uint16_t>(content));
      Channel one{.topic = std::string(take_text(content)),
                  .type = of_schema == schemas_.end() ? "" : of_schema->second,
                  .encoding = std::string(take_text(content))};
      if (!channels_.contains(id)) tables_.note_topic(one.topic, one.type + ", " + one.encoding);
      channels_.insert_or_assign(id, std::move(one));
    } else if (opcode == message) {
      const auto of_channel = channels_.find(take<std::uint16_t>(content));
      if (of_channel == channels_.end()) damaged("a message belongs to no channel");
      take<std::uint32_t>(content);  // its number
      const double t_s = 1e-9 * static_cast<double>(take<std::uint64_t>(content));
      take<std::uint64_t>(content);  // when it was published
      const auto& [topic, type, encoding] = of_channel->second;
      if (encoding != "cdr" && encoding != "ros1") return;
      tables_.add(topic, type, encoding == "cdr" ? RosEncoding::cdr : RosEncoding::ros1,
                  std::as_bytes(std::span(content)), t_s);
    }
  }

  std::string source_;
  std::string_view file_, chunk_;  // the whole file; the unpacked chunk that is read
  const char* at_ = nullptr;       // the record that is read
  std::size_t chunk_at_ = 0;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  RosTables tables_;
};

}  // namespace

std::vector<ImportTable> read_mcap_file(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  return McapReader(path.string(), bytes).read();
}

}  // namespace touchstone::importing
