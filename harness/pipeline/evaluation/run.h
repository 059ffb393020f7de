// One evaluation from files to a result, in bounded memory whatever the length of the recording.
#pragma once

#include <filesystem>
#include <functional>

#include "harness/pipeline/evaluation/request.h"
#include "harness/rendering/catalogue.h"
#include "harness/report/evaluation.h"

namespace touchstone::pipeline {

struct EvaluationInputs;  // inputs.h

// Replays and measures. `rendered` is the file for what the renderer answered (before any instrument entry); "" writes
// none. Throws as load_inputs() does, and BadData where the renderer answers with what is not a number.
report::EvaluationResult run_evaluation(const rendering::Catalogue& catalogue, const EvaluationRequest& request,
                                        const std::filesystem::path& rendered);
// Takes every sample that the metrics see, in the order of time.
using ErrorSink = std::function<void(const metrics::MetricSample&)>;
report::EvaluationResult run_evaluation(const rendering::Catalogue& catalogue, const EvaluationRequest& request,
                                        const EvaluationInputs& inputs, const std::filesystem::path& rendered,
                                        const ErrorSink& errors = {});

// run_evaluation() and its report: DIR/rendered.csv, DIR/result.json, DIR/report.html.
report::EvaluationResult evaluate_into(const rendering::Catalogue& catalogue, const EvaluationRequest& request,
                                       const std::filesystem::path& folder, const ErrorSink& errors = {});

}  // namespace touchstone::pipeline
