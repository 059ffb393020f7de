#include "experiments/indentation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "harness/base/error.h"
#include "harness/stats/summary.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

constexpr double force_scale = 1e9;  // 1 nN is shown as 1 N
constexpr double depth_scale = 1e3;  // 1 um is shown as 1 mm

double header_number(const nlohmann::json& header, const char* name, const std::string& file) {
  if (!header.contains(name) || !header[name].is_number() || !(header[name].get<double>() > 0.0)) {
    throw BadData(fmt::format("{}: the metadata have no positive number \"{}\"", file, name));
  }
  return header[name].get<double>();
}

struct Samples {
  std::vector<double> force_N;
  std::vector<double> height_m;
};

Samples read_samples(std::istream& in, const std::string& file, std::string& metadata) {
  Samples samples;
  bool inside = false;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (!line.empty() && line[0] == '#') {
      if (line.find("END METADATA") != std::string::npos) inside = false;
      if (inside) metadata += line.substr(1) + "\n";
      if (line.find("BEGIN METADATA") != std::string::npos) inside = true;
      continue;
    }
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream cells(line);
    double force_N = 0.0;
    double height_m = 0.0;
    double piezo_m = 0.0;
    std::string segment;
    if (!(cells >> force_N >> height_m >> piezo_m >> segment) || (segment != "False" && segment != "True")) {
      throw BadData(fmt::format("{}:{}: force, two heights and the segment (False or True) were expected, not '{}'",
                                file, number, line.substr(0, 60)));
    }
    if (segment == "True") continue;
    samples.force_N.push_back(force_N);
    samples.height_m.push_back(height_m);
  }
  return samples;
}

double sum_of_squares(const Approach& approach, const PowerLaw& law, std::size_t phase, std::size_t of) {
  double sum = 0.0;
  for (std::size_t i = phase; i < approach.force_N.size(); i += of) {
    if (i < approach.contact) continue;
    sum += std::pow(approach.force_N[i] - law.force_N(approach.depth_m[i]), 2);
  }
  return sum;
}

// Record `phase`, from a little before contact on; rendered by `law` where there is one.
std::vector<pc::PressSignal> press(const Approach& approach, std::size_t phase, const PowerLaw* law) {
  pc::PressSignal signal;
  signal.name = law == nullptr ? "measured" : "rendered";
  const std::size_t before = approach.force_N.size() / 20;
  const std::size_t start = (approach.contact - std::min(before, approach.contact)) / interleaved * interleaved;
  for (std::size_t i = start + phase; i < approach.force_N.size(); i += interleaved) {
    signal.t_s.push_back(static_cast<double>(signal.t_s.size() * interleaved) / approach.rate_Hz);
    signal.force_N.push_back(force_scale * (law == nullptr ? approach.force_N[i] : law->force_N(approach.depth_m[i])));
    signal.displacement_m.push_back(depth_scale * approach.depth_m[i]);
  }
  return {signal};
}

}  // namespace

Approach read_approach(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw BadData(fmt::format("{}: cannot be read", file.string()));
  Approach approach;
  approach.source = file.string();
  std::string metadata;
  const Samples samples = read_samples(in, approach.source, metadata);
  const auto header = nlohmann::json::parse(metadata, nullptr, false);
  if (!header.is_object()) {
    throw BadData(
        fmt::format("{}: no JSON between BEGIN METADATA and END METADATA; a .tab file of afmformats was expected",
                    approach.source));
  }
  approach.cantilever_N_per_m = header_number(header, "spring constant", approach.source);
  approach.rate_Hz = header_number(header, "rate approach", approach.source);
  const std::size_t size = samples.force_N.size();
  if (size < 1000)
    throw BadData(fmt::format("{}: {} samples of approach; at least 1000 were expected", approach.source, size));
  const std::vector<double> quiet(samples.force_N.begin(),
                                  samples.force_N.begin() + static_cast<std::ptrdiff_t>(size / 5));
  const double zero_N = stats::mean(quiet);
  approach.noise_N = stats::standard_deviation(quiet);
  for (const double f : samples.force_N) approach.force_N.push_back(f - zero_N);
  approach.contact = size;
  while (approach.contact > 0 && approach.force_N[approach.contact - 1] > 3.0 * approach.noise_N) --approach.contact;
  if (approach.contact + 40 * interleaved > size || approach.contact < size / 5) {
    throw BadData(fmt::format(
        "{}: contact from sample {} of {} on: an approach that starts free and ends in contact was expected",
        approach.source, approach.contact, size));
  }
  std::vector<double> tip_m;
  tip_m.reserve(size);
  for (std::size_t i = 0; i < size; ++i)
    tip_m.push_back(samples.height_m[i] + samples.force_N[i] / approach.cantilever_N_per_m);
  for (const double tip : tip_m) approach.depth_m.push_back(tip_m[approach.contact] - tip);
  return approach;
}

double PowerLaw::force_N(double depth_m) const {
  return depth_m > 0.0 ? coefficient * std::pow(depth_m, exponent) : 0.0;
}

PowerLaw fit_power_law(const Approach& approach, double exponent, std::size_t phase, std::size_t of) {
  double both = 0.0;
  double squares = 0.0;
  for (std::size_t i = phase; i < approach.force_N.size(); i += of) {
    if (i < approach.contact || !(approach.depth_m[i] > 0.0)) continue;
    const double power = std::pow(approach.depth_m[i], exponent);
    both += power * approach.force_N[i];
    squares += power * power;
  }
  if (!(squares > 0.0) || !(both > 0.0))
    throw BadData(fmt::format("{}: the force does not grow with depth: no law fits", approach.source));
  return {exponent, both / squares};
}

PowerLaw fit_power_law(const Approach& approach, std::size_t phase, std::size_t of) {
  constexpr int exponent_bits = 22;  // to a few millionths
  const auto cost = [&](double exponent) {
    return sum_of_squares(approach, fit_power_law(approach, exponent, phase, of), phase, of);
  };
  return fit_power_law(approach, boost::math::tools::brent_find_minima(cost, 0.5, 4.0, exponent_bits).first, phase, of);
}

std::vector<IndentationComparison> compare_indentation(const Approach& approach) {
  pc::EvaluationOptions options;
  // 80 ms of a record: in shorter windows the quotient of two small changes is mostly the sensor's noise.
  options.image.rate_hardness_window = 40;
  std::vector<IndentationComparison> result;
  for (std::size_t real = 0; real < interleaved; ++real) {
    const std::array laws{fit_power_law(approach, 1.0, real, interleaved),
                          fit_power_law(approach, 1.5, real, interleaved),
                          fit_power_law(approach, 2.0, real, interleaved), fit_power_law(approach, real, interleaved)};
    for (std::size_t other = 0; other < interleaved; ++other) {
      if (other == real) continue;
      std::vector<pc::ConditionSource> conditions{
          {"measured again", [&approach, other] { return press(approach, other, nullptr); }}};
      const std::array names{"F = k d", "F = c d^1.5 (ball)", "F = c d^2 (cone)", "F = c d^n, n fitted"};
      for (std::size_t i = 0; i < laws.size(); ++i)
        conditions.push_back({names[i], [&approach, other, &law = laws[i]] { return press(approach, other, &law); }});
      result.push_back(
          {real, other, laws.back().exponent, pc::evaluate(press(approach, real, nullptr), conditions, options)});
    }
  }
  return result;
}

}  // namespace touchstone::experiments
