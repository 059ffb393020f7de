#include "design.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/base/random.h"

namespace touchstone::runs {
namespace {

using nlohmann::json;

constexpr std::uint64_t most_cases = 100'000'000;
// Of the random numbers of a hypercube, after those of the parts.
constexpr std::size_t seed_stream = 3, first_varied = 4;

enum class Design { grid, latin_hypercube, list };

struct Axis {
  std::string pointer;
  std::vector<double> values;  // empty: a range
  double from = 0.0;
  double to = 0.0;
  bool logarithmic = false;

  // 0 <= fraction < 1
  [[nodiscard]] double within(double fraction) const {
    return logarithmic ? std::exp(std::log(from) + fraction * (std::log(to) - std::log(from)))
                       : from + fraction * (to - from);
  }
};

// Named things to choose from, in the order of their names.
struct Choice {
  std::vector<std::string> names;
  std::vector<json> values;
};

std::uint64_t whole(const JsonObject& object, std::string_view key, double value, double most) {
  if (!(value >= 0.0 && value <= most && value == std::floor(value)))
    object.fail_at(key, fmt::format("a whole number from 0 to {:.0f} was expected, got {}", most, value));
  return static_cast<std::uint64_t>(value);
}

Choice read_choice(JsonObject& root, const DesignParts::Part& part, const std::filesystem::path& folder) {
  JsonObject object = root.object(part.choices);
  Choice choice;
  for (const std::string& name : object.keys()) {
    choice.names.push_back(name);
    part.check(object.object(name), folder);  // an object: a seed or a varied parameter is set inside it
    choice.values.push_back(object.raw(name));
  }
  object.finish();
  if (choice.names.empty()) root.fail_at(part.choices, "at least one was expected");
  return choice;
}

std::string read_pointer(JsonObject& object, const DesignParts& parts) {
  std::string pointer = object.text("set");
  std::vector<std::string> known;
  for (const DesignParts::Part& part : parts.parts) {
    known.push_back(fmt::format("/{}/...", part.name));
    if (pointer.starts_with(fmt::format("/{}/", part.name))) return pointer;
  }
  for (const std::string& number : parts.numbers) {
    known.push_back("/" + number);
    if (pointer == known.back()) return pointer;
  }
  const std::string last = std::move(known.back());
  known.pop_back();
  object.fail_at(
      "set", fmt::format("'{}' is no part of a case; {} or {} was expected", pointer, fmt::join(known, ", "), last));
}

Axis read_axis(JsonObject object, Design design, const DesignParts& parts) {
  Axis axis;
  axis.pointer = read_pointer(object, parts);
  if (object.has("values")) {
    axis.values = object.numbers("values");
    if (axis.values.empty()) object.fail_at("values", "at least one number was expected");
  } else {
    axis.from = object.number("from");
    axis.to = object.number("to");
    const std::string spacing = object.optional_text("spacing").value_or("linear");
    if (spacing != "linear" && spacing != "log") object.fail_at("spacing", "\"linear\" or \"log\" was expected");
    axis.logarithmic = spacing == "log";
    if (!(axis.from < axis.to)) object.fail_at("to", "a number above \"from\" was expected");
    if (axis.logarithmic && !(axis.from > 0.0)) object.fail_at("from", "a number above 0 was expected for \"log\"");
    if (design == Design::grid) {
      const auto count = whole(object, "count", object.number("count"), 1e6);
      if (count < 2) object.fail_at("count", "2 or more was expected");
      for (std::uint64_t i = 0; i < count; ++i)
        axis.values.push_back(i + 1 == count ? axis.to
                                             : axis.within(static_cast<double>(i) / static_cast<double>(count - 1)));
    }
  }
  object.finish();
  return axis;
}

Design read_design(JsonObject& root) {
  const std::string name = root.text("design");
  if (name == "grid") return Design::grid;
  if (name == "latin-hypercube") return Design::latin_hypercube;
  if (name == "list") return Design::list;
  root.fail_at("design", fmt::format("'{}' is not known; grid, latin-hypercube or list was expected", name));
}

// Which of each choice and which values a case takes.
struct Picks {
  std::vector<std::size_t> parts;
  std::optional<std::uint64_t> seed;
  std::vector<double> varied;
};

}  // namespace

struct SweepDesign::State {
  std::filesystem::path folder;
  std::string source;
  std::string text;
  Design design = Design::grid;
  DesignParts parts;
  std::vector<Choice> choices;  // of each part
  std::vector<std::uint64_t> seeds;
  std::vector<Axis> axes;
  std::vector<std::string> pointers;
  bool truth = false;
  std::uint64_t count = 1;
  std::uint64_t design_seed = 1;
  // latin-hypercube: the order of the strata of each axis: the parts' by their streams, the seeds', what varies
  std::vector<std::vector<std::uint32_t>> strata;
  std::vector<Picks> list;

  void count_grid(const JsonObject& root) {
    for (const Choice& choice : choices) multiply(root, choice.names.size());
    multiply(root, std::max<std::size_t>(1, seeds.size()));
    for (const Axis& axis : axes) multiply(root, axis.values.size());
  }
  void multiply(const JsonObject& root, std::uint64_t n) {
    if (n > most_cases / count) root.fail_at("vary", fmt::format("the grid has more than {} cases", most_cases));
    count *= n;
  }

  void lay_strata() {
    const Random seeded(design_seed);
    for (std::size_t a = 0; a < first_varied + axes.size(); ++a) {
      Random random = seeded.stream(a);
      auto& order = strata.emplace_back(count);
      for (std::size_t i = 0; i < count; ++i) order[i] = static_cast<std::uint32_t>(i);
      for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    }
  }

  void read_list(JsonObject& root) {
    for (JsonObject& object : root.objects("cases")) {
      Picks picks;
      for (std::size_t p = 0; p < choices.size(); ++p) {
        picks.parts.push_back(named(object, parts.parts[p].name, choices[p]));
      }
      if (const auto seed = object.optional_number("seed")) picks.seed = whole(object, "seed", *seed, 9e15);
      picks.varied.assign(pointers.size(), std::nan(""));
      if (object.has("set")) {
        JsonObject set = object.object("set");
        for (const std::string& pointer : set.keys()) {
          const auto at = std::ranges::find(pointers, pointer);
          if (at == pointers.end()) set.fail_at(pointer, "is not among the pointers of \"vary\"");
          picks.varied[static_cast<std::size_t>(at - pointers.begin())] = set.number(pointer);
        }
        set.finish();
      }
      object.finish();
      list.push_back(std::move(picks));
    }
    count = list.size();
    if (count == 0) root.fail_at("cases", "at least one case was expected");
  }
  static std::size_t named(JsonObject& object, const std::string& key, const Choice& choice) {
    if (!object.has(key) && choice.names.size() == 1) return 0;
    const std::string name = object.text(key);
    const auto at = std::ranges::find(choice.names, name);
    if (at == choice.names.end()) object.fail_at(key, fmt::format("there is no '{}' in the specification", name));
    return static_cast<std::size_t>(at - choice.names.begin());
  }

  [[nodiscard]] Picks of_grid(std::uint64_t number) const {
    Picks picks;
    const auto take = [&](std::uint64_t n) {
      const std::uint64_t digit = number % n;
      number /= n;
      return static_cast<std::size_t>(digit);
    };
    if (!seeds.empty()) picks.seed = seeds[take(seeds.size())];
    picks.varied.resize(axes.size());
    for (std::size_t a = axes.size(); a-- > 0;) picks.varied[a] = axes[a].values[take(axes[a].values.size())];
    picks.parts.resize(choices.size());
    for (std::size_t p = choices.size(); p-- > 0;) picks.parts[p] = take(choices[p].names.size());
    return picks;
  }

  [[nodiscard]] Picks of_hypercube(std::uint64_t number) const {
    Picks picks;
    const auto evenly = [&](std::size_t axis, std::size_t choices) {
      return static_cast<std::size_t>(strata[axis][number] * choices / count);
    };
    for (std::size_t p = 0; p < choices.size(); ++p) {
      picks.parts.push_back(evenly(parts.parts[p].stream, choices[p].names.size()));
    }
    if (!seeds.empty()) picks.seed = seeds[evenly(seed_stream, seeds.size())];
    // Where in its stratum a case lies: a stream of its own, so that it does not depend on what else is drawn.
    Random random = Random(design_seed).stream(1000 + number);
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const double fraction = (strata[first_varied + a][number] + random.uniform()) / static_cast<double>(count);
      picks.varied.push_back(axes[a].values.empty() ? axes[a].within(fraction)
                                                    : axes[a].values[evenly(first_varied + a, axes[a].values.size())]);
    }
    return picks;
  }
};

SweepDesign::SweepDesign(const std::filesystem::path& file, const DesignParts& parts)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  const json document = load_json(file);
  s.source = file.string();
  s.folder = file.parent_path();
  s.text = document.dump();
  s.parts = parts;
  JsonObject root(document, s.source, "");
  root.schema(parts.schema);
  s.design = read_design(root);
  for (const DesignParts::Part& part : parts.parts) s.choices.push_back(read_choice(root, part, s.folder));
  if (!parts.seeded.empty() && root.has("seeds")) {
    for (const double seed : root.numbers("seeds")) s.seeds.push_back(whole(root, "seeds", seed, 9e15));
  }
  if (root.has("vary")) {
    for (JsonObject& object : root.objects("vary")) {
      if (s.design == Design::list) {
        s.axes.push_back({.pointer = read_pointer(object, parts), .values = {}});
        object.finish();
      } else {
        s.axes.push_back(read_axis(std::move(object), s.design, parts));
      }
      s.pointers.push_back(s.axes.back().pointer);
      if (std::ranges::count(s.pointers, s.pointers.back()) > 1)
        root.fail_at("vary", fmt::format("{} is set twice", s.pointers.back()));
    }
  }
  s.truth = parts.may_ask_for_truth && root.optional_flag("truth").value_or(false);
  if (s.design == Design::list) {
    s.read_list(root);
  } else if (s.design == Design::grid) {
    s.count_grid(root);
  } else {
    s.count = whole(root, "cases", root.number("cases"), static_cast<double>(most_cases));
    if (s.count == 0) root.fail_at("cases", "at least one case was expected");
    s.design_seed = whole(root, "design_seed", root.optional_number("design_seed").value_or(1.0), 9e15);
    s.lay_strata();
  }
  root.finish();
}

SweepDesign::~SweepDesign() = default;

std::uint64_t SweepDesign::size() const noexcept { return state_->count; }
const std::vector<std::string>& SweepDesign::varied() const noexcept { return state_->pointers; }
bool SweepDesign::truth() const noexcept { return state_->truth; }
const std::string& SweepDesign::text() const noexcept { return state_->text; }
const std::filesystem::path& SweepDesign::folder() const noexcept { return state_->folder; }

SweepCase SweepDesign::at(std::uint64_t number) const {
  const State& s = *state_;
  const Picks picks = s.design == Design::grid   ? s.of_grid(number)
                      : s.design == Design::list ? s.list.at(number)
                                                 : s.of_hypercube(number);
  SweepCase one{number, {}, picks.seed, picks.varied, {}};
  json document = json::object();
  for (std::size_t p = 0; p < s.choices.size(); ++p) {
    one.chosen.push_back(s.choices[p].names[picks.parts[p]]);
    document[s.parts.parts[p].name] = s.choices[p].values[picks.parts[p]];
  }
  for (const std::string& name : s.parts.numbers) document[name] = 1.0;
  if (picks.seed) document[s.parts.seeded]["seed"] = *picks.seed;
  for (std::size_t a = 0; a < picks.varied.size(); ++a) {
    if (std::isnan(picks.varied[a])) continue;
    try {
      document[json::json_pointer(s.pointers[a])] = picks.varied[a];
    } catch (const json::exception&) {
      throw BadData(fmt::format("{}: /vary: {} leads nowhere in case {}", s.source, s.pointers[a], number));
    }
  }
  one.document = document.dump();
  return one;
}

}  // namespace touchstone::runs
