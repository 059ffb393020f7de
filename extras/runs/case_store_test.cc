#include "case_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::runs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Store : public testing::Test {
 protected:
  Store() { std::filesystem::create_directories(folder_); }
  ~Store() override { std::filesystem::remove_all(folder_); }

  static CaseTable table(const std::string& specification = "{\"force_N\":1.5}") {
    using enum CaseColumn::Type;
    CaseTable own{specification,
                  4,
                  {{"name", text}, {"count", integer}, {"lag \"m\"", real}, {"time_s", real, true}},
                  "grid",
                  "--cases"};
    return own;
  }
  static CaseRow row(std::uint64_t number, double lag_m, double time_s) {
    return {number, "", {std::string("a, \"b\""), std::uint64_t{7}, lag_m, time_s}};
  }
  std::filesystem::path file(const char* name) const { return folder_ / name; }
  void sql(const char* name, const char* statement) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file(name).c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, statement, nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("touchstone-store-" + std::to_string(::getpid()));
};

TEST_F(Store, RowsComeBackToTheBit) {
  const std::vector<double> values{
      0.1, 1e-308, 5e-324, -1.0 / 3.0, 1e300, 3.0, std::numeric_limits<double>::infinity()};
  {
    CaseStore store(file("a"), table());
    store.start_run({});
    std::vector<CaseRow> rows;
    for (std::size_t i = 0; i < values.size(); ++i) rows.push_back(row(values.size() - 1 - i, values[i], 0.0));
    store.add(rows);
    store.add(std::vector<CaseRow>{{100, "no force", {std::string("half")}}});
  }
  const CaseStore store(file("a"), table());
  const auto rows = store.rows(0, 100);
  ASSERT_EQ(rows.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(rows[i].number, i);
    EXPECT_EQ(as_text(rows[i].values[0]), "a, \"b\"");
    EXPECT_EQ(as_integer(rows[i].values[1]), 7U);
    EXPECT_EQ(as_number(rows[i].values[2]), values[values.size() - 1 - i]);
  }
  EXPECT_EQ(store.rows(2, 4).size(), 2U);
  const auto failed = store.rows(100, 101);
  ASSERT_EQ(failed.size(), 1U);
  EXPECT_EQ(failed[0].error, "no force");
  EXPECT_EQ(as_text(failed[0].values[0]), "half");
  EXPECT_TRUE(std::isnan(as_number(failed[0].values[2])));
  EXPECT_THROW(as_integer(failed[0].values[1]), BadData);
  EXPECT_EQ(store.failed(), 1U);
}

TEST_F(Store, ANumberCountsOnceAndWhatFailsIsNotHalfThere) {
  CaseStore store(CaseStore::in_memory, table());
  store.start_run({});
  store.add(std::vector<CaseRow>{row(1, 1.0, 0.0)});
  EXPECT_THROW(store.add(std::vector<CaseRow>{row(2, 1.0, 0.0), row(1, 1.0, 0.0)}), BadData);
  EXPECT_THAT(store.done(), ElementsAre(1));
  EXPECT_THROW(store.add(std::vector<CaseRow>{{3, "", std::vector<CaseValue>(5)}}), std::logic_error);
}

TEST_F(Store, AFileOfAnotherGridIsRefusedWithWhatToDo) {
  { const CaseStore first(file("a"), table()); }
  try {
    const CaseStore other(file("a"), table("{\"force_N\":2}"));
    FAIL() << "was taken";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("another grid; give another --cases, or remove it"));
    EXPECT_THAT(error.what(), HasSubstr("it holds: {\"force_N\":1.5}"));
    EXPECT_THAT(error.what(), HasSubstr("{\"force_N\":2}"));
  }
  CaseTable more = table();
  more.columns.push_back({"more"});
  EXPECT_THROW(CaseStore(file("a"), more), BadData);
  write_file(file("notes.txt"),
             "my notes, longer than the head of a database, so that nothing could take them for one");
  EXPECT_THROW(CaseStore(file("notes.txt"), table()), BadData);
  EXPECT_THAT(read_file(file("notes.txt")), testing::StartsWith("my notes"));
  const CaseStore writing(file("a"), table());
  EXPECT_THROW(CaseStore(file("a"), table()), BadData);
}

TEST_F(Store, ATimeThatVariesIsNoPartOfAResult) {
  for (const auto& [name, lag_m, time_s] : {std::tuple{"a", 1.0, 0.5}, {"b", 1.0, 0.7}, {"c", 1.0 + 1e-15, 0.5}}) {
    CaseStore store(file(name), table());
    store.start_run({{"commit", name}});
    store.add(std::vector<CaseRow>{row(2, lag_m, time_s)});
  }
  CaseStore a(file("a"), table());
  const std::string hash = a.content_hash();
  EXPECT_EQ(a.merge(file("b")).repeated, 1U);
  EXPECT_THROW(a.merge(file("c")), BadData);
  EXPECT_EQ(a.content_hash(), hash);
  EXPECT_EQ(as_number(a.rows(0, 9)[0].values[3]), 0.5);
  EXPECT_EQ(CaseStore(file("b"), table()).content_hash(), hash);
  EXPECT_NE(CaseStore(file("c"), table()).content_hash(), hash);
  // One that only the part has comes with its time.
  {
    CaseStore b(file("b"), table());
    b.start_run({{"commit", "b"}});
    b.add(std::vector<CaseRow>{row(3, 2.0, 0.25)});
  }
  EXPECT_EQ(a.merge(file("b")).added, 1U);
  EXPECT_EQ(as_number(a.rows(3, 4)[0].values[3]), 0.25);
  EXPECT_THAT(a.makers({"commit"}), ElementsAre("commit a", "commit b"));
}

TEST_F(Store, PartsOfAnotherGridAreNotMerged) {
  { const CaseStore other(file("other"), table("{}")); }
  write_file(file("notes.txt"), "no database");
  CaseStore store(file("a"), table());
  EXPECT_THROW(store.merge(file("other")), BadData);
  EXPECT_THROW(store.merge(file("notes.txt")), BadData);
  EXPECT_THROW(store.merge(file("absent")), BadData);
}

// Two processors round the last bit in other ways: the numbers are one result, their hash is not.
TEST_F(Store, PartsOfAnotherProcessorMergeWithinATolerance) {
  using enum CaseColumn::Type;
  CaseTable own{"{}", 4, {{"force_N", real}, {"count", integer}, {"sha256", text, false, true}}, "grid", "--cases"};
  const auto keep = [&](const char* name, const char* cpu, double force_N, std::uint64_t count) {
    CaseStore store(file(name), own);
    store.start_run({{"cpu", cpu}});
    store.add(std::vector<CaseRow>{{1, "", {force_N, count, std::string(cpu)}}});
  };
  keep("a", "Alder", 1.0, 7);
  keep("b", "Zen", 1.0 + 1e-12, 7);
  keep("far", "Zen", 1.0 + 1e-6, 7);
  keep("other-count", "Zen", 1.0, 8);
  keep("infinite", "Zen", std::numeric_limits<double>::infinity(), 7);
  keep("absent", "Zen", std::numeric_limits<double>::quiet_NaN(), 7);
  keep("below", "Zen", -std::numeric_limits<double>::infinity(), 7);
  EXPECT_THROW(CaseStore(file("infinite"), own).merge(file("below"), 1e-9), BadData);
  CaseStore store(file("a"), own);
  try {
    store.merge(file("b"));
    ADD_FAILURE() << "to the bit they differ";
  } catch (const BadData& e) {
    EXPECT_THAT(e.what(), HasSubstr("case 1 has another result"));
    EXPECT_THAT(e.what(), HasSubstr("Made on Zen and on Alder; --merge-tolerance"));
  }
  EXPECT_EQ(store.merge(file("b"), 1e-9).repeated, 1U);
  for (const char* const name : {"far", "other-count", "infinite", "absent"}) {
    EXPECT_THROW(store.merge(file(name), 1e-9), BadData) << name;
  }
}

// Whatever column was edited, and a row that came from another file: refused with its number, to open and to merge.
TEST_F(Store, ARowThatWasChangedAfterwardsIsRefused) {
  for (const char* const edit :
       {"UPDATE cases SET \"lag \"\"m\"\"\" = 1.0000000000000002 WHERE case_number = 2",
        "UPDATE cases SET name = 'other' WHERE case_number = 2", "UPDATE cases SET name = NULL WHERE case_number = 2",
        "UPDATE cases SET time_s = 0.25 WHERE case_number = 2",
        "UPDATE cases SET status = 'failed', error = 'no' WHERE case_number = 2",
        "DELETE FROM cases WHERE case_number = 3; UPDATE cases SET case_number = 3 WHERE case_number = 2",
        "UPDATE cases SET row_check = NULL WHERE case_number = 2"}) {
    std::filesystem::remove(file("a"));
    std::filesystem::remove(file("b"));
    {
      CaseStore store(file("a"), table());
      store.start_run({});
      store.add(std::vector<CaseRow>{row(1, 1.0, 0.5), row(2, 1.0, 0.5), row(3, 2.0, 0.5)});
    }
    { const CaseStore again(file("a"), table()); }
    sql("a", edit);
    CaseStore other(file("b"), table());
    for (const auto& use : std::vector<std::function<void()>>{[&] { const CaseStore changed(file("a"), table()); },
                                                              [&] { other.merge(file("a")); }}) {
      try {
        use();
        ADD_FAILURE() << "was taken: " << edit;
      } catch (const BadData& error) {
        EXPECT_THAT(error.what(), testing::ContainsRegex("case [23] is not as it was stored")) << edit;
      }
    }
    EXPECT_TRUE(other.done().empty());
  }
}

TEST_F(Store, ARowOfAnotherSpecificationIsNotTaken) {
  for (const auto& [name, specification] : {std::pair{"a", "one"}, {"b", "two"}}) {
    CaseStore store(file(name), table(specification));
    store.start_run({});
    store.add(std::vector<CaseRow>{row(std::string(name) == "a" ? 1 : 2, 1.0, 0.5)});
  }
  sql("a", ("ATTACH '" + file("b").string() + "' AS b; INSERT INTO main.cases SELECT * FROM b.cases").c_str());
  EXPECT_THROW(CaseStore(file("a"), table("one")), BadData);
}

TEST_F(Store, GrowsWithTheNumberOfCases) {
  CaseTable more = table();
  { const CaseStore store(file("a"), more); }
  more.cases = 40;
  { const CaseStore store(file("a"), more); }
  more.cases = 3;
  { const CaseStore store(file("a"), more); }
  sql("a", "CREATE TABLE checked(cases CHECK(cases = 40)); INSERT INTO checked SELECT cases FROM sweep");
}

TEST_F(Store, IsWrittenAsCsv) {
  CaseStore store(CaseStore::in_memory, table());
  store.start_run({});
  store.add(std::vector<CaseRow>{row(0, 0.1, std::nan("")), {1, "it\nbroke", {}}});
  store.write_csv(file("rows.csv"));
  EXPECT_EQ(read_file(file("rows.csv")),
            "case_number,run,status,error,name,count,\"lag \"\"m\"\"\",time_s\n"
            "0,1,ran,,\"a, \"\"b\"\"\",7,0.1,\n"
            "1,1,failed,\"it\nbroke\",,,,\n");
}

}  // namespace
}  // namespace touchstone::runs
