// Bags of ROS 1, format 2.0 (wiki.ros.org/Bags/Format/2.0): records of a header and data; chunks hold records, plain or
// compressed (bz2 and lz4, undone by libarchive). Messages of forces and poses become one table for each topic.
#include <fmt/format.h>

#include <cstring>
#include <map>
#include <string_view>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"
#include "ros_tables.h"

namespace touchstone::importing {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";

using Fields = std::map<std::string, std::string_view, std::less<>>;

class BagReader {
 public:
  BagReader(std::string source, std::string_view file)
      : source_(std::move(source)), file_(file), tables_(source_, "ROS 1 bag") {}

  void read() {
    read_records(file_.substr(magic.size()), false);
    // A bag that was closed says where its index begins and how many chunks lie before it; one that was not has 0.
    if (index_at_ > file_.size()) {
      throw BadData(
          fmt::format("{}: ends at byte {} where its index begins at byte {}: it was cut short; copy it again", source_,
                      file_.size(), index_at_));
    }
    if (index_at_ > 0 && chunks_read_ != chunk_count_) {
      throw BadData(
          fmt::format("{}: holds {} chunks where its head says {}; `rosbag reindex` or `rosbag fix` may repair "
                      "it",
                      source_, chunks_read_, chunk_count_));
    }
  }

  std::vector<ImportTable> finish() { return tables_.finish(); }

 private:
  struct Topic {
    std::string name, type;
  };

  void read_records(std::string_view bytes, bool within_chunk) {
    while (!bytes.empty()) {
      at_ = bytes.data();
      if (!within_chunk) bytes = without_padding(bytes);
      const std::string_view header = take_block(bytes);
      const std::string_view data = take_block(bytes);
      const Fields fields = fields_of(header);
      const std::string_view op = need(fields, "op");
      if (op == "\x03" && !within_chunk) {
        index_at_ = number<std::uint64_t>(need(fields, "index_pos"));
        chunk_count_ = number<std::uint32_t>(need(fields, "chunk_count"));
      } else if (op == "\x05" && !within_chunk) {
        ++chunks_read_;
        const std::string_view how = need(fields, "compression");
        chunk_at_ = at_;
        if (how == "none") {
          read_records(data, true);
        } else {
          const std::string unpacked_bytes = unpacked(data, how, number<std::uint32_t>(need(fields, "size")));
          chunk_ = unpacked_bytes;
          read_records(unpacked_bytes, true);
          chunk_ = {};
        }
      } else if (op == "\x07") {
        const Fields connection = fields_of(data);
        Topic topic{std::string(need(fields, "topic")), std::string(need(connection, "type"))};
        const auto id = number<std::uint32_t>(need(fields, "conn"));
        // The index repeats them.
        if (!topics_.contains(id)) tables_.note_topic(topic.name, topic.type);
        topics_.insert_or_assign(id, std::move(topic));
      } else if (op == "\x02") {
        add_message(fields, data);
      }
    }
  }

  // Zeros before the index, as an index that was written anew leaves them.
  [[nodiscard]] std::string_view without_padding(std::string_view bytes) const {
    const auto before = bytes.data() - file_.data();
    if (index_at_ <= static_cast<std::uint64_t>(before) || index_at_ > file_.size()) return bytes;
    const auto left = index_at_ - static_cast<std::uint64_t>(before);
    return bytes.find_first_not_of('\0') == left ? bytes.substr(left) : bytes;
  }

  [[noreturn]] void damaged(std::string_view why) const {
    // The record that is read lies in the file, or in an unpacked chunk of it.
    const bool in_chunk = !chunk_.empty() && at_ >= chunk_.data() && at_ <= chunk_.data() + chunk_.size();
    const std::string place =
        in_chunk ? fmt::format("byte {} of the chunk at byte {}", at_ - chunk_.data(), chunk_at_ - file_.data())
                 : fmt::format("byte {}", at_ - file_.data());
    throw BadData(fmt::format("{}: damaged bag: the record at {}: {}; `rosbag reindex` or `rosbag fix` may repair it",
                              source_, place, why));
  }
  template <class T>
  T number(std::string_view bytes) const {
    if (bytes.size() != sizeof(T)) damaged("a field has the wrong size");
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  std::string_view take_block(std::string_view& bytes) const {
    if (bytes.size() < 4) damaged("it ends within a record");
    const auto length = number<std::uint32_t>(bytes.substr(0, 4));
    bytes.remove_prefix(4);
    if (length > bytes.size()) damaged("it ends within a record");
    const std::string_view block = bytes.substr(0, length);
    bytes.remove_prefix(length);
    return block;
  }
  Fields fields_of(std::string_view header) const {
    Fields fields;
    while (!header.empty()) {
      const std::string_view field = take_block(header);
      const auto equals = field.find('=');
      if (equals == std::string_view::npos) damaged("a header has a field without a name");
      fields.emplace(field.substr(0, equals), field.substr(equals + 1));
    }
    return fields;
  }
  std::string_view need(const Fields& fields, std::string_view name) const {
    const auto found = fields.find(name);
    if (found == fields.end()) damaged(fmt::format("a record has no field {}", name));
    return found->second;
  }

  std::string unpacked(std::string_view data, std::string_view how, std::uint32_t size) const {
    if (how != "bz2" && how != "lz4") {
      damaged(fmt::format("a chunk is compressed by '{}'; none, bz2 and lz4 are known", how));
    }
    auto out = unpack_chunk(data, how, size);
    if (!out) damaged(fmt::format("its {} bytes of data do not unpack to {} bytes", data.size(), size));
    return std::move(*out);
  }

  void add_message(const Fields& fields, std::string_view data) {
    const auto topic = topics_.find(number<std::uint32_t>(need(fields, "conn")));
    if (topic == topics_.end()) damaged("a message belongs to no topic");
    const std::string_view time = need(fields, "time");
    if (time.size() != 8) damaged("a time has the wrong size");
    const double t_s = number<std::uint32_t>(time.substr(0, 4)) + 1e-9 * number<std::uint32_t>(time.substr(4));
    tables_.add(topic->second.name, topic->second.type, RosEncoding::ros1, std::as_bytes(std::span(data)), t_s);
  }

  std::string source_;
  std::string_view file_, chunk_;  // the whole file; the unpacked chunk that is read
  const char* at_ = nullptr;       // the record that is read
  const char* chunk_at_ = nullptr;
  std::uint64_t index_at_ = 0;
  std::uint32_t chunk_count_ = 0, chunks_read_ = 0;
  std::map<std::uint32_t, Topic> topics_;
  RosTables tables_;
};

}  // namespace

std::vector<ImportTable> read_ros_bag(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  if (!bytes.starts_with(magic)) {
    throw BadData(
        fmt::format("{}: is no bag of version 2.0 ('#ROSBAG V2.0'); `rosbag migrate` makes one of an older "
                    "bag",
                    path.string()));
  }
  BagReader reader(path.string(), bytes);
  reader.read();
  return reader.finish();
}

}  // namespace touchstone::importing
