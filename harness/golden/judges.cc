#include "harness/golden/judges.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "harness/base/version.h"
#include "harness/golden/equal_answers.h"
#include "harness/golden/golden_file.h"
#include "harness/golden/golden_summary.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/rendering/catalogue.h"
#include "harness/rendering/limitation.h"

namespace touchstone::golden {
namespace {

// Whether the case's own renderer pushes to the closest surface point, wherever that jumps to.
bool pushes_to_closest(const JudgedRun& judged) {
  const auto& known = judged.catalogues.renderers.renderers();
  const auto found = std::ranges::find(known, judged.model.own.renderer, &rendering::RendererEntry::name);
  return found != known.end() && find_limitation(found->cannot, rendering::Ability::continuous_force) != nullptr;
}

void judge_columns(const JudgedRun& judged, CheckResult& result) {
  const Tolerance& tolerance = judged.golden.tolerance;
  const std::size_t equal_answers =
      judged.run.surface && pushes_to_closest(judged)
          ? take_equal_answers(*judged.run.surface, tolerance, judged.obtained, judged.expected)
          : 0;
  result.comparison = compare(judged.expected, judged.obtained, tolerance);
  if (equal_answers > 0)
    result.comparison.problems.push_back(
        fmt::format("in {} rows another surface point is as close as the golden's, and as right", equal_answers));
}

// Bits are comparable where the processor is the one that made the golden.
void judge_drift(const JudgedRun& judged, CheckResult& result) {
  if (!judged.options.fail_on_drift || result.comparison.drift == 0) return;
  Provenance made = read_provenance(judged.golden.expected(judged.model.name));
  result.drift_fails = made["cpu"] == judged.run.provenance.at("cpu");
}

// How wide the tolerance gets over the golden's forces, in differences that a fingertip just notices there.
void judge_width_of_tolerance(const JudgedRun& judged, CheckResult& result) {
  const GroupTolerance& force = judged.golden.tolerance.of("force");
  const auto* const x = judged.expected.find("fx");
  const auto* const y = judged.expected.find("fy");
  const auto* const z = judged.expected.find("fz");
  if (x == nullptr || y == nullptr || z == nullptr) return;
  const auto newton = [&](std::size_t i) { return Vec3((*x)[i], (*y)[i], (*z)[i]).norm(); };
  double peak = 0.0;
  for (std::size_t i = 0; i < x->size(); ++i) peak = std::max(peak, newton(i));
  double share = 0.0;
  for (std::size_t i = 0; i < x->size(); ++i) {
    const double bound = force.atol + force.rtol * newton(i) + force.rpeak * peak;
    share = std::max(share, bound / perception::fingertip_force.just_noticeable_difference(newton(i)));
  }
  result.figures.emplace_back("tolerance_of_jnd", share);
  if (share <= judged.golden.jnd_share) return;
  result.comparison.verdict = Verdict::invalid;
  result.comparison.problems.push_back(
      fmt::format("the force tolerance reaches {:.3g} of a just noticeable difference; the case allows itself {:.3g}",
                  share, judged.golden.jnd_share));
}

// More, fewer, or none where there were some: each is news, if the model is the case's own. With fused multiply-add a
// step on a tie takes another branch, up to several times the operations for the same force: there they are measured
// and not judged.
void judge_operations(const JudgedRun& judged, CheckResult& result) {
  if (judged.options.change || build_info().flags.find("-ffp-contract=off") == std::string::npos) return;
  const auto known = load_operations(judged.golden.summary_file());
  const auto found = known.find(judged.model.name);
  const auto obtained = judged.run.operations ? std::optional(*judged.run.operations) : std::nullopt;
  const auto change = operations_change(found == known.end() ? std::nullopt : std::optional(found->second), obtained);
  if (!change) return;
  result.comparison.problems.push_back(change->message);
  result.comparison.verdict = worst(result.comparison.verdict, change->verdict);
}

}  // namespace

std::span<const Judge> judges() {
  static constexpr std::array all{
      Judge{"columns", true, judge_columns},
      Judge{"loop", true, judge_loop},
      Judge{"drift", true, judge_drift},
      Judge{"width of the tolerance", true, judge_width_of_tolerance},
      Judge{"exact answer", true, judge_by_exact_answer},
      Judge{"operations", true, judge_operations},
      Judge{"what a person notices", false, judge_felt},
  };
  return all;
}

}  // namespace touchstone::golden
