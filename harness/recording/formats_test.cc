#include <gtest/gtest.h>

#include <cstdlib>

#include "harness/base/file_format.h"
#include "harness/recording/column.h"

namespace touchstone::recording {
namespace {

// "s, ms, us" as the page says it: "s, ms or us".
std::string in_words(std::string units) {
  const std::size_t last = units.rfind(", ");
  if (last != std::string::npos) units.replace(last, 2, " or ");
  return units;
}

// The columns that are described are those that are read, with their units.
TEST(FileFormats, EveryColumnOfARecordingIsDescribed) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  ASSERT_NE(source, nullptr);
  const auto formats = load_formats({std::filesystem::path(source) / "harness/recording/formats.json"});
  const auto of_recordings = std::ranges::find(formats, "touchstone-recording/1", &FileFormat::schema);
  ASSERT_NE(of_recordings, formats.end());
  const FileFormat& recording = *of_recordings;
  ASSERT_EQ(recording.fields.size(), quantity_count);
  for (std::size_t i = 0; i < quantity_count; ++i) {
    const FormatField& field = recording.fields[i];
    const QuantityInfo& info = quantities()[i];
    EXPECT_EQ(field.path.substr(0, field.path.find('?')), info.name);
    if (info.dimension == Dimension::none) continue;
    EXPECT_EQ(field.unit, in_words(known_units(info.dimension))) << field.path;
  }
}

}  // namespace
}  // namespace touchstone::recording
