// Bags with the bytes that the formats' own descriptions ask for: version 2.0 of ROS 1 (wiki.ros.org/Bags/Format/2.0,
// messages as wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes has them) and the SQLite storage of
// ROS 2 (rosbag2_storage_default_plugins, tables topics and messages; payloads in CDR).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cstring>

#include "column_name.h"
#include "compressed_for_test.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"
#include "ros_message.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path bag_folder() {
  auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-import-bag-{}", ::getpid());
  ensure_writable_folder(path);
  return path;
}

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}
std::string block(const std::string& bytes) { return raw(static_cast<std::uint32_t>(bytes.size())) + bytes; }
std::string field(const std::string& name, const std::string& value) { return block(name + "=" + value); }
std::string record(const std::string& header, const std::string& data) { return block(header) + block(data); }

std::string wrench_ros1(std::uint32_t sec, std::uint32_t nsec, double fz) {
  std::string m = raw(std::uint32_t{7}) + raw(sec) + raw(nsec) + block("ft_sensor");
  for (const double v : {0.5, -0.25, fz, 0.01, 0.02, 0.03}) m += raw(v);
  return m;
}

std::string bag_records() {
  std::string bytes = record(field("op", "\x07") + field("conn", raw(std::uint32_t{0})) + field("topic", "/ft"),
                             field("topic", "/ft") + field("type", "geometry_msgs/WrenchStamped") +
                                 field("md5sum", "d78d3cb249ce23087ade7e7d0c40cfa7") + field("message_definition", ""));
  for (std::uint32_t i = 0; i < 3; ++i) {
    bytes += record(field("op", "\x02") + field("conn", raw(std::uint32_t{0})) +
                        field("time", raw(std::uint32_t{100}) + raw(i * 1000000U)),
                    wrench_ros1(99, i * 500000000U, i));
  }
  return bytes;
}

// `index_at`: where the index is said to begin; 0 in a bag that was not closed.
std::string bag_of(const std::string& compression, const std::string& chunk, std::size_t size,
                   std::uint64_t index_at = 0, std::uint32_t chunks = 1) {
  return "#ROSBAG V2.0\n" +
         record(field("op", "\x03") + field("index_pos", raw(index_at)) + field("conn_count", raw(std::uint32_t{1})) +
                    field("chunk_count", raw(chunks)),
                std::string(64, ' ')) +
         record(field("op", "\x05") + field("compression", compression) +
                    field("size", raw(static_cast<std::uint32_t>(size))),
                chunk);
}

std::string bag_refusal(const std::string& bytes) {
  const auto path = bag_folder() / "bad.bag";
  write_file(path, bytes);
  try {
    read_ros_bag(path);
  } catch (const BadData& e) {
    return e.what();
  }
  return "no error";
}

TEST(RosBag, WrenchesOfAllCompressions) {
  const std::string records = bag_records();
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    const auto path = bag_folder() / (compression + ".bag");
    write_file(path, bag_of(compression,
                            compression == "none" ? records
                                                  : compressed(records, compression == "bz2" ? "bzip2" : compression),
                            records.size()));
    const auto tables = read_foreign(path, {});
    ASSERT_EQ(tables.size(), 1U) << compression;
    EXPECT_EQ(tables[0].name, "/ft");
    EXPECT_THAT(tables[0].names, ElementsAre("t", "force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"));
    EXPECT_THAT(tables[0].columns[0], ElementsAre(99.0, 99.5, 100.0));
    EXPECT_THAT(tables[0].columns[3], ElementsAre(0.0, 1.0, 2.0));
    EXPECT_THAT(tables[0].columns[6], ElementsAre(0.03, 0.03, 0.03));
  }
}

TEST(RosMessage, ATypeOfAnotherPackageIsAnother) {
  EXPECT_TRUE(ros_columns("turtlesim/Pose", RosEncoding::ros1, {}).empty());
  EXPECT_EQ(ros_columns("geometry_msgs/Pose", RosEncoding::ros1, {}).size(), 8U);
  // nav_msgs/Odometry: header, child_frame_id, the pose and its covariance, the twist and its covariance.
  EXPECT_EQ(ros_columns("nav_msgs/msg/Odometry", RosEncoding::cdr, {}).size(), 8U);
  std::string odometry =
      raw(std::uint32_t{1}) + raw(std::uint32_t{50}) + raw(std::uint32_t{0}) + block("odom") + block("base");
  for (int i = 0; i < 7 + 36 + 6 + 36; ++i) odometry += raw(0.125 * i);
  const auto values = ros_values("nav_msgs/Odometry", RosEncoding::ros1, std::as_bytes(std::span(odometry)), 0.0, "");
  EXPECT_THAT(values, ElementsAre(50.0, 0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75));
  // A point is a position, a vector may be of gravity or of a magnet.
  EXPECT_EQ(ros_columns("geometry_msgs/PointStamped", RosEncoding::ros1, {})[1], "point.x");
  EXPECT_EQ(ros_columns("geometry_msgs/Vector3Stamped", RosEncoding::ros1, {})[1], "vector.x");
  EXPECT_TRUE(parse_column_name("point.x").is(Quantity::position));
  EXPECT_TRUE(parse_column_name("vector.x").quantities.empty());
}

TEST(RosBag, CutAnywhereIsRefused) {
  const std::string records = bag_records();
  const std::string whole = bag_of("none", records, records.size());
  const auto path = bag_folder() / "cut.bag";
  int refused = 0;
  for (std::size_t size = 13; size + 1 < whole.size(); size += 7) {
    write_file(path, whole.substr(0, size));
    try {
      read_ros_bag(path);
    } catch (const BadData& e) {
      EXPECT_THAT(e.what(), HasSubstr("cut.bag"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
  for (const std::string bytes : {"#ROSBAG V1.2\nold", "nothing"}) {
    write_file(path, bytes);
    EXPECT_THROW(read_ros_bag(path), BadData);
  }
}

TEST(RosBag, AClosedBagThatWasCutIsRefusedAtEveryByte) {
  const std::string records = bag_records();
  const std::size_t size = bag_of("none", records, records.size()).size();
  const std::string whole = bag_of("none", records, records.size(), size);
  EXPECT_EQ(bag_refusal(whole), "no error");
  // Zeros before an index that was written anew.
  const std::string padded = bag_of("none", records, records.size(), size + 21) + std::string(21, '\0') + records;
  EXPECT_EQ(bag_refusal(padded), "no error");
  for (std::size_t n = 14; n < whole.size(); ++n) ASSERT_NE(bag_refusal(whole.substr(0, n)), "no error") << n;
  EXPECT_THAT(bag_refusal(bag_of("none", records, records.size(), size, 2)),
              HasSubstr("holds 1 chunks where its head says 2"));
}

TEST(RosBag, DamageIsNamedWithItsByte) {
  const std::string records = bag_records();
  const std::string whole = bag_of("none", records, records.size());
  EXPECT_THAT(bag_refusal(whole + "\xff\xff\xff\x7f"), HasSubstr(fmt::format("the record at byte {}", whole.size())));
  const std::string inner = records + "\xff\xff\xff\x7f";
  EXPECT_THAT(bag_refusal(bag_of("bz2", compressed(inner, "bzip2"), inner.size())),
              HasSubstr(fmt::format("the record at byte {} of the chunk at byte ", records.size())));
  // A size of gigabytes for a chunk of kilobytes.
  EXPECT_THAT(bag_refusal(bag_of("lz4", compressed(records, "lz4"), 4000000000U)),
              HasSubstr("do not unpack to 4000000000 bytes"));
  EXPECT_THAT(bag_refusal(bag_of("lz4", compressed(records, "lz4"), records.size() - 1)), HasSubstr("do not unpack"));
  EXPECT_THAT(bag_refusal(bag_of("zip", records, records.size())), HasSubstr("compressed by 'zip'"));
}

std::string pose_cdr(std::int32_t sec, std::uint32_t nsec, const std::string& frame, double x) {
  std::string m = raw(sec) + raw(nsec) + raw(static_cast<std::uint32_t>(frame.size() + 1)) + frame + '\0';
  while (m.size() % 8 != 0) m += '\0';
  for (const double v : {x, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8}) m += raw(v);
  return std::string("\0\1\0\0", 4) + m;
}

std::string database_refusal(const std::filesystem::path& path) {
  try {
    read_foreign(path, {});
  } catch (const BadData& e) {
    return e.what();
  }
  return "no error";
}

TEST(Ros2Database, PosesWithNamesOfEveryLength) {
  const auto path = bag_folder() / "poses.db3";
  std::filesystem::remove(path);
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  const auto run = [&](const char* sql) { ASSERT_EQ(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK); };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT "
      "NOT "
      "NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB "
      "NOT "
      "NULL)");
  run("INSERT INTO topics VALUES(1, '/pose', 'geometry_msgs/msg/PoseStamped', 'cdr', '')");
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, ?)", -1, &insert, nullptr);
  for (int i = 0; i < 12; ++i) {
    const std::string message = pose_cdr(50 + i, 250000000, std::string(static_cast<std::size_t>(i), 'f'), i);
    sqlite3_bind_int64(insert, 1, 1000000000LL * i);
    sqlite3_bind_blob(insert, 2, message.data(), static_cast<int>(message.size()), SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  sqlite3_close(db);
  const auto tables = read_foreign(path, {});
  ASSERT_EQ(tables.size(), 1U);
  ASSERT_EQ(tables[0].rows(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(tables[0].columns[0][i], 50.25 + static_cast<double>(i));
    EXPECT_EQ(tables[0].columns[1][i], static_cast<double>(i));
    EXPECT_EQ(tables[0].columns[7][i], 0.8);
  }
  const std::string whole = read_file(path);
  write_file(path, whole.substr(0, 5000));
  EXPECT_THAT(database_refusal(path),
              HasSubstr(fmt::format("ends at byte 5000, within page 2 of the {} that its header "
                                    "declares (4096 bytes each, {} in all)",
                                    whole.size() / 4096, whole.size())));
  for (std::size_t size = 16; size < whole.size(); size += 1000) {
    write_file(path, whole.substr(0, size));
    EXPECT_THAT(database_refusal(path), HasSubstr(fmt::format("ends at byte {}", size)));
  }
  write_file(path, "SQLite format 3");
  EXPECT_THAT(database_refusal(path), HasSubstr("within the header of 100 bytes"));
}

}  // namespace
}  // namespace touchstone::importing
