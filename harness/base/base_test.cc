#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/half_files.h"
#include "harness/base/hash.h"
#include "harness/base/json_reader.h"
#include "harness/base/json_values.h"
#include "harness/base/random.h"
#include "harness/base/units.h"

namespace touchstone {
namespace {

using ::testing::HasSubstr;

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Units, FactorsAndRefusals) {
  EXPECT_EQ(si_factor(Dimension::force, "mN"), 1e-3);
  EXPECT_EQ(si_factor(Dimension::force, "mm"), std::nullopt);
  EXPECT_DOUBLE_EQ(parse_length_m("3.15mm", "--tip-radius"), 3.15e-3);
  EXPECT_DOUBLE_EQ(parse_length_m("1 km", "x"), 1e3);
  EXPECT_THAT(message_of([] { parse_length_m("3.15", "--tip-radius"); }), HasSubstr("--tip-radius: '3.15'"));
  EXPECT_THROW(parse_length_m("nanmm", "x"), UsageError);
  EXPECT_THROW(length_unit_factor("inch"), UsageError);
}

TEST(Hash, KnownAnswer) {
  EXPECT_EQ(sha256(std::string_view("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Random, SameOnEveryMachineAndStreamsDiffer) {
  Random a(42);
  Random b(42);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.next_u64(), b.next_u64());
  EXPECT_NE(Random(42).stream(0).next_u64(), Random(42).stream(1).next_u64());
}

TEST(Random, NormalHasUnitVarianceAndRotationsAreUnit) {
  Random random(7);
  double sum = 0.0;
  double squares = 0.0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
  }
  // Five standard errors of the mean and of the variance.
  EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(random.rotation().norm(), 1.0, 1e-15);
  EXPECT_NEAR(random.direction().norm(), 1.0, 1e-15);
}

TEST(JsonReader, ErrorsNameFileAndPlace) {
  EXPECT_THAT(message_of([] { parse_json("{\n \"a\": }", "m.json"); }), HasSubstr("m.json: line 2, column 7"));
  EXPECT_THAT(message_of([] { parse_json("", "m.json"); }), HasSubstr("m.json: is empty"));
  EXPECT_THAT(message_of([] { parse_json(R"({"a":1,"a":2})", "m.json"); }), HasSubstr("\"a\" stands twice"));
  const auto json = parse_json(R"({"a": {"b": "x", "spare": 1}})", "m.json");
  JsonObject root(json, "m.json", "");
  JsonObject a = root.object("a");
  EXPECT_THAT(message_of([&] { a.number("b"); }), HasSubstr("m.json: /a/b: a number was expected, got \"x\""));
  EXPECT_THAT(message_of([&] { a.finish(); }), HasSubstr("nothing reads the key \"spare\""));
  EXPECT_THAT(message_of([&] { a.number("c"); }), HasSubstr("\"c\" is missing"));
  EXPECT_THAT(message_of([&] { a.raw("c"); }), HasSubstr("m.json: /a: the key \"c\" is missing; present: b, spare"));
  EXPECT_NO_THROW(root.finish());
}

TEST(JsonReader, ASlipNamesTheKeyThatWasMeant) {
  const auto json = parse_json(R"({"renderer": "x", "efects": [], "shema": "s"})", "m.json");
  JsonObject root(json, "m.json", "");
  EXPECT_THAT(message_of([&] { root.text("schema"); }),
              HasSubstr("nothing reads the key \"shema\"; did you mean \"schema\"?"));
  root.text("renderer");
  // Asked for and not there: known all the same.
  EXPECT_FALSE(root.has("effects"));
  EXPECT_FALSE(root.optional_number("gain"));
  EXPECT_THAT(message_of([&] { root.finish(); }),
              HasSubstr("nothing reads the key \"efects\"; did you mean \"effects\"? the keys understood here are: "
                        "effects, gain, renderer, schema"));
}

TEST(JsonValues, ListsOfTextsAndWholeNumbersAndNothingElse) {
  const auto json = parse_json(R"({"names": ["a", "b"], "name": "a", "mixed": ["a", 1], "two": 2.0, "half": 0.5,
    "less": -1, "vast": 1e300})",
                               "m.json");
  JsonObject root(json, "m.json", "");
  EXPECT_THAT(texts_of(root, "names"), ::testing::ElementsAre("a", "b"));
  EXPECT_THAT(message_of([&] { texts_of(root, "name"); }), HasSubstr("/name: a list of texts was expected, got \"a\""));
  EXPECT_THAT(message_of([&] { texts_of(root, "mixed"); }), HasSubstr("got 1 in it"));
  EXPECT_EQ(count_of(root, "two", 2), 2U);
  EXPECT_THAT(message_of([&] { count_of(root, "two", 1); }),
              HasSubstr("/two: a whole number from 0 to 1 was expected"));
  for (const char* const key : {"half", "less", "vast"}) EXPECT_THROW(count_of(root, key, 100), BadData) << key;
}

TEST(AtomicFile, AnExistingFileSurvivesAnAbandonedWrite) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-atomic";
  ensure_writable_folder(folder);
  const auto file = folder / "a.txt";
  write_file(file, "first");
  {
    AtomicFile half(file);
    write_file(half.path(), "half");
  }
  EXPECT_EQ(read_file(file), "first");
  EXPECT_THROW(ensure_writable_folder(file / "under-a-file"), BadData);
  EXPECT_THROW(write_file(folder / "absent" / "b.txt", "x"), BadData);
}

TEST(AtomicFile, AnInterruptLeavesNoHalfFileAndNoEmptyFolder) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone-half-{}", ::getpid());
  ensure_writable_folder(folder);
  write_file(folder / "a.txt", "whole");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t child = ::fork();
    if (child == 0) {
      std::signal(signal, SIG_DFL);
      remove_half_files_when_interrupted();
      ensure_writable_folder(folder / "new" / "deep");
      AtomicFile one(folder / "a.txt");
      AtomicFile other(folder / "b.txt");
      write_file(one.path(), "half");
      write_file(other.path(), "half");
      std::raise(signal);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << "it ends as interrupted programs do";
    EXPECT_EQ(read_file(folder / "a.txt"), "whole");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace touchstone
