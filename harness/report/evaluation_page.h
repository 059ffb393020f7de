// The report page of one evaluation: what was found, the metrics, errors over time and on the object, and where it came
// from.
#pragma once

#include "harness/report/evaluation.h"
#include "harness/report/page.h"

namespace touchstone::report {

Page evaluation_page(const EvaluationResult& result);

// The parts that pages of other commands share.
Table metrics_table(const std::vector<metrics::MetricResult>& metrics);
Section provenance_section(const Provenance& provenance);
// The object with the error where it was touched, paths and marks; coordinates in a unit that suits its size.
Scene object_scene(const ObjectView& object, const std::vector<Vec3>& path_W_m,
                   const std::vector<EpisodeView>& episodes);
// A series as a line, values in `unit`.
Line line_of(const metrics::Series& series, std::string name, Tone tone, double factor);

}  // namespace touchstone::report
