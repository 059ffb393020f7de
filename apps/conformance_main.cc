// touchstone-conformance: the conformance suite of renderers (harness/testing/renderer_conformance.h) on the renderers
// of a plug-in, and the golden cases, each a test that fails if a hand would notice the error, as in a scorecard. They
// run in this process, so that an allocation in a step is seen.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/error.h"
#include "harness/golden/golden_store.h"
#include "harness/golden/scored_renderer.h"
#include "harness/plugin/plugin.h"
#include "harness/testing/renderer_subject.h"
#include "harness/testing/result_recorder.h"
#include "harness/testing/temporary_folder.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"

namespace {

using namespace touchstone;
using namespace touchstone::plugin;
using namespace touchstone::rendering;

constexpr const char* usage =
    "usage: touchstone-conformance --plugin=libmine.so [--renderer=NAME] [--parameter=NAME=VALUE]... "
    "[--stiffness=N/M]\n"
    "                              [--friction=MU] [--tip-radius=M] [--epsilon=M] [--allow=FAULT]... [--in-child]\n"
    "                              [--golden=FOLDER] [--model=MODEL] [--no-cases] [--results=FOLDER] [--gtest_...]\n"
    "  --renderer    only this one of the plug-in's\n"
    "  --parameter   another value than the default\n"
    "  --stiffness   the steepest rise of force with depth [N/m]; the parameter stiffness_N_per_m where not given\n"
    "  --friction    the largest tangential over normal force; the larger of mu_static and mu_dynamic where\n"
    "                not given\n"
    "  --tip-radius  where the tip is a ball [m]; the parameter tip_radius_m where not given\n"
    "  --epsilon     lengths below it are nothing to the renderer [m]; what it declares where not given\n"
    "  --allow       a fault or a golden case that is known to fail: it is reported, and no failure\n"
    "  --golden      folder of the golden cases; those that come with the program where not given\n"
    "  --model       the model of the golden cases whose place the renderer takes; god-object where not given\n"
    "  --no-cases    no golden cases\n"
    "  --results     write each test's outcome there, for touchstone-test-result; exit status 0 then, as each\n"
    "                test fails by its own name\n"
    "  --in-child    run the plug-in in a child process, as the program does; allocations are not seen there\n"
    "Exit status: 0 passed, 1 a test failed, 2 usage, 3 the plug-in cannot be used.\n";

struct Options {
  std::string plugin, renderer, results;
  std::string golden = "golden";
  golden::ScoreRequest cases;
  touchstone::testing::SubjectFacts facts;
  std::vector<std::string> allowed;
  bool in_child = false;
};

std::vector<touchstone::testing::RendererSubject>& subjects() {
  static std::vector<touchstone::testing::RendererSubject> list;
  return list;
}

// A renderer on a golden case.
struct FeltCase {
  std::shared_ptr<const RendererEntry> entry;
  golden::ScoreRequest request;
  golden::GoldenCase golden;
};

void PrintTo(const FeltCase& one, std::ostream* out) { *out << one.entry->name << " on " << one.golden.name; }

std::vector<FeltCase>& felt_cases() {
  static std::vector<FeltCase> list;
  return list;
}

double number(std::string_view text, std::string_view whole) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw UsageError(std::string(whole) + ": a number was expected after =");
  }
  return value;
}

void take(std::string_view word, Options& options) {
  const auto value_of = [&](std::string_view name) -> const char* {
    const bool is = word.starts_with(name) && word.size() > name.size() && word[name.size()] == '=';
    return is ? word.data() + name.size() + 1 : nullptr;
  };
  if (const char* const text = value_of("--plugin")) {
    options.plugin = text;
  } else if (const char* const name = value_of("--renderer")) {
    options.renderer = name;
  } else if (const char* const setting = value_of("--parameter")) {
    const std::string_view both = setting;
    const std::size_t equals = both.find('=');
    if (equals == std::string_view::npos) throw UsageError(std::string(word) + ": NAME=VALUE was expected");
    options.facts.parameters[std::string(both.substr(0, equals))] = number(both.substr(equals + 1), word);
  } else if (const char* const stiffness = value_of("--stiffness")) {
    options.facts.stiffness_N_per_m = number(stiffness, word);
  } else if (const char* const friction = value_of("--friction")) {
    options.facts.friction = number(friction, word);
  } else if (const char* const radius = value_of("--tip-radius")) {
    options.facts.tip_radius_m = number(radius, word);
  } else if (const char* const epsilon = value_of("--epsilon")) {
    options.facts.epsilon_m = number(epsilon, word);
  } else if (const char* const fault = value_of("--allow")) {
    options.allowed.emplace_back(fault);
  } else if (const char* const golden = value_of("--golden")) {
    options.golden = golden;
  } else if (const char* const model = value_of("--model")) {
    options.cases.model = model;
  } else if (word == "--no-cases") {
    options.cases.with_cases = false;
  } else if (const char* const results = value_of("--results")) {
    options.results = results;
  } else if (word == "--in-child") {
    options.in_child = true;
  } else if (!word.starts_with("--gtest_")) {
    throw UsageError(std::string(word) + " is no option of this program");
  }
}

void choose_cases(const Options& options, const std::vector<std::shared_ptr<const RendererEntry>>& entries) {
  std::vector<golden::GoldenCase> cases;
  if (options.cases.with_cases) {
    std::filesystem::path folder = options.golden;
    if (options.golden == Options{}.golden) folder = golden::usual_golden_folder(folder);
    if (std::filesystem::is_directory(folder) || options.golden != Options{}.golden) {
      cases = golden::load_cases(folder);
    } else {
      std::fputs(
          "touchstone-conformance: no golden cases are here (--golden=FOLDER): errors that a hand would notice "
          "are not looked for\n",
          stderr);
    }
  }
  for (const std::string& name : options.allowed) {
    if (std::ranges::find(cases, name, &golden::GoldenCase::name) == cases.end()) renderer_faults::find_detector(name);
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    golden::ScoreRequest request = options.cases;
    request.facts = options.facts;
    request.felt.epsilon_m = subjects()[i].epsilon_m;
    request.allowed = options.allowed;
    for (const golden::GoldenCase& golden : cases) {
      if (golden.models.contains(request.model)) felt_cases().push_back({entries[i], request, golden});
    }
  }
}

void choose_subjects(const Options& options) {
  if (options.plugin.empty()) throw UsageError("--plugin=libmine.so is missing");
  PluginOptions how;
  how.in_process = !options.in_child;
  std::string known;
  std::vector<std::shared_ptr<const RendererEntry>> chosen;
  for (const auto& entry : load_plugin(options.plugin, how)) {
    known += " " + entry->name;
    if (options.renderer.empty() || options.renderer == entry->name) {
      subjects().push_back(touchstone::testing::subject_of(*entry, options.facts));
      subjects().back().allowed = options.allowed;
      chosen.push_back(entry);
    }
  }
  if (subjects().empty()) {
    throw UsageError("--renderer=" + options.renderer + ": " + options.plugin + " has no such renderer; it has" +
                     known);
  }
  choose_cases(options, chosen);
}

// If a renderer crashes in a test, the test runs again in a child process, which can say in which function, at which
// step and where the tip was: this process becomes that run. Only what a signal handler may do happens there (POSIX,
// signal-safety: execv), with texts that were made before.
struct Again {
  std::vector<std::string> words;
  std::vector<char*> arguments;
  std::string filter = std::string("--gtest_filter=") + std::string(longest_name, ' ');
  static constexpr std::size_t longest_name = 200;
};
Again& again() {
  static Again one;
  return one;
}

extern "C" void run_again_in_a_child(int) { ::execv("/proc/self/exe", again().arguments.data()); }

class NamesTheTest : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo& test) override {
    const std::string name = std::string(test.test_suite_name()) + "." + test.name();
    const auto at = again().filter.begin() + std::string_view("--gtest_filter=").size();
    std::fill(at, again().filter.end(), '\0');
    std::copy_n(name.begin(), std::min(name.size(), Again::longest_name), at);
  }
};

void run_again_if_it_crashes(int argc, char** argv) {
  Again& prepared = again();
  for (int i = 0; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--gtest_filter") && !word.starts_with("--results")) prepared.words.emplace_back(word);
  }
  prepared.words.emplace_back("--in-child");
  for (std::string& word : prepared.words) prepared.arguments.push_back(word.data());
  prepared.arguments.push_back(prepared.filter.data());
  prepared.arguments.push_back(nullptr);
  // A renderer that ran out of its stack needs another one for the handler.
  static std::array<char, 1 << 16> other_stack;
  const stack_t stack{other_stack.data(), 0, other_stack.size()};
  ::sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_handler = run_again_in_a_child;
  action.sa_flags = SA_ONSTACK | SA_RESETHAND | SA_NODEFER;
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) ::sigaction(signal, &action, nullptr);
  ::testing::UnitTest::GetInstance()->listeners().Append(new NamesTheTest);
}

}  // namespace

namespace touchstone::apps {

class GoldenCases : public ::testing::TestWithParam<FeltCase> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(GoldenCases);

TEST_P(GoldenCases, AHandNoticesNoError) {
  const testing::TemporaryFolder folder;
  const FeltCase& tested = GetParam();
  golden::ScoreRequest request = tested.request;
  request.out = folder.path();
  const renderer_faults::CaseScore score = golden::score_case(
      {renderers::built_in_catalogue(), synthetic::built_in_generators()}, tested.entry, request, tested.golden);
  if (score.skipped) GTEST_SKIP() << score.problem;
  if (!renderer_faults::fails(score)) return;
  const std::string what =
      score.problem.empty()
          ? fmt::format("{:.3g} N off at most, {:.3g} just noticeable differences", score.max_N, score.max_jnd)
          : score.problem;
  if (std::ranges::find(request.allowed, score.name) != request.allowed.end())
    GTEST_SKIP() << score.name << " is allowed: " << what;
  ADD_FAILURE() << what << "; touchstone scorecard shows where";
}

}  // namespace touchstone::apps

TOUCHSTONE_RENDERER_CONFORMANCE(Plugin, subjects());
namespace touchstone::apps {
INSTANTIATE_TEST_SUITE_P(Plugin, GoldenCases, ::testing::ValuesIn(felt_cases()), [](const auto& tested) {
  std::string name = tested.param.entry->name + "_" + tested.param.golden.name;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});
}  // namespace touchstone::apps

int main(int argc, char** argv) {
  Options options;
  try {
    for (int i = 1; i < argc; ++i) {
      if (std::string_view(argv[i]) == "--help") {
        std::fputs(usage, stdout);
        return 0;
      }
      take(argv[i], options);
    }
    choose_subjects(options);
  } catch (const UsageError& error) {
    std::fprintf(stderr, "touchstone-conformance: %s\n%s", error.what(), usage);
    return static_cast<int>(error.status());
  } catch (const Error& error) {
    std::fprintf(stderr, "touchstone-conformance: %s\n", error.what());
    return static_cast<int>(error.status());
  }
  if (!options.in_child) run_again_if_it_crashes(argc, argv);
  ::testing::InitGoogleTest(&argc, argv);
  if (options.results.empty()) return RUN_ALL_TESTS();
  ::testing::UnitTest::GetInstance()->listeners().Append(new touchstone::testing::ResultRecorder(options.results));
  // Each test fails by its own name: a record of failures is a good record.
  const int failed = RUN_ALL_TESTS();
  return ::testing::UnitTest::GetInstance()->test_to_run_count() > 0 ? 0 : failed;
}
