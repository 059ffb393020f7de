// Every kind of JSON file that people write, with each of its keys misspelt in turn: the program names the key, the
// line and the key that was meant.
#include <fmt/ranges.h>

#include <regex>
#include <vector>

#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::AllOf, ::testing::AnyOf, ::testing::HasSubstr;
using testing::Outcome;

struct Kind {
  std::string schema, command, file, text;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"touchstone-model/1", "replay --mesh mesh.obj --trajectory good.csv --out out.csv --model m.json", "m.json",
       R"({"schema": "touchstone-model/1",
 "renderer": "god-object",
 "parameters": {"stiffness_N_per_m": 500},
 "effects": [
  {"name": "coulomb-friction",
   "parameters": {
    "mu_dynamic": 0.3}}],
 "instrument": []})"},
      {"touchstone-effect/1",
       "discrepancy --model model.json --mesh mesh.obj --recording good.csv --out out --effect e.json", "e.json",
       R"({"schema": "touchstone-effect/1",
 "name": "creep",
 "summary": "pulls back",
 "source": "a test",
 "acts_on": "friction",
 "parameters": {
  "gain": {
   "unit": "N s/m",
   "minimum": 0,
   "maximum": 1,
   "start": 0.5}},
 "formula": {
  "along_N": "-gain * speed_m_per_s"}})"},
      {"touchstone-scene/1", "replay --model model.json --trajectory good.csv --out out.csv --scene s.json", "s.json",
       R"({"schema": "touchstone-scene/1",
 "bodies": [
  {"name": "floor",
   "mesh": "mesh.obj",
   "unit": "m",
   "pose": {
    "p_m": [0, 0, 0]}}]})"},
      {"touchstone-dataset/1", "dataset check data", "data/dataset.json",
       R"({"schema": "touchstone-dataset/1",
 "object": "plate",
 "mesh": {
  "file": "mesh.obj",
  "unit": "m"},
 "tip_radius_m": 0,
 "instrument": "none",
 "instrument_file": "i.json",
 "stiffness_N_per_m": 500,
 "friction_coefficient": 0.1,
 "in_trajectory": "measured",
 "recordings": [
  {"file": "good.csv",
   "shows": "a press",
   "repeat": "again.csv"}],
 "source": "here",
 "licence": "none"})"},
      {"touchstone-instrument/1",
       "discrepancy --model model.json --mesh mesh.obj --recording good.csv --out out --instrument i.json", "i.json",
       R"({"schema": "touchstone-instrument/1",
 "force_noise_N": 0.01,
 "force_noise_time_constant_s": 0.1,
 "force_step_N": [0, 0, 0],
 "position_noise_m": 1e-5,
 "position_wander_m": 0,
 "position_rate_Hz": 60,
 "geometry_error_m": 1e-4})"},
      {"touchstone-thresholds/1", "perceive --real good.csv --condition a=good.csv --out out --thresholds t.json",
       "t.json",
       R"({"schema": "touchstone-thresholds/1",
 "force_absolute_N": 0.1,
 "vibration_threshold": {
  "frequency_Hz": [10, 100],
  "amplitude_N": [0.1, 0.01]},
 "sources": {}})"},
      {"touchstone-tolerance/1", "compare good.csv good.csv --tolerance t.json", "t.json",
       R"({"schema": "touchstone-tolerance/1",
 "reason": "a test",
 "time": {
  "beyond": 0},
 "force": {
  "atol_N": 1e-3,
  "rtol": 1e-3,
  "rpeak": 0,
  "rms_N": 1e-3,
  "direction_rad": 0.1,
  "direction_floor_N": 0.1},
 "contact": {
  "tube_s": 0.001}})"},
      {"touchstone-golden-case/1", "check --golden g --out out", "g/press/case.json",
       R"({"schema": "touchstone-golden-case/1",
 "name": "press",
 "summary": "a press",
 "surface": {
  "name": "sphere",
  "parameters": {
   "radius_m": 0.03},
  "triangles": 100},
 "trajectory": {
  "name": "push",
  "parameters": {
   "height_m": 0.002},
  "seed": 1,
  "rate_Hz": 1000,
  "offset_m": [0, 0, 0.03]},
 "scale": 1,
 "speed": 1,
 "models": {"steel": {
   "schema": "touchstone-model/1",
   "renderer": "god-object",
   "parameters": {
    "stiffness_N_per_m": 500}}},
 "tolerance": {
  "reason": "a test",
  "force": {
   "rtol": 1e-6}},
 "jnd_share": 0.05})"},
      {"touchstone-import/1", "import log.txt --map m.json --out out.csv", "m.json",
       R"({"schema": "touchstone-import/1",
 "about": "a test",
 "table": {
  "separator": "comma",
  "decimal": "point"},
 "columns": {"t_s": {
   "from": "t",
   "scale": 1},
  "z_m": {
   "from": "z"}}})"},
      {"touchstone-acquisition/1", "acquire run a.json --out out.csv", "a.json",
       R"({"schema": "touchstone-acquisition/1",
 "force": {
  "file": "f.csv",
  "cutoff_Hz": 20},
 "motion": {
  "file": "m.csv",
  "largest_gap_s": 0.1},
 "probe": {
  "tip_P_m": [0, 0, 0.05],
  "tip_S_m": [0, 0, 0.05],
  "q_PS": [1, 0, 0, 0],
  "tip_radius_m": 0},
 "tool": {
  "file": "s.csv",
  "gravity_T_m_per_s2": [0, 0, -9.8]},
 "clocks": {
  "tap_normal_W": [0, 0, 1],
  "tap_threshold_N": 0.1},
 "registration": {
  "markers": "k.csv",
  "contact_force_N": 0.2}})"},
      {"touchstone-sweep/1", "sweep s.json --dry-run", "s.json",
       R"({"schema": "touchstone-sweep/1",
 "design": "latin-hypercube",
 "cases": 3,
 "design_seed": 1,
 "surfaces": {"ball": {
   "name": "sphere",
   "parameters": {},
   "triangles": 200}},
 "trajectories": {"hand": {
   "name": "hand-scan",
   "offset_m": [0, 0, 0.03]}},
 "models": {"god": {
   "schema": "touchstone-model/1",
   "renderer": "god-object",
   "parameters": {}}},
 "vary": [
  {"set": "/model/parameters/stiffness_N_per_m",
   "from": 100,
   "to": 200,
   "spacing": "log"}],
 "seeds": [1],
 "truth": true})"},
      {"touchstone-tool-sweep/1", "sweep s.json --dry-run", "s.json",
       R"({"schema": "touchstone-tool-sweep/1",
 "design": "grid",
 "contacts": {"corner": {
   "case": "box-corner",
   "scale": 1}},
 "renderers": {"voxels": {
   "renderer": "voxmap-pointshell",
   "parameters": {},
   "stiffness_N_per_m": 1000,
   "rotational_stiffness_Nm_per_rad": 2}},
 "vary": [
  {"set": "/renderer/parameters/voxel_m",
   "values": [1e-3]}]})"},
      {"touchstone-farm/1", "sweep sweep.json --engine jobs --tasks 2 --dry-run --farm f.json", "f.json",
       R"({"schema": "touchstone-farm/1",
 "prologue": ["true"],
 "inside": ["true"],
 "program": "touchstone",
 "node_store": "/tmp",
 "kubernetes": {
  "image": "i",
  "claim": "c",
  "mount": "/data"}})"},
      {"touchstone-hardware/1", "hil probe --map h.json", "h.json",
       R"({"schema": "touchstone-hardware/1",
 "devices": [
  {"id": "ati-netft",
   "serial": "FT1",
   "connected": false,
   "address": "127.0.0.1",
   "fixture": "plate",
   "http_port": 80,
   "udp_port": 81,
   "calibration": {
    "file": "c.xml",
    "sha256": "0",
    "expires": "2030-01-01"}}]})"},
      {"touchstone-history/1", "history --local h.jsonl --limits l.json", "l.json",
       R"({"schema": "touchstone-history/1",
 "false_alarms_per_year": 0.01,
 "limits": [
  {"metric": "force_*",
   "worse": "up",
   "max": 1,
   "smallest_relative": 0.1,
   "smallest_absolute": 0.1}]})"},
      {"touchstone-tool-golden/1", "tool golden t.json", "t.json",
       R"({"schema": "touchstone-tool-golden/1",
 "case": "peg-0.2mm",
 "seconds": 1,
 "keep_every": 10,
 "stiffness_N_per_m": 1000,
 "rotational_stiffness_Nm_per_rad": 2,
 "renderers": ["god-object-tool"],
 "tolerance": {
  "force_N": [1, 1, 1],
  "torque_Nm": [1, 1, 1],
  "reason": "a test"},
 "accepted": []})"},
  };
  return all;
}

class MisspeltKey : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    BuiltProgram::SetUp();
    if (IsSkipped()) return;
    std::string rows = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
    for (int i = 0; i < 100; ++i) rows += fmt::format("{},0.05,0.05,{},0,0,1\n", 0.001 * i, 0.00001 * i);
    for (const char* const folder : {"data", "g/press"}) std::filesystem::create_directories(folder_ / folder);
    for (const char* const file : {"good.csv", "data/good.csv", "data/again.csv"}) write_file(folder_ / file, rows);
    for (const char* const file : {"mesh.obj", "data/mesh.obj"})
      write_file(folder_ / file, "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "model.json", R"({"schema": "touchstone-model/1", "renderer": "god-object"})");
    write_file(folder_ / "log.txt", "t,z\n0,1\n1,2\n");
    write_file(folder_ / "h.jsonl", "");
    for (const Kind& kind : kinds()) {
      if (kind.schema == "touchstone-sweep/1") write_file(folder_ / "sweep.json", kind.text);
    }
  }
};

// Those that no reader can know: names of models, contacts and columns, which are data.
bool is_data(const std::string& key) {
  static const std::vector<std::string> names{"ball", "hand", "god", "corner", "voxels", "steel", "gain", "t_s", "z_m"};
  return std::ranges::find(names, key) != names.end();
}

// Parameters of surfaces and motions are named by their generators, which know no file.
bool is_of_generator(const std::string& key) { return key == "radius_m" || key == "height_m"; }

TEST_F(MisspeltKey, IsNamedWithItsLineAndTheKeyThatWasMeant) {
  const std::regex name(R"re("([A-Za-z_0-9]+)": )re");
  for (const Kind& kind : kinds()) {
    std::size_t tried = 0;
    for (std::sregex_iterator at(kind.text.begin(), kind.text.end(), name), end; at != end; ++at) {
      const std::string key = (*at)[1];
      if (is_data(key)) continue;
      std::string slip = key;  // two letters change places, or one doubles
      const std::size_t i = key.size() / 2 - (key.size() > 2 ? 1 : 0);
      if (key.size() >= 4) std::swap(slip[i], slip[i + 1]);
      if (slip == key) slip.insert(i, 1, key[i]);
      std::string text = kind.text;
      text.replace(static_cast<std::size_t>(at->position(1)), key.size(), slip);
      const auto line = 1 + std::count(kind.text.begin(), kind.text.begin() + at->position(1), '\n');
      write_file(folder_ / kind.file, text);
      const Outcome ran = run(kind.command);
      SCOPED_TRACE(fmt::format("{}: {} in line {}", kind.schema, slip, line));
      // `check` reports what is wrong in a case beside the other cases.
      EXPECT_TRUE(ran.status == 3 || (ran.status == 1 && kind.command.starts_with("check"))) << ran.out;
      const std::string said = ran.out + ran.err;
      if (is_of_generator(key)) {
        EXPECT_THAT(said, HasSubstr(fmt::format("\"{}\"; did you mean \"{}\"?", slip, key)));
        continue;
      }
      const std::string unread = fmt::format("\"{}\" (line {}); did you mean \"{}\"?", slip, line, key);
      const std::string missing =
          fmt::format("\"{}\" is missing; is \"{}\" (line {}) meant to be it?", key, slip, line);
      const std::string named = fmt::format("\"{}\"; did you mean \"{}\"?", slip, key);  // parameters and formulas
      EXPECT_THAT(said, AnyOf(HasSubstr(unread), HasSubstr(missing),
                              AllOf(HasSubstr(named), HasSubstr(fmt::format("(line {})", line)))));
      ++tried;
    }
    EXPECT_GE(tried, 5U) << kind.schema;
  }
}

}  // namespace
}  // namespace touchstone::apps
