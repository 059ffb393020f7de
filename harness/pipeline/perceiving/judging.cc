#include "harness/pipeline/perceiving/judging.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/freed_memory.h"
#include "harness/base/progress.h"
#include "harness/discrepancy/instrument_description.h"
#include "harness/perception/judge/replay_path.h"
#include "harness/pipeline/perceiving/processes.h"
#include "harness/report/console.h"
#include "harness/report/judgement_page.h"
#include "harness/report/page_html.h"

namespace touchstone::pipeline {
using recording::Recording;

namespace {

namespace pc = perception;

pc::JudgeOptions judge_options(const JudgeSettings& options) {
  pc::JudgeOptions settings;
  if (!options.thresholds.empty()) settings.thresholds = pc::read_thresholds(options.thresholds);
  if (options.depth_known) settings.thresholds.depth_fraction = 0.0;
  if (!options.instrument.empty()) {
    const auto instrument = discrepancy::load_instrument(options.instrument);
    settings.declared = {instrument.force_noise_N, instrument.force_noise_time_constant_s,
                         geometry_deviation_m(instrument)};
  }
  for (const auto& name : options.without) {
    std::string known;
    bool found = false;
    for (std::size_t c = 0; c < pc::channel_count; ++c) {
      const auto channel = static_cast<pc::Channel>(c);
      known += fmt::format("{}{}", c == 0 ? "" : ", ", pc::name_of(channel));
      if (name != pc::name_of(channel)) continue;
      settings.without.push_back(channel);
      found = true;
    }
    if (!found) throw UsageError(fmt::format("--without {}: one of {} was expected", name, known));
  }
  return settings;
}

// Models and files as sources of recordings; what is wrong with a model is said before anything runs.
struct PerceiveSources {
  std::vector<pc::RecordingSource> repeats;
  std::vector<pc::RecordingSource> conditions;
  RolesAndFiles inputs;
  std::vector<std::string> notes;
};

PerceiveSources perceive_sources(const rendering::Catalogue& catalogue, const PerceiveRequest& request,
                                 const Recording& real) {
  PerceiveSources sources;
  sources.inputs.emplace_back("real", request.real);
  const auto from_file = [&request, &real](const std::string& name, const std::string& file) {
    return pc::RecordingSource{name, [&request, &real, file] {
                                 Recording recording = read_recording(request, file);
                                 check_condition(real, recording);
                                 return recording;
                               }};
  };
  for (const auto& file : request.repeats) {
    sources.inputs.emplace_back("repeat", file);
    sources.repeats.push_back(from_file(file, file));
  }
  for (const auto& [name, file] : request.conditions) {
    sources.inputs.emplace_back("condition " + name, file);
    sources.conditions.push_back(from_file(name, file));
  }
  std::shared_ptr<const surface::Surface> surface;
  std::shared_ptr<const pc::ReplayPath> path;
  auto mode = recording::InTrajectoryMode::measured;
  if (!request.models.empty()) {
    surface = rendered_object(request, real, sources.notes);
    path = std::make_shared<const pc::ReplayPath>(pc::replay_path(real.motion));
    sources.inputs.emplace_back("mesh", request.mesh);
    mode = models_path_of(catalogue, request, real, *surface, sources.notes);
  }
  check_real(request, real, surface.get(), sources.notes);
  for (const auto& rendering : request.models) {
    sources.inputs.emplace_back("model " + rendering.name, rendering.file);
    catalogue.find(rendering.model);
    sources.conditions.push_back({rendering.name,
                                  [&catalogue, &model = rendering.model, surface, path, &real, mode] {
                                    return rendered_by(catalogue, model, surface, real, path->motion, mode);
                                  },
                                  path->samples});
  }
  if (!request.judge.thresholds.empty()) sources.inputs.emplace_back("thresholds", request.judge.thresholds);
  if (!request.judge.instrument.empty()) sources.inputs.emplace_back("instrument", request.judge.instrument);
  return sources;
}

}  // namespace

JudgedFiles judge_files(const rendering::Catalogue& catalogue, const PerceiveRequest& request) {
  JudgedFiles result;
  result.options = judge_options(request.judge);
  const Recording real = read_recording(request, request.real);
  const Vec3 outward =
      request.direction == "force" ? pc::pressing_direction(real) : press_direction_of(request.direction, real);
  const PerceiveSources sources = perceive_sources(catalogue, request, real);
  result.notes = sources.notes;
  result.provenance = report::make_provenance(request.command_line);
  result.provenance.inputs = described(sources.inputs);
  keep_freed_memory();
  Progress progress("conditions", sources.conditions.size());
  result.judged = pc::judge_conditions(real, sources.repeats, sources.conditions, outward, result.options,
                                       [&progress](std::size_t done) { progress.update(done); });
  return result;
}

std::string JudgedFiles::table() const {
  std::vector<std::vector<std::string>> rows{{"rank", "condition", "a person tells it", "95 %", "d'", "verdict", "by"}};
  std::vector<const pc::JudgedCondition*> ranked;
  for (const auto& c : judged.conditions) ranked.push_back(&c);
  std::ranges::sort(ranked, {}, &pc::JudgedCondition::rank);
  for (const auto* c : ranked) {
    const pc::Judgement& j = c->judgement;
    std::string by = "nothing above noise";
    if (j.gives_away) {
      const auto& channel = j.channels[static_cast<std::size_t>(*j.gives_away)];
      by = fmt::format("{}: {}", pc::name_of(channel.channel), channel.what);
    }
    rows.push_back({fmt::format("{}", c->rank), c->name, pc::told_share(j),
                    fmt::format("{:.0f} to {:.0f}", 100.0 * j.noticed_low95, 100.0 * j.noticed_high95),
                    fmt::format("{:.2f}", j.d_prime), std::string(pc::name_of(j.verdict)), by});
  }
  return report::align_columns(rows);
}

std::vector<std::string> JudgedFiles::remarks() const {
  std::vector<std::string> said = notes;
  std::vector<std::string> judges;
  for (const auto& condition : judged.conditions) {
    for (const auto& remark : condition.judgement.remarks) {
      if (std::ranges::count(judges, remark) == 0) judges.push_back(remark);
    }
  }
  said.insert(said.end(), judges.begin(), judges.end());
  return said;
}

void write_judged(const JudgedFiles& files, const std::filesystem::path& folder) {
  write_file(folder / "perception.json", pc::judged_to_json(files.judged, files.options));
  write_html(folder / "report.html",
             judgement_page("What a person would notice", files.judged, files.options, files.notes, files.provenance));
}

}  // namespace touchstone::pipeline
