// The table of bad files: each run through the real program, with the message it must get and exit status 3. No file
// that exists may be harmed by any of them.
#include "harness/pipeline/evaluation/sample_scan_for_test.h"
#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using testing::Outcome;

class BadInput : public testing::BuiltProgram {};

const std::string header = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";

std::string rows(int count, const std::string& replaced = "", int at = -1) {
  std::string out = header;
  for (int i = 0; i < count; ++i) {
    out += i == at ? replaced + "\n" : fmt::format("{},0.05,{},0,0,0,1\n", 0.001 * i, 0.05 + 0.00001 * i);
  }
  return out;
}

const std::string good_mesh = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n";
const std::string good_model =
    R"({"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stiffness_N_per_m": 500}})";

struct Bad {
  std::string name;
  std::string recording = rows(100);
  std::string mesh = good_mesh;
  std::string model = good_model;
  std::string expected;    // in the message
  std::string names = "";  // the file that the message names; "" where it is not one of the three
  std::string options = "";
  std::string mesh_name = "mesh.obj";
};

std::vector<Bad> table() {
  std::vector<Bad> out;
  const auto recording = [&](std::string name, std::string text, std::string expected) {
    Bad bad;
    bad.name = std::move(name), bad.recording = std::move(text), bad.expected = std::move(expected),
    bad.names = "rec.csv";
    out.push_back(bad);
  };
  recording("empty recording", "", "empty");
  recording("header only", header, "sample");
  recording("missing column", "t_s,x_m,y_m,fx_N,fy_N,fz_N\n0,0,0,0,0,1\n1,0,0,0,0,1\n", "z");
  recording("no force", "t_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0\n", "force");
  recording("unknown unit", "t_s,x_in,y_in,z_in,fx_N,fy_N,fz_N\n0,0,0,0,0,0,1\n1,0,0,0,0,0,1\n", "x_in");
  recording("unknown column", "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,mood\n0,0,0,0,0,0,1,1\n", "mood");
  recording("NaN position", rows(100, "0.05,nan,0.05,0,0,0,1", 50), "52");
  recording("infinite force", rows(100, "0.05,0.05,0.05,0,0,0,inf", 50), "52");
  recording("text for a number", rows(100, "0.05,0.05,left,0,0,0,1", 50), "left");
  recording("too few cells", rows(100, "0.05,0.05,0.05", 50), "52");
  recording("time goes back", rows(100, "0.01,0.05,0.05,0,0,0,1", 50), "time");
  recording("time repeats", rows(100, "0.049,0.05,0.05,0,0,0,1", 50), "time");
  recording("one sample", rows(1), "sample");
  recording("truncated last line", rows(100).substr(0, rows(100).size() - 6), "101");
  recording("not a table", std::string("\x89HDF\r\n\x1a\n\0\0\0", 11), "rec.csv");
  const auto mesh = [&](std::string name, std::string text, std::string expected, std::string file = "mesh.obj") {
    Bad bad;
    bad.name = std::move(name), bad.mesh = std::move(text), bad.expected = std::move(expected), bad.mesh_name = file,
    bad.names = file;
    out.push_back(bad);
  };
  mesh("empty mesh", "", "");
  mesh("zero triangles", "v 0 0 0\nv 1 0 0\n", "triangle");
  mesh("index out of range", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "4");
  mesh("NaN in a mesh", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "1");
  mesh("unknown mesh format", good_mesh, "mesh.stp", "mesh.stp");
  mesh("truncated STL", std::string(80, ' ') + std::string("\x02\0\0\0", 4) + std::string(60, '\0'), "mesh.stl",
       "mesh.stl");
  const auto model = [&](std::string name, std::string text, std::string expected) {
    Bad bad;
    bad.name = std::move(name), bad.model = std::move(text), bad.expected = std::move(expected),
    bad.names = "model.json";
    out.push_back(bad);
  };
  model("empty model", "", "model.json");
  model("model is no JSON", "{\"schema\": ", "line");
  model("unknown renderer", R"({"schema": "touchstone-model/1", "renderer": "good-object"})", "god-object");
  model("misspelt parameter",
        R"({"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stifness_N_per_m": 5}})",
        "stifness_N_per_m");
  model("parameter out of range",
        R"({"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stiffness_N_per_m": -5}})", "-5");
  model("parameter that is text",
        R"({"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stiffness_N_per_m": "soft"}})",
        "stiffness_N_per_m");
  model(
      "unknown effect",
      R"({"schema": "touchstone-model/1", "renderer": "god-object", "effects": [{"name": "coulomb", "parameters": {}}]})",
      "coulomb");
  model("unread key", R"({"schema": "touchstone-model/1", "renderer": "god-object", "colour": "red"})", "colour");
  model("another schema", R"({"schema": "touchstone-case/1", "renderer": "god-object"})", "touchstone-model/1");
  Bad far;
  far.name = "mesh in millimetres read as metres";
  far.mesh = "v 20 20 500\nv 120 20 500\nv 120 120 500\nv 20 120 500\nf 1 2 3\nf 1 3 4\n";
  far.recording = header;
  for (int i = 0; i < 100; ++i) far.recording += fmt::format("{},0.05,{},0.5,0,0,1\n", 0.001 * i, 0.05 + 1e-5 * i);
  far.expected = "mm";
  out.push_back(far);
  Bad reversed;
  reversed.name = "reversed forces";
  reversed.recording = header;
  for (int i = 0; i < 5000; ++i) {
    reversed.recording +=
        fmt::format("{},0.05,{},0,0,0,{}\n", 0.001 * i, 0.05 + 1e-6 * i, -1.0 - 0.3 * std::sin(0.01 * i));
  }
  reversed.expected = "--flip-force";
  reversed.names = "rec.csv";
  out.push_back(reversed);
  Bad open;
  open.name = "mesh with holes where a closed one is needed";
  open.options = "--closed";
  open.expected = "closed";
  open.names = "mesh.obj";
  out.push_back(open);
  Bad unwritable;
  unwritable.name = "output folder that cannot be written";
  unwritable.options = "--out model.json/out";
  unwritable.expected = "cannot be written";
  out.push_back(unwritable);
  Bad range;
  range.name = "time range without samples";
  range.options = "--time-range 50:60";
  range.expected = "50:60";
  range.names = "rec.csv";
  out.push_back(range);
  return out;
}

TEST_F(BadInput, EachIsRefusedWithItsMessageAndStatusThree) {
  for (const Bad& bad : table()) {
    SCOPED_TRACE(bad.name);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write_file(folder_ / "rec.csv", bad.recording);
    write_file(folder_ / bad.mesh_name, bad.mesh);
    write_file(folder_ / "model.json", bad.model);
    const std::string command =
        fmt::format("evaluate --recording rec.csv --mesh {} --model model.json {}", bad.mesh_name,
                    bad.options.find("--out") == std::string::npos ? "--out out " + bad.options : bad.options);
    const Outcome ran = run(command);
    EXPECT_EQ(ran.status, 3) << ran.err;
    EXPECT_NE(ran.err.find(bad.expected), std::string::npos) << "expected \"" << bad.expected << "\" in: " << ran.err;
    EXPECT_NE(ran.err.find(bad.names), std::string::npos) << ran.err;
    EXPECT_EQ(ran.err.find("internal error"), std::string::npos) << ran.err;
    // The inputs are as they were, and no half of an output is left.
    EXPECT_EQ(read_file(folder_ / "rec.csv"), bad.recording);
    EXPECT_EQ(read_file(folder_ / "model.json"), bad.model);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "report.html"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "rendered.csv"));
  }
}

TEST_F(BadInput, ATruncatedHdf5FileIsRefused) {
  save_recording(folder_ / "rec.h5", pipeline::scan(0.0));
  const std::string whole = read_file(folder_ / "rec.h5");
  write_file(folder_ / "mesh.obj", good_mesh);
  write_file(folder_ / "model.json", good_model);
  for (const double part : {0.0, 0.1, 0.5, 0.95}) {
    write_file(folder_ / "cut.h5", whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
    const Outcome ran = run(
        fmt::format("evaluate --recording '{0}/cut.h5' --mesh '{0}/mesh.obj' --model '{0}/model.json' --out '{0}/out'",
                    folder_.string()));
    EXPECT_EQ(ran.status, 3) << part << ": " << ran.err;
    EXPECT_NE(ran.err.find("cut.h5"), std::string::npos) << ran.err;
  }
}

TEST_F(BadInput, ARefusedRunLeavesAnEarlierReportAsItWas) {
  write_file(folder_ / "mesh.obj", good_mesh);
  write_file(folder_ / "model.json", good_model);
  write_file(folder_ / "rec.csv", rows(100, "0.05,nan,0.05,0,0,0,1", 90));
  std::filesystem::create_directories(folder_ / "out");
  for (const char* const name : {"report.html", "result.json", "rendered.csv"})
    write_file(folder_ / "out" / name, "earlier");
  const Outcome ran = run(
      fmt::format("evaluate --recording '{0}/rec.csv' --mesh '{0}/mesh.obj' --model '{0}/model.json' --out '{0}/out'",
                  folder_.string()));
  EXPECT_EQ(ran.status, 3) << ran.err;
  for (const char* const name : {"report.html", "result.json", "rendered.csv"})
    EXPECT_EQ(read_file(folder_ / "out" / name), "earlier");
}

TEST_F(BadInput, UsageIsStatusTwo) {
  for (const char* const arguments :
       {"evaluate --recording only.csv", "evaluate --metrics rms_farce_error", "evaluate --threshold 5",
        "evaluate --tip-radius 3", "evaluate --time-range 6:0", "evaluate --in-trajectory guessed",
        "evaluate --mesh-unit inch", "fit", "nonsense", "nonsense --help"}) {
    const Outcome ran = run(arguments);
    EXPECT_EQ(ran.status, 2) << arguments << ": " << ran.err;
  }
}

TEST_F(BadInput, ASlipNamesWhatWasMeant) {
  for (const auto& [arguments, meant] : {std::pair{"evalute", "did you mean \"evaluate\"?"},
                                         {"golden revew", "did you mean \"review\"?"},
                                         {"evaluate --recordng r.csv", "--recordng: did you mean --recording?"}}) {
    const Outcome ran = run(arguments);
    EXPECT_EQ(ran.status, 2) << arguments;
    EXPECT_THAT(ran.err, ::testing::HasSubstr(meant));
  }
}

}  // namespace
}  // namespace touchstone::apps
