// Bags of ROS 2 in SQLite storage (rosbag2_storage_default_plugins: tables topics and messages, payloads in CDR).
#include <fmt/format.h>
#include <sqlite3.h>

#include <array>
#include <fstream>
#include <map>
#include <memory>

#include "harness/base/error.h"
#include "import_table.h"
#include "ros_tables.h"

namespace touchstone::importing {
namespace {

struct DatabaseClose {
  void operator()(sqlite3* db) const { sqlite3_close(db); }
};
struct StatementClose {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using RosStatement = std::unique_ptr<sqlite3_stmt, StatementClose>;

// SQLite's own words for a file that was cut name no place; its header does (sqlite.org/fileformat2.html, 1.3): the
// size of a page at byte 16 (1: 65536), the pages of the file at byte 28, which counts if the change counter at byte 24
// is that at byte 92. All big-endian.
void refuse_cut_database(const std::filesystem::path& path) {
  constexpr std::size_t header_bytes = 100;
  std::array<unsigned char, header_bytes> header{};
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(header.data()), header.size());
  const std::uintmax_t bytes = std::filesystem::file_size(path);
  if (!in) {
    throw BadData(fmt::format("{}: ends at byte {}, within the header of {} bytes: was the file cut short?",
                              path.string(), bytes, header_bytes));
  }
  const auto number = [&](std::size_t at) {
    return std::uint32_t{header[at]} << 24U | std::uint32_t{header[at + 1]} << 16U |
           std::uint32_t{header[at + 2]} << 8U | std::uint32_t{header[at + 3]};
  };
  const std::uint32_t declared = std::uint32_t{header[16]} << 8U | header[17];
  const std::uintmax_t page_bytes = declared == 1 ? 65536 : declared, pages = number(28);
  const bool counts = pages > 0 && number(24) == number(92);
  if (!counts || bytes >= pages * page_bytes) return;
  throw BadData(
      fmt::format("{}: ends at byte {}, within page {} of the {} that its header declares ({} bytes each, {} in "
                  "all): was the file cut short?",
                  path.string(), bytes, bytes / page_bytes + 1, pages, page_bytes, pages * page_bytes));
}

std::string column_text(sqlite3_stmt* statement, int column) {
  const unsigned char* const text = sqlite3_column_text(statement, column);
  return text == nullptr ? std::string() : reinterpret_cast<const char*>(text);
}

}  // namespace

std::vector<ImportTable> read_ros2_database(const std::filesystem::path& path) {
  refuse_cut_database(path);
  sqlite3* raw = nullptr;
  const int opened = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, DatabaseClose> db(raw);
  const auto fail = [&](std::string_view doing) {
    throw BadData(fmt::format("{}: {}: {}; is it the .db3 file of a ROS 2 bag, and complete?", path.string(), doing,
                              sqlite3_errmsg(db.get())));
  };
  if (opened != SQLITE_OK) fail("cannot be opened as an SQLite database");
  // The file is a stranger's: its schema may call no functions, and no value is larger than a file may be.
  sqlite3_db_config(db.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(db.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  const auto prepare = [&](const char* query) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db.get(), query, -1, &statement, nullptr) != SQLITE_OK) fail("is no ROS 2 bag");
    return RosStatement(statement);
  };
  struct Topic {
    std::string name, type;
  };
  std::map<std::int64_t, Topic> topics;
  RosTables tables(path.string(), "ROS 2 bag");
  const auto topic_rows = prepare("SELECT id, name, type, serialization_format FROM topics");
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(topic_rows.get())) == SQLITE_ROW) {
    const std::string format = column_text(topic_rows.get(), 3), name = column_text(topic_rows.get(), 1);
    if (format != "cdr") {
      throw BadData(fmt::format("{}: topic {} is serialized as '{}'; cdr was expected", path.string(), name, format));
    }
    Topic& topic = topics[sqlite3_column_int64(topic_rows.get(), 0)];
    topic.name = name, topic.type = column_text(topic_rows.get(), 2);
    tables.note_topic(topic.name, topic.type);
  }
  if (step != SQLITE_DONE) fail("its topics cannot be read");
  const auto messages = prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id");
  while ((step = sqlite3_step(messages.get())) == SQLITE_ROW) {
    const auto found = topics.find(sqlite3_column_int64(messages.get(), 0));
    if (found == topics.end()) throw BadData(fmt::format("{}: a message belongs to no topic", path.string()));
    const auto* const blob = static_cast<const std::byte*>(sqlite3_column_blob(messages.get(), 2));
    const std::span bytes(blob, static_cast<std::size_t>(sqlite3_column_bytes(messages.get(), 2)));
    const double t_s = 1e-9 * static_cast<double>(sqlite3_column_int64(messages.get(), 1));
    tables.add(found->second.name, found->second.type, RosEncoding::cdr, bytes, t_s);
  }
  if (step != SQLITE_DONE) fail("cannot be read to its end");
  return tables.finish();
}

}  // namespace touchstone::importing
