#include "harness/metrics/catalogue.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "harness/base/error.h"
#include "harness/metrics/contact_timing.h"
#include "harness/metrics/force_axes.h"
#include "harness/metrics/force_direction.h"
#include "harness/metrics/force_error.h"
#include "harness/metrics/position_error.h"
#include "harness/metrics/result.h"
#include "harness/metrics/step_cost.h"

namespace touchstone::metrics {
namespace {

template <class T>
std::unique_ptr<Metric> plain(const MetricOptions&) {
  return std::make_unique<T>();
}

template <class T>
std::unique_ptr<Metric> with_options(const MetricOptions& options) {
  return std::make_unique<T>(options);
}

template <ErrorEpisodes::Of of>
std::unique_ptr<Metric> episodes_of(const MetricOptions& options) {
  return std::make_unique<ErrorEpisodes>(of, options);
}

// The names of an entry's results, from the metric itself, so that no list can fall behind.
MetricEntry entry(std::string name, bool force, bool position, bool cost,
                  std::function<std::unique_ptr<Metric>(const MetricOptions&)> make) {
  MetricEntry made{std::move(name), {}, force, position, cost, std::move(make)};
  for (const MetricResult& result : made.make({})->results()) made.results.push_back(result.name);
  return made;
}

}  // namespace

const std::vector<MetricEntry>& metric_catalogue() {
  static const std::vector<MetricEntry> catalogue{
      // name, then whether it needs force, position, cost
      entry("force-error", true, false, false, plain<ForceError>),
      entry("force-axes", true, false, false, plain<ForceAxes>),
      entry("force-direction", true, false, false, with_options<ForceDirection>),
      entry("force-episodes", true, false, false, episodes_of<ErrorEpisodes::Of::force>),
      entry("position-error", false, true, false, plain<PositionError>),
      entry("position-episodes", false, true, false, episodes_of<ErrorEpisodes::Of::position>),
      entry("contact-timing", true, false, false, with_options<ContactTiming>),
      entry("step-cost", false, false, true, plain<StepCost>),
  };
  return catalogue;
}

const MetricEntry& find_metric(std::string_view name) {
  std::vector<std::string> known;
  for (const MetricEntry& entry : metric_catalogue()) {
    if (entry.name == name || std::ranges::find(entry.results, name) != entry.results.end()) return entry;
    known.push_back(fmt::format("{} ({})", entry.name, fmt::join(entry.results, ", ")));
  }
  throw UsageError(fmt::format("\"{}\" is not a metric; known are: {}", name, fmt::join(known, "; ")));
}

MetricSet::MetricSet(const std::vector<std::string>& names, const MetricInputs& inputs, const MetricOptions& options) {
  std::vector<const MetricEntry*> chosen;
  chosen.reserve(names.size());
  for (const std::string& name : names) chosen.push_back(&find_metric(name));
  for (const MetricEntry& entry : metric_catalogue()) {
    if (!names.empty() && std::ranges::find(chosen, &entry) == chosen.end()) continue;
    const bool fed = (inputs.force || !entry.needs_force) && (inputs.position || !entry.needs_position) &&
                     (inputs.cost || !entry.needs_cost);
    members_.push_back({&entry, fed ? entry.make(options) : nullptr});
  }
}

void MetricSet::add(const MetricSample& sample) {
  for (Member& member : members_) {
    if (member.metric) member.metric->add(sample);
  }
}

std::vector<MetricResult> MetricSet::results() {
  std::vector<MetricResult> out;
  for (Member& member : members_) {
    if (member.metric) {
      for (MetricResult& result : member.metric->results()) out.push_back(std::move(result));
      continue;
    }
    for (MetricResult& empty : member.entry->make({})->results()) {
      out.push_back(make_missing(empty.name, empty.unit, empty.meaning,
                                 member.entry->needs_force      ? "the recording has no force"
                                 : member.entry->needs_position ? "there is no out-trajectory"
                                                                : "the steps were not timed"));
    }
  }
  return out;
}

std::vector<Episode> MetricSet::episodes(std::string_view name) {
  for (Member& member : members_) {
    if (member.entry->name != name || !member.metric) continue;
    if (auto* const found = dynamic_cast<ErrorEpisodes*>(member.metric.get())) return found->worst();
  }
  return {};
}

std::vector<Episode> MetricSet::force_episodes() { return episodes("force-episodes"); }
std::vector<Episode> MetricSet::position_episodes() { return episodes("position-episodes"); }

const MetricResult& find_result(const std::vector<MetricResult>& results, std::string_view name) {
  std::vector<std::string> known;
  for (const MetricResult& result : results) {
    if (result.name == name) return result;
    known.push_back(result.name);
  }
  throw UsageError(fmt::format("there is no result \"{}\"; there are: {}", name, fmt::join(known, ", ")));
}

}  // namespace touchstone::metrics
