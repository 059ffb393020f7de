#include "harness/report/metric_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/report/json_numbers.h"

namespace touchstone::report {
using metrics::MetricResult;
using metrics::MetricStatus;
using metrics::Series;

using nlohmann::json;

const char* status_name(MetricStatus status) {
  switch (status) {
    case MetricStatus::ok:
      return "ok";
    case MetricStatus::missing:
      return "missing";
    case MetricStatus::invalid:
      return "invalid";
  }
  return "invalid";
}

std::vector<double> nullable_numbers(JsonObject& in, std::string_view key) {
  const json& values = in.raw(key);
  if (!values.is_array()) in.fail_at(key, "is not an array");
  std::vector<double> out;
  out.reserve(values.size());
  for (const json& value : values) {
    if (!value.is_null() && !value.is_number()) in.fail_at(key, "has an element that is neither a number nor null");
    out.push_back(value.is_null() ? std::nan("") : value.get<double>());
  }
  return out;
}

std::uint64_t count_from_json(JsonObject& in, std::string_view key) {
  const json& value = in.raw(key);
  if (!value.is_number_unsigned()) in.fail_at(key, "is not a whole number");
  return value.get<std::uint64_t>();
}

json series_to_json(const Series& series) {
  return {{"name", series.name},
          {"unit", series.unit},
          {"t_s", plotted_numbers(series.t_s)},
          {"value", plotted_numbers(series.value)},
          {"samples", series.samples},
          {"samples_per_pair", series.samples_per_pair}};
}

Series series_from_json(JsonObject& in) {
  Series out;
  out.name = in.text("name");
  out.unit = in.text("unit");
  out.t_s = nullable_numbers(in, "t_s");
  out.value = nullable_numbers(in, "value");
  if (out.t_s.size() != out.value.size()) in.fail("t_s and value differ in length");
  out.samples = count_from_json(in, "samples");
  out.samples_per_pair = count_from_json(in, "samples_per_pair");
  in.finish();
  return out;
}

json metric_to_json(const MetricResult& metric) {
  json out{{"name", metric.name},
           {"unit", metric.unit},
           {"value", exact_number(metric.value)},
           {"status", status_name(metric.status)},
           {"meaning", metric.meaning},
           {"note", metric.note}};
  if (metric.reference) {
    out["reference"] = exact_number(*metric.reference);
    out["reference_meaning"] = metric.reference_meaning;
  }
  if (metric.t_s) out["t_s"] = exact_number(*metric.t_s);
  if (metric.series) out["series"] = series_to_json(*metric.series);
  if (metric.histogram) {
    out["histogram"] = {{"unit", metric.histogram->unit},
                        {"width", exact_number(metric.histogram->width)},
                        {"counts", metric.histogram->counts}};
  }
  return out;
}

MetricResult metric_from_json(JsonObject& in) {
  MetricResult out;
  out.name = in.text("name");
  out.unit = in.text("unit");
  const std::string status = in.text("status");
  bool known = false;
  for (const MetricStatus one : {MetricStatus::ok, MetricStatus::missing, MetricStatus::invalid}) {
    if (status == status_name(one)) out.status = one, known = true;
  }
  if (!known) in.fail_at("status", "is not ok, missing or invalid");
  if (out.status == MetricStatus::ok) {
    out.value = in.number("value");
  } else if (!in.raw("value").is_null()) {
    in.fail_at("value", "is a number although the status says that there is none");
  }
  out.meaning = in.text("meaning");
  out.note = in.text("note");
  out.reference = in.optional_number("reference");
  out.reference_meaning = in.optional_text("reference_meaning").value_or("");
  out.t_s = in.optional_number("t_s");
  if (in.has("series")) {
    JsonObject series = in.object("series");
    out.series = series_from_json(series);
  }
  if (in.has("histogram")) {
    JsonObject histogram = in.object("histogram");
    out.histogram = metrics::Histogram{histogram.text("unit"), histogram.number("width"), {}};
    const json& counts = histogram.raw("counts");
    for (const json& count : counts) {
      if (!count.is_number_unsigned()) histogram.fail_at("counts", "has an element that is not a whole number");
      out.histogram->counts.push_back(count.get<std::uint64_t>());
    }
    histogram.finish();
  }
  in.finish();
  return out;
}

json provenance_to_json(const Provenance& provenance) {
  json inputs = json::array();
  for (const InputFile& input : provenance.inputs) {
    inputs.push_back({{"role", input.role}, {"name", input.name}, {"sha256", input.sha256}, {"bytes", input.bytes}});
  }
  const BuildInfo& build = provenance.build;
  return {{"command", provenance.command},
          {"created_utc", provenance.created_utc},
          {"inputs", std::move(inputs)},
          {"build",
           {{"version", build.version},
            {"commit", build.commit},
            {"dirty", build.dirty},
            {"compiler", build.compiler},
            {"build_type", build.build_type},
            {"flags", build.flags}}}};
}

Provenance provenance_from_json(JsonObject in) {
  Provenance out;
  out.command = in.text("command");
  out.created_utc = in.text("created_utc");
  for (JsonObject& input : in.objects("inputs")) {
    out.inputs.push_back(
        {input.text("role"), input.text("name"), input.text("sha256"), count_from_json(input, "bytes")});
    input.finish();
  }
  JsonObject build = in.object("build");
  out.build.version = build.text("version");
  out.build.commit = build.text("commit");
  out.build.dirty = build.optional_flag("dirty").value_or(false);
  out.build.compiler = build.text("compiler");
  out.build.build_type = build.text("build_type");
  out.build.flags = build.text("flags");
  build.finish();
  in.finish();
  return out;
}

}  // namespace touchstone::report
