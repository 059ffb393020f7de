#include "sweep/sweep_cases.h"

namespace touchstone::sweep {
using runs::CaseRow;
using runs::SweepCase;
using runs::SweepDesign;

runs::CaseTable sweep_table(const SweepDesign& design) {
  using enum runs::CaseColumn::Type;
  runs::CaseTable table{design.text(), design.size(), {}, "specification", "--out"};
  const auto add = [&](runs::CaseColumn::Type type, std::initializer_list<const char*> names) {
    for (const char* const name : names) table.columns.push_back({name, type});
  };
  add(text, {"surface", "trajectory", "model"});
  add(integer, {"seed"});
  for (const std::string& pointer : design.varied()) table.columns.push_back({pointer, real});
  add(integer, {"samples", "contact_samples", "contact_events"});
  add(real, {"peak_force_N", "rms_force_N", "mean_fx_N", "mean_fy_N", "mean_fz_N", "contact_path_m",
             "exact_force_rms_N", "exact_force_max_N", "exact_contact_rms_m"});
  add(text, {"result_sha256", "document"});
  table.columns[table.columns.size() - 2].of_bits = true;
  return table;
}

runs::CaseJob sweep_job(const SweepDesign& design, SweepWorld& world) {
  runs::CaseJob job;
  job.what = "sweep";
  job.cases = design.size();
  job.run = [&world](CaseRow& row, const runs::PartDone&) { row = sweep_row(world.run(row.number)); };
  return job;
}

CaseRow sweep_row(const SweepOutcome& outcome) {
  const SweepCase& one = outcome.one;
  CaseRow row{one.number, outcome.error, {}};
  const auto add = [&row](bool there, const auto& value) {
    row.values.push_back(there ? runs::CaseValue(value) : runs::CaseValue());
  };
  std::vector<std::string> chosen = one.chosen;
  chosen.resize(3);  // empty where the case could not be made
  for (const std::string& name : chosen) add(true, name);
  add(one.seed.has_value(), one.seed.value_or(0));
  for (const double value : one.varied) add(true, value);
  const bool ran = outcome.error.empty();
  const golden::GoldenSummary& s = outcome.summary;
  for (const std::uint64_t count : {s.samples, s.contact_samples, s.contact_events}) add(ran, count);
  add(ran, s.peak_force_N);
  add(ran, s.rms_force_N);
  for (int axis = 0; axis < 3; ++axis) add(ran, s.mean_force_W_N[axis]);
  add(ran, s.contact_path_m);
  const golden::ExactError exact = outcome.exact.value_or(golden::ExactError{});
  for (const double error : {exact.force_rms_N, exact.force_max_N, exact.contact_rms_m})
    add(outcome.exact.has_value(), error);
  add(ran, s.sha256);
  add(true, one.document);
  return row;
}

}  // namespace touchstone::sweep
