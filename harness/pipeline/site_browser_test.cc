// The site opened in headless Chromium, wide and on a phone. Skips where Chromium or node is missing.
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/pipeline/board_site.h"
#include "harness/pipeline/sample_board_for_test.h"

namespace touchstone::pipeline {
namespace {

struct Seen {
  int status = 0;
  nlohmann::json page;
};

Seen open_site(const std::string& html, int width) {
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("touchstone-site-{}-{}.html", ::getpid(), width);
  write_file(file, html);
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  const std::string command =
      fmt::format("command -v node >/dev/null || exit 77; exec node '{}/harness/pipeline/check_site.mjs' '{}' {} 2>&1",
                  source == nullptr ? "." : source, file.string(), width);
  std::string output;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  char buffer[4096];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, n);
  const int status = ::pclose(pipe);
  std::filesystem::remove(file);
  Seen seen{WIFEXITED(status) ? WEXITSTATUS(status) : -1, {}};
  if (seen.status == 0) {
    seen.page = nlohmann::json::parse(output);
  } else if (seen.status != 77) {
    ADD_FAILURE() << output;
  }
  return seen;
}

class Site : public ::testing::TestWithParam<int> {};

TEST_P(Site, DrawsItsPicturesAndFitsTheScreen) {
  Board board = sample_board({0.1, 0.2, 0.3}, 6);
  const std::string hostile = "<img src=x onerror=\"window.stolen=1\"></script><script>window.stolen=1</script>";
  board.tasks[0].about = hostile;
  board.tasks[1].entries[0].renderer = hostile;
  board.tasks[2].entries[0].renderer = "chai3d-dynamic-mm";
  const Seen seen = open_site(site_html(board, {{}, {hostile}, true, {}}), GetParam());
  if (seen.status == 77) GTEST_SKIP() << "needs node and chromium";
  ASSERT_EQ(seen.status, 0);
  const nlohmann::json& page = seen.page;
  EXPECT_TRUE(page["console"].empty()) << page["console"];
  EXPECT_EQ(page["injected"], 0);
  EXPECT_LE(page["widest"].get<int>(), GetParam()) << "wider than the screen";
  for (const auto& request : page["requests"]) {
    const std::string url = request;
    EXPECT_TRUE(url.ends_with(".html") || url.starts_with("data:")) << url;
  }
  EXPECT_TRUE(page["cut"].empty()) << page["cut"];
  EXPECT_GE(page["smallestText"].get<double>(), 10.0) << "too small to read";
  EXPECT_EQ(page["hiddenHeads"], 0) << "cannot be sorted";
  // One per recording, all recordings, and error against operations.
  ASSERT_EQ(page["pictures"].size(), 8u);
  for (const auto& picture : page["pictures"]) {
    // At least one dot of five units radius (three where none is beaten by another), at the scale of the picture: half
    // of its area, the rest may be mixed with the background.
    const double scale = picture["width"].get<double>() / 640.0;
    const double dots = &picture == &page["pictures"][1] ? 1.0 : 3.0;
    EXPECT_GT(picture["blue"].get<double>(), 0.5 * dots * 78.5 * scale * scale) << picture;
    EXPECT_GT(picture["ink"].get<double>(), 50.0 * scale) << "no names: " << picture;
  }
  const auto& sorted = page["sorted"];
  EXPECT_EQ(sorted["up"], nlohmann::json({"renderer-0", "renderer-1", "renderer-2", "pointed", "crashed"}));
  EXPECT_EQ(sorted["down"], nlohmann::json({"renderer-2", "renderer-1", "renderer-0", "pointed", "crashed"}));
}

INSTANTIATE_TEST_SUITE_P(Widths, Site, ::testing::Values(1280, 390), [](const auto& instance) {
  return instance.param < 600 ? std::string("Phone") : std::string("Wide");
});

}  // namespace
}  // namespace touchstone::pipeline
