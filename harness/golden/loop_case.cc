#include "harness/golden/loop_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/base/other_program.h"
#include "harness/base/scratch_folder.h"
#include "harness/golden/judges.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::golden {
namespace {

constexpr double margin = 0.06;
constexpr double octaves = 1.0 / 6.0;  // to both sides
constexpr double strength_jnd = 1.0;

constexpr std::array<std::pair<const char*, double LoopFigures::*>, 5> number_keys{
    {{"loop_stable_margin", &LoopFigures::stable_margin},
     {"loop_buzz_Hz", &LoopFigures::buzz_Hz},
     {"loop_buzz_N", &LoopFigures::buzz_N},
     {"loop_buzz_jnd", &LoopFigures::buzz_jnd},
     {"loop_energy_J", &LoopFigures::energy_J}}};
constexpr const char* verdict_key = "loop_verdict";

// A device or a grip: a file of the case's folder, or a name that the program knows.
std::string sheet(const GoldenCase& golden, const std::string& wanted) {
  const auto file = golden.folder / wanted;
  return std::filesystem::is_regular_file(file) ? file.string() : wanted;
}

LoopFigures read_result(const std::filesystem::path& file, const std::string& name) {
  const nlohmann::json whole = load_json(file);
  const auto& runs = whole.at("runs");
  if (runs.size() != 1) {
    throw BadData(
        fmt::format("{}: the device's mass is not published, and a golden holds one run: give \"set\": "
                    "{{\"mass_kg\": ...}} in \"loop\"",
                    name));
  }
  const auto& run = runs.at(0);
  const auto& buzz = run.at("buzz");
  LoopFigures out{whole.at("verdict").get<std::string>(), whole.at("stable_margin").get<double>(),
                  buzz.at("frequency_Hz").get<double>(),  buzz.at("amplitude_N").get<double>(),
                  buzz.at("jnd").get<double>(),           run.at("energy_J").get<double>()};
  if (out.verdict == "cannot tell")
    throw BadData(fmt::format("{}: no loop to judge: {}", name, whole.at("sentence").get<std::string>()));
  return out;
}

}  // namespace

void add_to(Provenance& provenance, const LoopFigures& figures) {
  provenance[verdict_key] = figures.verdict;
  for (const auto& [name, figure] : number_keys) provenance[name] = fmt::format("{:.17g}", figures.*figure);
}

LoopFigures loop_figures_of(const Provenance& provenance, const std::string& source) {
  const auto text = [&](const char* name) -> const std::string& {
    const auto found = provenance.find(name);
    if (found == provenance.end())
      throw BadData(fmt::format("{}: has no {}: it is no golden of a loop; accept one that is", source, name));
    return found->second;
  };
  LoopFigures out;
  out.verdict = text(verdict_key);
  for (const auto& [name, figure] : number_keys) {
    const std::string& number = text(name);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), out.*figure);
    if (error != std::errc{} || end != number.data() + number.size())
      throw BadData(fmt::format("{}: {} is \"{}\": a number was expected", source, name, number));
  }
  return out;
}

LoopRun run_loop_program(const std::filesystem::path& program, const GoldenCase& golden,
                         const surface::TriangleMesh& mesh, const recording::InTrajectory& trajectory,
                         rendering::Model model) {
  if (program.empty()) {
    throw BadData(
        fmt::format("{}: closes a loop, which the extra `touchstone loop` runs; touchstone-loop is neither "
                    "beside this program nor on PATH: install it, or build extras/loop",
                    golden.name));
  }
  const CaseLoop& loop = *golden.loop;
  const ScratchFolder scratch;
  const auto at = [&](const char* file) { return (scratch.path() / file).string(); };
  save_mesh(mesh, at("mesh.obj"));
  save_trajectory(at("path.h5"), trajectory);
  take_pictures_along(model, scratch.path());
  write_file(at("model.json"), model_to_json(model, scratch.path()));
  OtherProgram other{{program.string(), "--device", sheet(golden, loop.device), "--grip", sheet(golden, loop.grip),
                      "--seed", std::to_string(loop.seed), "--model", at("model.json"), "--mesh", at("mesh.obj"),
                      "--path", at("path.h5"), "--out", at("out"), "--rendered", at("rendered.h5")},
                     Printed::dropped,
                     Printed::kept};
  for (const auto& [name, value] : loop.set) {
    other.words.emplace_back("--set");
    other.words.push_back(fmt::format("{}={:.17g}", name, value));
  }
  if (model.provided && !model.provided->library.empty()) {
    other.words.emplace_back("--plugin");
    other.words.push_back(model.provided->library.string());
  }
  other.ends_with_this = true;
  const auto end = run_other(other);
  if (!end) throw BadData(fmt::format("{}: {} cannot be started", golden.name, program.string()));
  if (end->status != 0)
    throw BadData(fmt::format("{}: {} failed ({}): {}", golden.name, program.string(), end->status, end->err));
  LoopRun run;
  run.figures = read_result(scratch.path() / "out" / "result.json", golden.name);
  run.rendered = recording::load_rendered(at("rendered.h5"));
  return run;
}

std::vector<std::string> loop_differences(const LoopFigures& golden, const LoopFigures& obtained) {
  std::vector<std::string> out;
  if (golden.verdict != obtained.verdict)
    out.push_back(fmt::format("the loop's verdict is {}, the golden's {}", obtained.verdict, golden.verdict));
  // The larger in terms of the smaller, so that none alone comes near.
  if (!(std::abs(std::log(obtained.stable_margin / golden.stable_margin)) <= std::log1p(margin)) &&
      !(obtained.stable_margin == 0.0 && golden.stable_margin == 0.0)) {
    out.push_back(fmt::format("the stable margin is {:.4g}, the golden's {:.4g}, {:g} % may differ",
                              obtained.stable_margin, golden.stable_margin, 100.0 * margin));
  }
  if (golden.repeats() && obtained.repeats()) return out;
  if (!(std::abs(std::log2(obtained.buzz_Hz / golden.buzz_Hz)) <= octaves)) {
    out.push_back(fmt::format("it buzzes at {:.4g} Hz, the golden at {:.4g}: another third of an octave",
                              obtained.buzz_Hz, golden.buzz_Hz));
  }
  if (!(std::abs(obtained.buzz_jnd - golden.buzz_jnd) < strength_jnd)) {
    out.push_back(
        fmt::format("it buzzes with {:.4g} N ({:.3g} JND), the golden with {:.4g} N ({:.3g} JND): a "
                    "difference that is noticed",
                    obtained.buzz_N, obtained.buzz_jnd, golden.buzz_N, golden.buzz_jnd));
  }
  return out;
}

// Sample by sample where both repeat, and by their figures.
void judge_loop(const JudgedRun& judged, CheckResult& result) {
  if (!judged.golden.loop) return;
  const auto file = judged.golden.expected(judged.model.name);
  const LoopFigures golden = loop_figures_of(read_provenance(file), file.string());
  const LoopFigures& obtained = *judged.run.loop;
  if (!golden.repeats() || !obtained.repeats()) {
    Comparison figures;
    figures.expected_rows = result.comparison.expected_rows;
    figures.obtained_rows = result.comparison.obtained_rows;
    figures.problems = {fmt::format("of a loop that {}, no sample repeats: its figures are compared",
                                    golden.repeats() ? obtained.verdict : golden.verdict)};
    if (!result.comparison.bad_data) result.comparison = std::move(figures);
  }
  for (std::string& difference : loop_differences(golden, obtained)) {
    result.comparison.problems.push_back(std::move(difference));
    result.comparison.verdict = worst(result.comparison.verdict, Verdict::worse);
  }
}

std::vector<std::pair<std::string, double>> metrics_of(const LoopFigures& figures) {
  return {{"stable_margin", figures.stable_margin}, {"buzz_N", figures.buzz_N}, {"energy_J", figures.energy_J}};
}

}  // namespace touchstone::golden
