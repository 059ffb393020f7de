#include "harness/pipeline/board.h"

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>

#include "harness/base/atomic_file.h"
#include "harness/base/random.h"
#include "harness/pipeline/board_json.h"
#include "harness/pipeline/board_pictures.h"
#include "harness/pipeline/board_site.h"
#include "harness/pipeline/sample_board_for_test.h"
#include "harness/pipeline/verdict.h"

namespace touchstone::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Board, SaysInWordsWhoIsBest) {
  const Board board = sample_board({0.1, 0.2, 0.2001, 0.5});
  const std::string words = verdict(board.tasks.front());
  EXPECT_THAT(words, HasSubstr("renderer-0 is best"));
  EXPECT_THAT(words, HasSubstr("Last is renderer-3"));
  EXPECT_THAT(words, HasSubstr("pointed does not enter"));
  EXPECT_THAT(words, HasSubstr("crashed failed"));
  const Board same = sample_board({0.1, 0.1});
  EXPECT_THAT(verdict(same.tasks.front()), HasSubstr("cannot tell the 2 renderers apart"));
}

TEST(Board, SaysWhoIsWithinOneJustNoticeableDifference) {
  Board board = sample_board({0.1, 0.2, 0.3, 0.4});
  Task& task = board.tasks.front();
  const auto felt = [&](const std::vector<double>& jnd) {
    for (std::size_t i = 0; i < jnd.size(); ++i) task.entries[i].scores.rms_force_error_jnd = jnd[i];
    std::vector<std::string> names;
    for (const std::size_t i : within_one_jnd(task)) names.push_back(task.entries[i].renderer);
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(felt({0.7, 0.2, 0.3, 4.0}), (Names{"renderer-1", "renderer-2", "renderer-0"}));
  EXPECT_THAT(
      verdict(task),
      HasSubstr("renderer-1, renderer-2 and renderer-0 are within 1 just noticeable differences of one another"));
  EXPECT_EQ(felt({0.71, 0.2, 0.3, 4.0}), (Names{"renderer-1", "renderer-2"})) << "0.3 and 0.71 may differ by 1.01";
  EXPECT_EQ(felt({0.71, 0.2, std::nan(""), 4.0}), (Names{"renderer-1", "renderer-0"}));
  EXPECT_EQ(felt({0.7, 0.31, std::nan(""), 4.0}), Names{});
  EXPECT_THAT(verdict(task), Not(HasSubstr("of one another")));
}

// Two pairs were told apart, and the first and the last cannot be tested: yet the last is behind the second.
TEST(Board, WhoIsToldToBeWorseThanAnotherIsNotBest) {
  Board board = sample_board({0.1, 0.1001, 0.4});
  Ranking& ranking = *board.tasks.front().ranking;
  ASSERT_EQ(ranking.order.back().best_rank, 3u);
  for (PairOfRenderers& pair : ranking.pairs) {
    if (pair.better == 0 && pair.other == 2) pair.told_apart = false;
  }
  ranking.order.back().best_rank = 2;
  EXPECT_THAT(verdict(board.tasks.front()), HasSubstr("renderer-0 and renderer-1 are best"));
}

TEST(Board, TheTableFitsATerminal) {
  Board board = sample_board({0.05971, 0.3393, 1.089});
  Task& task = board.tasks.front();
  // As long as names and numbers get.
  task.entries[1].renderer = "spring-quadratic";
  task.entries[1].scores.mean_operations = 138838.0;
  task.entries[1].scores.median_us = 14.63;
  task.floor->rms_N = 0.04704;
  const std::string table = short_table(task);
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_LT(table.find("renderer-0"), table.find("spring-quadratic"));
  EXPECT_THAT(table, HasSubstr("0.04704 N"));
  EXPECT_THAT(table, HasSubstr("FAILED"));
  EXPECT_EQ(wrapped("one two three", 8, 2), "one two\n  three");
}

TEST(Board, OverAllRecordingsRanksOnlyWhoRanOnAll) {
  Board board = sample_board({0.1, 0.2, 0.3}, 6);
  board.tasks[3].entries[1].state = EntryState::failed;
  rank_board(board, true);
  ASSERT_TRUE(board.overall.has_value());
  EXPECT_EQ(board.overall->renderers, (std::vector<std::string>{"renderer-0", "renderer-2"}));
  EXPECT_THAT(board.overall->left_out, ::testing::Contains(HasSubstr("renderer-1: failed on task 3")));
  EXPECT_TRUE(board.overall->ranking.told_apart(0, 1));
  EXPECT_EQ(board.overall->pareto, (std::vector<bool>{true, false})) << "the better one takes fewer operations as well";
}

// A renderer that is not counted on one recording keeps its place on the front: operations are compared over the
// others.
TEST(Board, OperationsAreComparedWhereAllAreCounted) {
  Board board = sample_board({0.1, 0.2, 0.3}, 6);
  board.tasks[2].entries[0].scores.mean_operations = std::nan("");
  board.tasks[2].entries[1].scores.mean_operations = 1e6;
  for (Task& task : board.tasks) task.entries[2].scores.mean_operations = std::nan("");  // counted nowhere
  rank_board(board, true);
  EXPECT_EQ(board.overall->pareto, (std::vector<bool>{true, false, false}));
  EXPECT_EQ(board.overall->scores[0].mean_operations, 100.0);
  EXPECT_EQ(board.overall->scores[1].mean_operations, 110.0);
  EXPECT_TRUE(std::isnan(board.overall->scores[2].mean_operations));
}

TEST(Board, TheJsonIsTheSameForTheSameRowsAndHasNoTimes) {
  Board board = sample_board({0.1, 0.2}, 2);
  const std::string text = board_to_json(board);
  for (Task& task : board.tasks) {
    for (Entry& entry : task.entries) entry.scores.median_us *= 2.0;
  }
  rank_board(board, true);
  EXPECT_EQ(board_to_json(board), text);
  EXPECT_THAT(text, Not(HasSubstr("_us")));
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["schema"], "touchstone-leaderboard/1");
  EXPECT_EQ(json["tasks"][0]["entries"][0]["renderer"], "renderer-0");
  EXPECT_EQ(json["tasks"][0]["entries"].back()["state"], "failed");
}

TEST(Board, ChangesAreSaidAndOtherInputsAreNotCompared) {
  Board board = sample_board({0.1, 0.2}, 2);
  const auto file = std::filesystem::temp_directory_path() / ("touchstone-board-" + std::to_string(::getpid()));
  write_file(file, board_to_json(board));
  const auto before = load_earlier(file);
  std::filesystem::remove(file);
  EXPECT_TRUE(changes_since(before, board).empty());
  board.tasks[0].entries[0].scores.rms_force_error_N = 0.05;
  board.tasks[1].entries[0].input.hash = "another";
  board.tasks[1].entries[1].renderer = "newcomer";
  EXPECT_THAT(
      changes_since(before, board),
      ::testing::ElementsAre(HasSubstr("renderer-0 on task 0: RMS force error"), HasSubstr("another input than before"),
                             HasSubstr("newcomer on task 1: new"), HasSubstr("1 entries of the last run")));
}

TEST(Board, ChangesOfFloorsAreSaid) {
  Board board = sample_board({0.1, 0.2}, 4);
  board.tasks[2].floor.reset();
  const auto file = std::filesystem::temp_directory_path() / ("touchstone-floors-" + std::to_string(::getpid()));
  write_file(file, board_to_json(board));
  const auto before = load_earlier(file);
  std::filesystem::remove(file);
  EXPECT_TRUE(changes_since(before, board).empty());
  board.tasks[0].floor->rms_N = 0.02;
  board.tasks[1].floor.reset();
  board.tasks[2].floor = Floor{0.03, 0.02, 0.04, "simulated"};
  EXPECT_THAT(changes_since(before, board), ::testing::ElementsAre("floor of task 0: 0.05000 N before, 0.02000 N now",
                                                                   "floor of task 1: 0.05000 N before, none now",
                                                                   "floor of task 2: none before, 0.03000 N now"));
}

TEST(Board, WhatARepeatLeavesIsSaid) {
  Board board = sample_board({0.1, 0.2});
  board.tasks[0].repeat = RepeatOfTask{0.05, "0.05 N (again.csv)"};
  EXPECT_THAT(verdict(board.tasks[0]), HasSubstr("A repeat of this motion sets a floor of 0.05000 N"));
  EXPECT_THAT(verdict(board.tasks[0]), HasSubstr("2.0 times that"));
  EXPECT_THAT(site_html(board, {}), HasSubstr("sets a floor of 0.05 N (again.csv)"));
  EXPECT_EQ(nlohmann::json::parse(board_to_json(board))["tasks"][0]["repeat"]["rms_N"], 0.05);
}

// Whoever reads leaderboard.json finds every key of it on the page of file formats.
TEST(Board, EveryKeyOfTheJsonIsOnThePageOfFormats) {
  Board board = sample_board({0.1, 0.1, 0.4}, 6);
  board.tasks[0].repeat = RepeatOfTask{0.05, "again.csv"};
  board.tasks[0].entries[0].fitted = "mu_dynamic 0.2";
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  std::string page = read_file(std::filesystem::path(source == nullptr ? "." : source) / "docs/reference/formats.md");
  const std::size_t begin = page.find("## `touchstone-leaderboard/1`");
  ASSERT_NE(begin, std::string::npos);
  page = page.substr(begin, page.find("\n## ", begin) - begin);
  std::vector<nlohmann::json> left{nlohmann::json::parse(board_to_json(board))};
  while (!left.empty()) {
    const nlohmann::json one = left.back();
    left.pop_back();
    for (const auto& [key, value] : one.items()) {
      if (value.is_structured()) left.push_back(value);
      if (!one.is_object() || key == "schema") continue;  // every file has it: said once, at the top
      // As code: `t`, `tasks[].name`; in plain text every short key is found.
      EXPECT_TRUE(std::regex_search(page, std::regex("[`.]" + key + R"((\[\])?[`.])")))
          << key << " is not in docs/reference/formats.md";
    }
  }
}

TEST(Board, ErrorsComeBackFromTheirText) {
  const Board board = sample_board({0.1});
  const BinnedErrors& errors = board.tasks[0].entries[0].errors;
  const BinnedErrors read = errors_from_text(errors_to_text(errors), "row");
  EXPECT_EQ(read.squares_N2, errors.squares_N2);
  EXPECT_EQ(read.samples, errors.samples);
}

TEST(Board, PicturesNameEveryRendererThatRan) {
  const Board board = sample_board({0.1, 0.2, 0.3}, 2);
  for (const std::string& picture :
       {error_picture(board.tasks[0]), error_picture(*board.overall), pareto_picture(*board.overall)}) {
    for (const char* const name : {"renderer-0", "renderer-1", "renderer-2"}) EXPECT_THAT(picture, HasSubstr(name));
    EXPECT_THAT(picture, Not(HasSubstr("nan")));
  }
}

}  // namespace
}  // namespace touchstone::pipeline
