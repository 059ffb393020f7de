#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "board_plan.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/pipeline/board_json.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/embree_surface.h"
#include "packed_dataset.h"
#include "renderers/catalogue.h"
#include "signature.h"
#include "submission.h"
#include "write_dataset.h"

namespace touchstone::board {
namespace {

using renderers::built_in_catalogue;
using runs::CaseStore;
using ::testing::HasSubstr;

std::filesystem::path fresh_folder(const std::string& name) {
  auto folder = std::filesystem::temp_directory_path() / fmt::format("{}-{}", name, ::getpid());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

class Leaderboard : public ::testing::Test {
 protected:
  // The bundled plane with a few renderers, without reports.
  BoardRequest request(BoardTip tip = BoardTip::point) const {
    BoardRequest out;
    const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
    out.datasets = {std::filesystem::path(source == nullptr ? "." : source) / "synthetic/bundled/plane"};
    for (const char* const name : {"god-object", "friction-cone", "voxel"}) {
      rendering::Model model;
      model.renderer = name;
      model.source = name;
      if (std::string(name) == "friction-cone")
        model.parameters = {{"mu_static", 0.2}, {"mu_dynamic", 0.2}, {"stiffness_N_per_m", 500.0}};
      out.models.emplace_back(model, std::string(name) + ".json");
    }
    out.plugins = &plugins_;
    out.tip = tip;
    out.reports = false;
    return out;
  }

  static pipeline::Board run(const BoardPlan& plan, CaseStore& store) {
    store.start_run({{"version", "test"}});
    run_cases(board_job(built_in_catalogue(), plan), store, {}, 1, false);
    EXPECT_EQ(store.done().size(), plan.cells.size());
    pipeline::Board board = board_of_rows(plan, store);
    board.options.draws = 300;
    pipeline::rank_board(board, false);
    return board;
  }

  plugin::Plugins plugins_;
};

TEST_F(Leaderboard, RanksWhoEntersAndSaysWhoDoesNot) {
  const BoardPlan plan = plan_board(built_in_catalogue(), request(BoardTip::dataset));
  CaseStore store(CaseStore::in_memory, board_table(plan));
  const pipeline::Board board = run(plan, store);
  ASSERT_EQ(board.tasks.size(), 1u);
  const pipeline::Task& task = board.tasks.front();
  ASSERT_TRUE(task.floor.has_value());
  EXPECT_EQ(task.entries[2].state, pipeline::EntryState::does_not_enter);
  EXPECT_THAT(task.entries[2].why, HasSubstr("renders point tips only"));
  EXPECT_THAT(task.input, HasSubstr("whole-force")) << "the data set declares friction";
  ASSERT_TRUE(task.ranking.has_value());
  EXPECT_TRUE(task.ranking->told_apart(0, 1)) << "friction is what the god-object lacks";
  // Nothing is below the floor, and the model that made the recording is near it.
  const double own = task.entries[1].scores.rms_force_error_N;
  EXPECT_GT(own, 0.5 * task.floor->low95_N);
  EXPECT_LT(own, 2.0 * task.floor->high95_N);
  EXPECT_GT(task.entries[0].scores.rms_force_error_N, 3.0 * task.floor->high95_N);
}

// Recordings of a ball that the synthetic families make by the very law that the floor simulates, but independently of
// it: what that law scores on them lies within the floor's interval or above it (the floor's world is smoothed), never
// below.
TEST_F(Leaderboard, TheRightLawIsNotBelowTheFloor) {
  for (const char* const family : {"bumpy", "crease", "flush"}) {
    for (const std::uint64_t seed : {1, 2}) {
      const auto folder = fresh_folder("touchstone-floor") / fmt::format("{}-{}", family, seed);
      datasets::write_dataset(datasets::recipe(family), seed, folder);
      BoardRequest request = this->request();
      request.models = {};
      request.datasets = {folder};
      BoardPlan plan = plan_board(built_in_catalogue(), request);
      std::erase_if(plan.cells, [](const BoardCell& cell) {
        return cell.evaluation && cell.evaluation->column != "friction-cone";
      });
      CaseStore store(CaseStore::in_memory, board_table(plan));
      const pipeline::Task task = run(plan, store).tasks.front();
      ASSERT_TRUE(task.floor.has_value());
      const double score_N = task.entries.front().scores.rms_force_error_N;
      EXPECT_GE(score_N, task.floor->low95_N) << family << ' ' << seed;
      EXPECT_LE(score_N, 1.3 * task.floor->high95_N) << family << ' ' << seed;
      EXPECT_GT(task.floor->low95_N, 0.0);
      // Nor is the median above it by more than one score scatters.
      EXPECT_GE(score_N, 0.9 * task.floor->rms_N) << family << ' ' << seed;
    }
  }
}

// Two recordings of one motion in a data set: what they leave between them stands on the board. And every entry's link
// leads to its report.
TEST_F(Leaderboard, ShowsWhatARepeatLeavesAndLinksItsReports) {
  const auto folder = fresh_folder("touchstone-repeat");
  BoardRequest request = this->request();
  const recording::Dataset plane = recording::load_dataset(request.datasets.front());
  std::filesystem::copy(plane.folder, folder / "twice");
  recording::Recording again = recording::load_recording(plane.path_of(plane.recordings[0].file));
  for (Vec3& f : again.f_W_N) f.z() += 0.05;
  save_recording(folder / "twice/again.csv", again);
  recording::Dataset twice = recording::load_dataset(folder / "twice");
  twice.recordings[0].repeat = "again.csv";
  datasets::pack_dataset(twice);
  request.datasets = {folder / "twice"};
  request.out = folder / "out";
  request.reports = true;
  const BoardPlan plan = plan_board(built_in_catalogue(), request);
  CaseStore store(CaseStore::in_memory, board_table(plan));
  const pipeline::Board board = run(plan, store);
  ASSERT_TRUE(board.tasks.front().repeat.has_value());
  // The two differ by 0.05 N; each has half of the mean square.
  EXPECT_NEAR(board.tasks.front().repeat->rms_N, 0.05 / std::sqrt(2.0), 1e-4);
  EXPECT_THAT(board.tasks.front().repeat->how, HasSubstr("again.csv"));
  for (const pipeline::Entry& entry : board.tasks.front().entries) {
    ASSERT_FALSE(entry.report.empty()) << entry.renderer;
    EXPECT_TRUE(std::filesystem::exists(request.out / entry.report)) << entry.report;
  }
}

TEST_F(Leaderboard, ARunThatStoppedGivesTheSameBytes) {
  const BoardPlan plan = plan_board(built_in_catalogue(), request());
  CaseStore whole(CaseStore::in_memory, board_table(plan));
  const std::string expected = pipeline::board_to_json(run(plan, whole));
  CaseStore parts(CaseStore::in_memory, board_table(plan));
  runs::CaseShard half;
  half.index = 1;
  half.count = 2;
  parts.start_run({{"version", "test"}});
  run_cases(board_job(built_in_catalogue(), plan), parts, half, 1, false);
  EXPECT_GT(parts.done().size(), 0u);
  EXPECT_LT(parts.done().size(), plan.cells.size());
  EXPECT_EQ(pipeline::board_to_json(run(plan, parts)), expected);
}

TEST_F(Leaderboard, ASubmissionIsCheckedByRunningItAgain) {
  const auto folder = fresh_folder("touchstone-submission");
  const BoardPlan plan = plan_board(built_in_catalogue(), request());
  CaseStore store(CaseStore::in_memory, board_table(plan));
  pipeline::Board board = run(plan, store);
  write_file(folder / "s.json", submission_to_json(plan, board, {}, {}));
  const Submission claimed = load_submission(folder / "s.json", plugins_);
  CaseStore again(CaseStore::in_memory, board_table(plan));
  EXPECT_TRUE(differences(claimed, plan, run(plan, again)).empty());
  board.tasks[0].entries[1].scores.rms_force_error_N *= 1.0 + 1e-15;
  EXPECT_THAT(differences(claimed, plan, board), ::testing::ElementsAre(HasSubstr("friction-cone on plane / scan")));
  std::string text = read_file(folder / "s.json");
  const auto at = text.find("\"rms_force_error_N\": 0.");
  ASSERT_NE(at, std::string::npos);
  text[at + 23] = text[at + 23] == '9' ? '8' : '9';
  write_file(folder / "forged.json", text);
  EXPECT_THROW(load_submission(folder / "forged.json", plugins_), BadData);
}

// Whoever writes such a file can hash it too: what it lacks is said with its place.
TEST_F(Leaderboard, ASubmissionThatLacksAPartIsRefusedWithItsPlace) {
  const auto folder = fresh_folder("touchstone-submission-parts");
  const BoardPlan plan = plan_board(built_in_catalogue(), request());
  CaseStore store(CaseStore::in_memory, board_table(plan));
  const auto sound = nlohmann::json::parse(submission_to_json(plan, run(plan, store), {}, {}));
  const auto refusal = [&](const char* pointer, const nlohmann::json& value) {
    nlohmann::json bad = sound;
    bad[nlohmann::json::json_pointer(pointer)] = value;
    bad.erase("sha256");
    bad["sha256"] = sha256(bad.dump());
    write_file(folder / "bad.json", bad.dump());
    try {
      static_cast<void>(load_submission(folder / "bad.json", plugins_));
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("was taken");
  };
  EXPECT_EQ(refusal("/fit_range", sound["fit_range"]), "was taken") << "as it is, hashed anew";
  EXPECT_THAT(refusal("/fit", "stiffness"), HasSubstr("/fit: a list of texts was expected"));
  EXPECT_THAT(refusal("/entries/0/task", nullptr), HasSubstr("/entries/0/task: a text was expected"));
  EXPECT_THAT(refusal("/entries", 3), HasSubstr("/entries: a list"));
  EXPECT_THAT(refusal("/specification", "{}"), HasSubstr("\"cells\" is missing"));
  EXPECT_THAT(refusal("/specification", "no JSON"), HasSubstr("/specification: line 1"));
  EXPECT_THAT(refusal("/tip", "ball"), HasSubstr("dataset or point was expected, got ball"));
  EXPECT_THAT(refusal("/in_trajectory", "guess"), HasSubstr("'guess' is unknown"));
}

TEST_F(Leaderboard, APluginThatWasBuiltAnewIsSaidAndIsNoDifferenceOfNumbers) {
  const auto folder = fresh_folder("touchstone-submission-files");
  write_file(folder / "libmine.so", "one build");
  write_file(folder / "mine.c", "int main;");
  const BoardPlan plan = plan_board(built_in_catalogue(), request());
  CaseStore store(CaseStore::in_memory, board_table(plan));
  write_file(folder / "s.json",
             submission_to_json(plan, run(plan, store), {folder / "libmine.so"}, {folder / "mine.c"}));
  const Submission claimed = load_submission(folder / "s.json", plugins_);
  EXPECT_TRUE(files_not_as_claimed(claimed, {folder / "libmine.so"}, {folder / "mine.c"}).empty());
  write_file(folder / "libmine.so", "another build");
  EXPECT_THAT(files_not_as_claimed(claimed, {folder / "libmine.so"}, {folder / "mine.c"}),
              ::testing::ElementsAre(HasSubstr("libmine.so")));
}

// Keys are made here by ssh-keygen itself; so are signatures, which it must find good or not by its own means.
TEST(Signature, IsOfTheFileAndOfAnAllowedKey) {
  const auto folder = fresh_folder("touchstone-signature");
  const auto shell = [&](const std::string& words) { return std::system(words.c_str()); };
  if (shell("command -v ssh-keygen >/dev/null") != 0) GTEST_SKIP() << "needs ssh-keygen";
  for (const char* const name : {"ours", "theirs"}) {
    ASSERT_EQ(shell(fmt::format("ssh-keygen -q -t ed25519 -N '' -C {0} -f '{1}/{0}'", name, folder.string())), 0);
  }
  const auto list = [&](const std::string& name) {
    const std::string file = (folder / (name + ".signers")).string();
    write_file(file, "lab@example.org " + read_file(folder / (name + ".pub")));
    return file;
  };
  write_file(folder / "s.json", "{\"a\": 1}");
  EXPECT_THROW(check_signature(folder / "s.json", signature_of(folder / "s.json"), ""), BadData) << "not signed yet";
  sign_submission(folder / "s.json", folder / "ours");
  EXPECT_THAT(check_signature(folder / "s.json", signature_of(folder / "s.json"), "").key, HasSubstr("SHA256:"));
  EXPECT_EQ(check_signature(folder / "s.json", signature_of(folder / "s.json"), list("ours")).signer,
            "lab@example.org");
  EXPECT_THROW(check_signature(folder / "s.json", signature_of(folder / "s.json"), list("theirs")), BadData);
  // What ssh-keygen's own verification says of the same files.
  EXPECT_EQ(shell(fmt::format("ssh-keygen -Y verify -f '{0}/ours.signers' -I lab@example.org -n touchstone-submission "
                              "-s '{0}/s.json.sig' < '{0}/s.json' >/dev/null",
                              folder.string())),
            0);
  write_file(folder / "s.json", "{\"a\": 2}");
  EXPECT_THROW(check_signature(folder / "s.json", signature_of(folder / "s.json"), list("ours")), BadData);
  EXPECT_THROW(sign_submission(folder / "s.json", folder / "s.json"), BadData) << "no key";
}

}  // namespace
}  // namespace touchstone::board
