#include "harness/metrics/result.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace touchstone::metrics {

MetricResult make_missing(std::string name, std::string unit, std::string meaning, std::string why) {
  MetricResult result;
  result.name = std::move(name);
  result.unit = std::move(unit);
  result.meaning = std::move(meaning);
  result.note = std::move(why);
  return result;
}

MetricResult make_result(std::string name, std::string unit, std::string meaning, double value, const Moments& from) {
  MetricResult result = make_missing(std::move(name), std::move(unit), std::move(meaning), "no sample qualified");
  if (from.count() == 0) return result;
  if (from.bad() > 0 || !std::isfinite(value)) {
    result.status = MetricStatus::invalid;
    result.note = from.bad() > 0 ? fmt::format("{} of {} samples are not finite, the first at t = {} s", from.bad(),
                                               from.count(), from.first_bad_t_s())
                                 : "the value overflowed";
    return result;
  }
  result.status = MetricStatus::ok;
  result.note.clear();
  result.value = value;
  return result;
}

void set_reference(MetricResult& result, double reference, std::string meaning) {
  if (!std::isfinite(reference)) return;
  result.reference = reference;
  result.reference_meaning = std::move(meaning);
}

}  // namespace touchstone::metrics
