#include "command_texture.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cluster_set.h"
#include "harness/base/atomic_file.h"
#include "harness/perception/judge/thresholds.h"
#include "harness/recording/recording_file.h"
#include "slide_windows.h"
#include "texture_bands.h"
#include "texture_comparison.h"
#include "texture_fit.h"
#include "texture_library.h"
#include "texture_model.h"
#include "texture_renderer.h"

namespace touchstone::texture {
namespace {

struct SampleOptions {
  std::vector<double> normal{0.0, 0.0, 1.0};
  double effective_mass_kg = default_effective_mass_kg;
  bool flip_force = false;

  void add_to(CLI::App& command) {
    command.add_option("--normal", normal, "Outward normal of the flat sample, as x,y,z")
        ->delimiter(',')
        ->expected(3)
        ->capture_default_str();
    command
        .add_option("--effective-mass-kg", effective_mass_kg,
                    "Of handle and hand: the force of the vibration over the model's acceleration")
        ->capture_default_str();
    command.add_flag("--flip-force", flip_force,
                     "The recordings have the force BY the probe: negate it, in all of them");
  }
  void check() const {
    if (!(normal_W().norm() > 0.0)) throw UsageError("--normal: 0,0,0 is no direction");
    if (!(effective_mass_kg > 0.0 && effective_mass_kg <= 10.0))
      throw UsageError(fmt::format("--effective-mass-kg: {:g} is not within 0 to 10 kg", effective_mass_kg));
  }
  [[nodiscard]] Vec3 normal_W() const { return {normal[0], normal[1], normal[2]}; }
};

SlideWindows windows_of(const std::string& file, const SampleOptions& sample, double step_share) {
  recording::Recording recording = recording::load_recording(file);
  if (sample.flip_force) {
    for (Vec3& force : recording.f_W_N) force = -force;
  }
  return slide_windows(recording, sample.normal_W(), step_share);
}

void add_plugin(CLI::App& texture, apps::Run& run) {
  struct Options {
    std::string model, out;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* const command = texture.add_subcommand(
      "plugin", "Make a plug-in that plays a model: the renderer `texture`, for every command that takes --plugin");
  command->add_option("model", options->model, "Models_*.xml of the Penn Haptic Texture Toolkit, or of `texture fit`")
      ->required();
  command->add_option("--out", options->out, "The plug-in, a shared library (.so)")->required();
  command->callback([&run, options] {
    run = [options] {
      const std::string xml = read_file(options->model);
      const TextureModel model = parse_texture_model(xml, options->model);
      write_texture_library(plain_texture_library(), xml, options->out);
      fmt::print("{}: plays {} up to {:.4g} mm/s and {:.4g} N, friction {:.3g}, {:g} samples per second\n",
                 options->out, model.material, 1e3 * model.largest_speed_m_per_s, model.largest_force_N, model.mu,
                 model.rate_Hz);
      return ExitStatus::passed;
    };
  });
}

void add_fit(CLI::App& texture, apps::Run& run) {
  struct Options {
    std::string recording, out, material;
    std::optional<int> texture;
    std::optional<double> mu;
    SampleOptions sample;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* const command =
      texture.add_subcommand("fit", "Make a model of a recording of a tip that slides over a flat sample");
  command
      ->add_option("recording", options->recording,
                   "t_s, x_m, y_m, z_m, fx_N, fy_N, fz_N at one rate; or the folder sensor_data of the Cluster Haptic "
                   "Texture Dataset")
      ->required();
  command->add_option("--out", options->out, "The model, in the layout of Models_*.xml")->required();
  command->add_option("--material", options->material, "Its name; without it that of the recording's file");
  command->add_option("--texture", options->texture, "Of a folder: the texture's number");
  command->add_option("--mu", options->mu, "Friction coefficient, in place of the recording's; a folder has none");
  options->sample.add_to(*command);
  command->callback([&run, options] {
    run = [options] {
      options->sample.check();
      const bool is_set = std::filesystem::is_directory(options->recording);
      if (is_set != options->texture.has_value())
        throw UsageError("texture fit: --texture goes with the folder of a data set, and with nothing else");
      if (is_set && !options->mu)
        throw UsageError("texture fit: --mu is needed; the set's texture_list.xlsx has it for each texture");
      if (options->mu && !(*options->mu >= 0.0 && *options->mu <= 100.0))
        throw UsageError(fmt::format("--mu: {:g} is not within 0 to 100", *options->mu));
      const SlideWindows windows =
          is_set ? cluster_windows(options->recording, *options->texture, options->sample.effective_mass_kg)
                 : windows_of(options->recording, options->sample, 1.0);
      const std::string material = !options->material.empty() ? options->material
                                   : is_set                   ? fmt::format("texture {}", *options->texture)
                                            : std::filesystem::path(options->recording).stem().string();
      TextureFit fit = fit_texture(windows, options->sample.effective_mass_kg, material);
      if (options->mu) fit.model.mu = *options->mu;
      write_file(options->out, texture_model_to_xml(fit.model));
      fmt::print("{}model: {}\n", text_of(fit, windows), options->out);
      return ExitStatus::passed;
    };
  });
}

void add_compare(CLI::App& texture, apps::Run& run) {
  struct Options {
    std::string expected, recorded, json, picture;
    double tolerance_dB = 3.0;
    SampleOptions sample;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* const command = texture.add_subcommand(
      "compare", "Whether a recording has the expected texture, by band and by what a person would notice");
  command->add_option("expected", options->expected, "A model (.xml), or a recording")->required();
  command->add_option("recorded", options->recorded, "A recording, measured or replayed")->required();
  command->add_option("--tolerance-dB", options->tolerance_dB, "What a band that is felt may differ by")
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the result here");
  command->add_option("--picture", options->picture, "Write both spectra here, as PNG");
  options->sample.add_to(*command);
  command->footer(
      "Exit status 0: the same within the tolerance; 1: different, or it cannot be told.\n"
      "Example: touchstone texture compare Models_Cork.xml played.csv --json cork.json");
  command->callback([&run, options] {
    run = [options] {
      options->sample.check();
      if (!(options->tolerance_dB > 0.0)) throw UsageError("--tolerance-dB: a number above 0 is needed");
      const perception::Thresholds thresholds;
      const SlideWindows windows = windows_of(options->recorded, options->sample, 0.5);
      const bool is_model = std::filesystem::path(options->expected).extension() == ".xml";
      const perception::FastForce expected =
          is_model ? expected_bands(read_texture_model(options->expected), options->sample.effective_mass_kg, windows,
                                    thresholds)
                   : recorded_bands(windows_of(options->expected, options->sample, 0.5), thresholds);
      const TextureComparison comparison =
          compare_textures(expected, recorded_bands(windows, thresholds), options->tolerance_dB, thresholds);
      fmt::print("{}", text_of(comparison));
      if (!options->json.empty()) write_file(options->json, json_of(comparison, options->expected, options->recorded));
      if (!options->picture.empty()) {
        const std::string why = write_picture(comparison, options->picture);
        if (!why.empty()) fmt::print(stderr, "warning: {}: no picture: {}\n", options->picture, why);
      }
      return comparison.verdict == TextureVerdict::same ? ExitStatus::passed : ExitStatus::failed;
    };
  });
}

}  // namespace

void add_texture(CLI::App& program, apps::Run& run) {
  CLI::App* const command = program.add_subcommand(
      "texture", "Textures as noise by speed and force, as in the Penn Haptic Texture Toolkit: play, fit, compare");
  command->require_subcommand(1);
  add_plugin(*command, run);
  add_fit(*command, run);
  add_compare(*command, run);
}

}  // namespace touchstone::texture
