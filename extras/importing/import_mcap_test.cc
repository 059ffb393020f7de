// Files with the bytes that the specification of MCAP asks for (mcap.dev/spec: Header, Schema, Channel, Message, Chunk,
// DataEnd, Footer), with messages in CDR.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cstring>

#include "compressed_for_test.h"
#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string mcap_mark = "\x89MCAP0\r\n";

template <class T>
std::string little(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}
std::string counted(const std::string& text) { return little(static_cast<std::uint32_t>(text.size())) + text; }
std::string mcap_record(char opcode, const std::string& content) {
  return opcode + little(static_cast<std::uint64_t>(content.size())) + content;
}
std::uint32_t crc(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

std::string wrench_cdr(std::int32_t sec, std::uint32_t nsec, double fz) {
  std::string m = little(sec) + little(nsec) + counted(std::string("tool0\0", 6));
  while (m.size() % 8 != 0) m += '\0';
  for (const double v : {0.5, -0.25, fz, 0.01, 0.02, 0.03}) m += little(v);
  return std::string("\0\1\0\0", 4) + m;
}

std::string mcap_message(std::uint16_t channel, std::uint64_t log_ns, const std::string& data) {
  return mcap_record('\x05', little(channel) + little(std::uint32_t{1}) + little(log_ns) + little(log_ns) + data);
}

// A schema, a channel of wrenches and one of text, and messages of which the last was recorded first.
std::string mcap_records() {
  std::string bytes = mcap_record('\x03', little(std::uint16_t{4}) + counted("geometry_msgs/msg/WrenchStamped") +
                                              counted("ros2msg") + counted("std_msgs/Header header"));
  bytes += mcap_record(
      '\x04', little(std::uint16_t{0}) + little(std::uint16_t{4}) + counted("/ft") + counted("cdr") + counted(""));
  bytes += mcap_record(
      '\x04', little(std::uint16_t{1}) + little(std::uint16_t{0}) + counted("/log") + counted("json") + counted(""));
  for (const std::int32_t i : {1, 2, 3, 0}) {
    bytes += mcap_message(0, static_cast<std::uint64_t>(i) * 4000000U,
                          wrench_cdr(30, static_cast<std::uint32_t>(i) * 4000000U, 1.5 * i));
    bytes += mcap_message(1, 5, "{}");
  }
  return bytes;
}

std::string mcap_of(const std::string& data) {
  const std::string begin = mcap_mark + mcap_record('\x01', counted("ros2") + counted("test")) + data;
  return begin + mcap_record('\x0f', little(crc(begin))) + mcap_record('\x02', std::string(20, '\0')) + mcap_mark;
}

std::string mcap_chunk(const std::string& compression, const std::string& packed, std::uint64_t size,
                       std::uint32_t sum) {
  return mcap_record('\x06', little(std::uint64_t{0}) + little(std::uint64_t{9}) + little(size) + little(sum) +
                                 counted(compression) + little(static_cast<std::uint64_t>(packed.size())) + packed);
}

std::filesystem::path mcap_path(const std::string& bytes) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-import-mcap-{}", ::getpid());
  ensure_writable_folder(folder);
  write_file(folder / "run.mcap", bytes);
  return folder / "run.mcap";
}

std::string mcap_refusal(const std::string& bytes) {
  try {
    read_foreign(mcap_path(bytes), {});
  } catch (const BadData& e) {
    return e.what();
  }
  return "no error";
}

TEST(McapFile, WrenchesWithAndWithoutChunksInTheOrderOfRecording) {
  const std::string records = mcap_records();
  for (const std::string& file : {mcap_of(records), mcap_of(mcap_chunk("", records, records.size(), crc(records))),
                                  mcap_of(mcap_chunk("lz4", compressed(records, "lz4"), records.size(), crc(records))),
                                  mcap_of(mcap_chunk("zstd", compressed(records, "zstd"), records.size(), 0))}) {
    const auto tables = read_foreign(mcap_path(file), {});
    ASSERT_EQ(tables.size(), 1U);
    EXPECT_EQ(tables[0].name, "/ft");
    EXPECT_THAT(tables[0].columns[0], ElementsAre(30.0, 30.004, 30.008, 30.012));
    EXPECT_THAT(tables[0].columns[3], ElementsAre(0.0, 1.5, 3.0, 4.5));
    EXPECT_THAT(tables[0].columns[6], ElementsAre(0.03, 0.03, 0.03, 0.03));
    EXPECT_THAT(guess_map(mcap_path(file)).decide, ElementsAre());
  }
}

TEST(McapFile, CutAnywhereIsRefused) {
  const std::string whole = mcap_of(mcap_records());
  for (std::size_t n = 8; n < whole.size(); n += 3) {
    ASSERT_THAT(mcap_refusal(whole.substr(0, n)), HasSubstr("it was cut short")) << n;
  }
}

TEST(McapFile, DamageIsNamedWithItsPlace) {
  const std::string records = mcap_records();
  std::string changed = mcap_of(records);
  changed[changed.find("tool0")] = 'p';
  EXPECT_THAT(mcap_refusal(changed), HasSubstr("check sum of the data"));
  EXPECT_THAT(mcap_refusal(mcap_of(mcap_chunk("", records, records.size(), crc(records) + 1))),
              HasSubstr("check sum of its records"));
  const std::string packed = compressed(records, "lz4");
  for (const std::uint64_t size : {records.size() - 1, records.size() + 1, std::size_t{1} << 60}) {
    EXPECT_THAT(mcap_refusal(mcap_of(mcap_chunk("lz4", packed, size, 0))), HasSubstr("do not unpack"));
  }
  EXPECT_THAT(mcap_refusal(mcap_of(mcap_chunk("br", packed, 5, 0))), HasSubstr("compressed by 'br'"));
  EXPECT_THAT(mcap_refusal(mcap_of("\x05" + little(std::uint64_t{1} << 50) + "abc")), HasSubstr("bytes where"));
  EXPECT_THAT(mcap_refusal(mcap_of(mcap_message(9, 1, "x"))), HasSubstr("belongs to no channel"));
  EXPECT_THAT(mcap_refusal(mcap_of("")), HasSubstr("its topics: none"));
}

}  // namespace
}  // namespace touchstone::importing
