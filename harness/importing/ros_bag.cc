// Bags of ROS 1, format 2.0 (wiki.ros.org/Bags/Format/2.0): records of a header and data; chunks hold records, plain or
// compressed (bz2 and lz4, undone by libarchive). Messages of forces and poses become one table for each topic.
#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <cstring>
#include <map>
#include <memory>
#include <string_view>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/importing/import_table.h"
#include "harness/importing/ros_message.h"

namespace touchstone::importing {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";

using Fields = std::map<std::string, std::string_view, std::less<>>;

class BagReader {
 public:
  explicit BagReader(std::string source) : source_(std::move(source)) {}

  void read_records(std::string_view bytes, bool within_chunk) {
    while (!bytes.empty()) {
      const std::string_view header = take_block(bytes);
      const std::string_view data = take_block(bytes);
      const Fields fields = fields_of(header);
      const std::string_view op = need(fields, "op");
      if (op == "\x05" && !within_chunk) {
        const std::string_view how = need(fields, "compression");
        if (how == "none") {
          read_records(data, true);
        } else {
          read_records(unpacked(data, how, number<std::uint32_t>(need(fields, "size"))), true);
        }
      } else if (op == "\x07") {
        const Fields connection = fields_of(data);
        topics_[number<std::uint32_t>(need(fields, "conn"))] = {std::string(need(fields, "topic")),
                                                                std::string(need(connection, "type"))};
      } else if (op == "\x02") {
        add_message(fields, data);
      }
    }
  }

  std::vector<ImportTable> finish() {
    std::vector<ImportTable> all;
    for (auto& [topic, table] : tables_) all.push_back(std::move(table));
    if (!all.empty()) return all;
    std::string list;
    for (const auto& [id, topic] : topics_) {
      list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", topic.name, topic.type);
    }
    throw BadData(fmt::format("{}: no topic has messages of a force or pose that can be read; its topics: {}", source_,
                              list.empty() ? "none" : list));
  }

 private:
  struct Topic {
    std::string name, type;
  };

  [[noreturn]] void damaged(std::string_view why) const {
    throw BadData(fmt::format("{}: damaged bag: {}; `rosbag reindex` or `rosbag fix` may repair it", source_, why));
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

  std::string_view unpacked(std::string_view data, std::string_view how, std::uint32_t size) {
    const std::unique_ptr<archive, int (*)(archive*)> in(archive_read_new(), archive_read_free);
    archive_read_support_format_raw(in.get());
    if (how == "bz2") {
      archive_read_support_filter_bzip2(in.get());
    } else if (how == "lz4") {
      archive_read_support_filter_lz4(in.get());
    } else {
      damaged(fmt::format("a chunk is compressed by '{}'; none, bz2 and lz4 are known", how));
    }
    archive_entry* entry = nullptr;
    std::string out(size, '\0');
    std::size_t got = 0;
    if (archive_read_open_memory(in.get(), data.data(), data.size()) == ARCHIVE_OK &&
        archive_read_next_header(in.get(), &entry) == ARCHIVE_OK) {
      while (got < out.size()) {
        const auto more = archive_read_data(in.get(), out.data() + got, out.size() - got);
        if (more <= 0) break;
        got += static_cast<std::size_t>(more);
      }
    }
    if (got != size) damaged(fmt::format("a chunk does not unpack to its {} bytes", size));
    chunks_.push_back(std::make_unique<std::string>(std::move(out)));
    return *chunks_.back();
  }

  void add_message(const Fields& fields, std::string_view data) {
    const auto topic = topics_.find(number<std::uint32_t>(need(fields, "conn")));
    if (topic == topics_.end()) damaged("a message belongs to no topic");
    const std::string_view time = need(fields, "time");
    if (time.size() != 8) damaged("a time has the wrong size");
    const double t_s = number<std::uint32_t>(time.substr(0, 4)) + 1e-9 * number<std::uint32_t>(time.substr(4));
    const auto bytes = std::as_bytes(std::span(data));
    const auto& [name, type] = topic->second;
    auto table = tables_.find(name);
    if (table == tables_.end()) {
      ImportTable fresh;
      fresh.name = name;
      fresh.names = ros_columns(type, RosEncoding::ros1, bytes);
      if (fresh.names.empty()) return;
      fresh.columns.resize(fresh.names.size());
      fresh.source = source_;
      fresh.format = fmt::format("ROS 1 bag, {}", type);
      fresh.names_from_file = true;
      table = tables_.emplace(name, std::move(fresh)).first;
    }
    const std::string place = fmt::format("{}: topic {}, message {}", source_, name, table->second.rows() + 1);
    const auto values = ros_values(type, RosEncoding::ros1, bytes, t_s, place);
    if (values.size() != table->second.columns.size()) {
      throw BadData(
          fmt::format("{}: has {} values where the first had {}", place, values.size(), table->second.columns.size()));
    }
    for (std::size_t c = 0; c < values.size(); ++c) table->second.columns[c].push_back(values[c]);
  }

  std::string source_;
  std::map<std::uint32_t, Topic> topics_;
  std::map<std::string, ImportTable> tables_;
  std::vector<std::unique_ptr<std::string>> chunks_;
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
  BagReader reader(path.string());
  reader.read_records(std::string_view(bytes).substr(magic.size()), false);
  return reader.finish();
}

}  // namespace touchstone::importing
