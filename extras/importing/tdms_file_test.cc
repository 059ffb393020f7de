// .tdms files written here by NI's description of the format ("TDMS File Format Internal Structure"): segments that
// repeat what was said before, both orders of bytes, interleaved numbers, waveforms with their time.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::uint32_t metadata = 2, new_list = 4, raw_data = 8, interleaved = 32, big_endian = 64, daqmx = 128;
constexpr std::uint32_t int16_type = 2, float64_type = 10, string_type = 0x20;

class Writer {
 public:
  explicit Writer(bool big) : big_(big) {}

  template <class T>
  Writer& put(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (big_) std::ranges::reverse(bytes);
    bytes_ += bytes;
    return *this;
  }
  Writer& text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
    return *this;
  }
  // A channel's object with `count` numbers in each chunk, and `properties` that follow.
  Writer& channel(const std::string& path, std::uint32_t type, std::uint64_t count, std::uint32_t properties) {
    return text(path).put(std::uint32_t{20}).put(type).put(std::uint32_t{1}).put(count).put(properties);
  }
  Writer& property(const std::string& name, const std::string& value) {
    return text(name).put(string_type).text(value);
  }
  Writer& property(const std::string& name, double value) { return text(name).put(float64_type).put(value); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  bool big_;
  std::string bytes_;
};

std::string segment(std::uint32_t contents, const std::string& objects, const std::string& raw) {
  const bool big = (contents & big_endian) != 0;
  const std::string mask = Writer(false).put(contents).bytes();
  return "TDSm" + mask +
         Writer(big)
             .put(std::uint32_t{4713})
             .put(std::uint64_t{objects.size() + raw.size()})
             .put(std::uint64_t{objects.size()})
             .bytes() +
         objects + raw;
}

// Height in mm and Fz in N at 200 Hz from 0.5 s, two chunks of three; a note.
std::string force_objects(bool big) {
  Writer w(big);
  w.put(std::uint32_t{4});
  w.text("/").put(0xffffffffU).put(std::uint32_t{1}).property("name", "press");
  w.channel("/'Press'/'Height'", int16_type, 3, 3).property("unit_string", "mm");
  w.property("wf_increment", 0.005).property("wf_start_offset", 0.5);
  w.channel("/'Press'/'Fz'", float64_type, 3, 3).property("unit_string", "N");
  w.property("wf_increment", 0.005).property("wf_start_offset", 0.5);
  w.channel("/'It''s counts'/'ai0'", int16_type, 2, 1).property("NI_Scaling_Status", "unscaled");
  return w.bytes();
}

std::string force_chunk(bool big, std::int16_t first) {
  Writer w(big);
  for (int i = 0; i < 3; ++i) w.put(static_cast<std::int16_t>(first + i));
  for (int i = 0; i < 3; ++i) w.put(0.25 * (first + i));
  w.put(std::int16_t{7}).put(std::int16_t{8});
  return w.bytes();
}

std::filesystem::path tdms_path(const std::string& bytes) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-tdms-{}", ::getpid());
  ensure_writable_folder(folder);
  write_file(folder / "press.tdms", bytes);
  return folder / "press.tdms";
}

std::string tdms_refusal(const std::string& bytes) {
  try {
    read_foreign(tdms_path(bytes), {});
  } catch (const BadData& error) {
    return error.what();
  }
  return "no error";
}

TEST(TdmsFile, SegmentsChunksAndWaveforms) {
  for (const bool big : {false, true}) {
    const std::uint32_t order = big ? big_endian : 0;
    const std::string bytes =
        segment(metadata | new_list | raw_data | order, force_objects(big),
                force_chunk(big, -2) + force_chunk(big, 1)) +
        segment(raw_data | order, "", force_chunk(big, 40)) +
        // One channel changes its count; the others are as before.
        segment(metadata | raw_data | order,
                Writer(big).put(std::uint32_t{1}).channel("/'Press'/'Height'", int16_type, 1, 0).bytes(),
                Writer(big)
                    .put(std::int16_t{50})
                    .put(1.0)
                    .put(2.0)
                    .put(3.0)
                    .put(std::int16_t{7})
                    .put(std::int16_t{8})
                    .bytes());
    const auto tables = read_foreign(tdms_path(bytes), {});
    ASSERT_EQ(tables.size(), 2U);  // of 12 and of 10 samples
    EXPECT_THAT(tables[0].names, ElementsAre("waveform time", "Fz"));
    EXPECT_THAT(tables[1].names, ElementsAre("waveform time", "Height"));
    EXPECT_THAT(tables[1].columns[1], ElementsAre(-2, -1, 0, 1, 2, 3, 40, 41, 42, 50));
    EXPECT_EQ(tables[0].columns[1][10], 2.0);
    EXPECT_NEAR(tables[0].columns[0][11], 0.555, 1e-12);
    EXPECT_EQ(tables[1].description(1), "Height (mm)");
    EXPECT_THAT(tables[0].notes, ElementsAre(HasSubstr("It's counts:ai0 (raw counts")));
  }
}

TEST(TdmsFile, InterleavedNumbersAndADescribedRecording) {
  Writer objects(false), raw(false);
  objects.put(std::uint32_t{2});
  objects.channel("/'Untitled'/'z'", float64_type, 40, 2).property("unit_string", "mm").property("wf_increment", 0.01);
  objects.channel("/'Untitled'/'Fz'", int16_type, 40, 2).property("unit_string", "mN").property("wf_increment", 0.01);
  for (int i = 0; i < 40; ++i) raw.put(5 - 0.5 * i).put(static_cast<std::int16_t>(100 * i));
  const auto path = tdms_path(segment(metadata | new_list | raw_data | interleaved, objects.bytes(), raw.bytes()));
  const GuessedMap guess = guess_map(path);
  EXPECT_THAT(guess.decide, ElementsAre());
  ASSERT_TRUE(guess.read);
  EXPECT_THAT(guess.read->names, ElementsAre("t_s", "z_m", "fz_N"));
  EXPECT_NEAR(guess.read->columns[0][39], 0.39, 1e-12);
  EXPECT_NEAR(guess.read->columns[1][4], 0.003, 1e-15);
  EXPECT_NEAR(guess.read->columns[2][4], 0.4, 1e-12);
}

TEST(TdmsFile, AFileThatWasCutIsRefusedAtEveryByte) {
  const std::string first = segment(metadata | new_list | raw_data, force_objects(false), force_chunk(false, 1));
  const std::string whole = first + segment(raw_data, "", force_chunk(false, 4));
  EXPECT_EQ(tdms_refusal(whole), "no error");
  for (std::size_t n = 4; n < whole.size(); ++n) {
    const std::string said = tdms_refusal(whole.substr(0, n));
    ASSERT_THAT(said, HasSubstr(n == first.size() ? "no error" : "damaged TDMS file")) << n;
  }
}

TEST(TdmsFile, WhatIsNotReadIsSaid) {
  EXPECT_THAT(tdms_refusal(segment(metadata | raw_data | daqmx, force_objects(false), force_chunk(false, 1))),
              HasSubstr("NI-DAQmx"));
  std::string open = segment(metadata | new_list | raw_data, force_objects(false), force_chunk(false, 1));
  std::fill_n(open.begin() + 12, 8, '\xff');
  EXPECT_THAT(tdms_refusal(open), HasSubstr("stopped before it was finished"));
  Writer huge(false);
  huge.put(std::uint32_t{1}).channel("/'g'/'c'", float64_type, std::uint64_t{1} << 60U, 0);
  EXPECT_THAT(tdms_refusal(segment(metadata | raw_data, huge.bytes(), "12345678")), HasSubstr("more values than"));
  Writer odd(false);
  odd.put(std::uint32_t{1}).channel("/'g'/'c'", float64_type, 2, 0);
  EXPECT_THAT(tdms_refusal(segment(metadata | raw_data, odd.bytes(), std::string(24, 'x'))), HasSubstr("end within"));
  EXPECT_THAT(tdms_refusal("TDSh" + open.substr(4)), HasSubstr("the index of a TDMS file"));
}

}  // namespace
}  // namespace touchstone::importing
