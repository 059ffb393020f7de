#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/commands.h"
#include "harness/base/units.h"
#include "harness/discrepancy/effect_search.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "renderers/catalogue.h"
#include "renderers/model_predictor.h"

namespace touchstone::apps {
namespace {

struct Options {
  std::filesystem::path model;
  std::filesystem::path mesh;
  std::string mesh_unit = "m";
  std::filesystem::path recording;
  std::filesystem::path holdout;
  std::filesystem::path instrument;
  std::filesystem::path out;
};

ExitStatus discrepancy(const Options& options) {
  const Model model = load_model(options.model);
  const auto surface = make_embree_surface(load_mesh(options.mesh, length_unit_factor(options.mesh_unit)));
  const Recording train = load_recording(options.recording);
  const Recording holdout = load_recording(options.holdout);
  const InstrumentDescription instrument = load_instrument(options.instrument);
  std::vector<Candidate> candidates;
  for (const auto& effect : effect_catalogue()) candidates.push_back({effect.name, Side::contact, effect.parameters});
  for (const auto& entry : instrument_declarations())
    candidates.push_back({entry.name, Side::instrument, entry.parameters});
  const MakePredictor make = [&](const MotionColumns& motion) { return make_model_predictor(surface, motion); };
  const auto train_predictor = make(train.motion);
  const auto holdout_predictor = make(holdout.motion);
  NoiseModel train_noise(train.motion, instrument, make, 8, 11);
  NoiseModel holdout_noise(holdout.motion, instrument, make, 8, 12);
  const SearchData data{&train,
                        &holdout,
                        train_predictor.get(),
                        holdout_predictor.get(),
                        &train_noise,
                        &holdout_noise,
                        block_window_s(instrument.position_rate_Hz, train.motion),
                        6.0 * instrument.force_noise_N + instrument.force_step_N.maxCoeff()};
  const SearchResult result =
      search_effects(data, model, candidates, {}, [](const std::string& line) { fmt::print("{}\n", line); });
  fmt::print("before {:.4f} after {:.4f} goodness {:.3f}\n{}\n", result.base_holdout_rms_N, result.holdout_rms_after_N,
             result.goodness, model_to_json(result.model));
  return ExitStatus::passed;
}

}  // namespace

void add_discrepancy(CLI::App& program, Run& run) {
  auto* const command =
      program.add_subcommand("discrepancy", "Find where simulation and measurement disagree, and the missing effect");
  const auto options = std::make_shared<Options>();
  command->add_option("--model", options->model)->required();
  command->add_option("--mesh", options->mesh)->required();
  command->add_option("--mesh-unit", options->mesh_unit);
  command->add_option("--recording", options->recording)->required();
  command->add_option("--holdout", options->holdout)->required();
  command->add_option("--instrument", options->instrument)->required();
  command->add_option("--out", options->out);
  command->callback([options, &run] { run = [options] { return discrepancy(*options); }; });
}

}  // namespace touchstone::apps
