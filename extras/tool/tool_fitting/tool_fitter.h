// Fits of any set of the instrument's effects (tool_effects.h) to one recording with a tool, beside a renderer of
// tools, and how likely the parts of the recording are that a fit has not seen. What the model is: tool_fit.h.
//
// The time is cut into jackknife_blocks blocks. Every other one is fitted; the rest are dealt in turn to two parts that
// no fit sees: by one effects are chosen, by the other errors are reported, so that choosing makes no reported error
// smaller.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "harness/base/wrench.h"
#include "harness/recording/trajectory.h"
#include "harness/tool/coupling.h"
#include "harness/tool/tool_renderer.h"
#include "tool_fitting/tool_effects.h"

namespace touchstone::tool_fitting {

// A renderer with this coupling, from its beginning.
using MakeTool = std::function<std::unique_ptr<tool::ToolRenderer>(const tool::Coupling&)>;

// Root mean squares over the samples of a part, of all three axes together.
struct ToolErrors {
  double force_N = 0.0;
  double torque_Nm = 0.0;
};

// Which of tool_effects() a model has, by their order.
using ToolEffectSet = std::vector<bool>;

inline constexpr int most_tool_parameters = 16;  // of all effects together
using ToolValues = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_tool_parameters, 1>;
using ToolSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_tool_parameters, most_tool_parameters>;

struct ToolSolution {
  ToolEffectSet effects;
  ToolValues values;      // of all effects, nought for those that are not in the set
  ToolSquare covariance;  // of them
  ToolErrors noise;       // RMS of an axis over the fitted blocks: what the likelihood takes for the noise
};

class ToolFitter {
 public:
  enum class Part : std::uint8_t { fitted, choosing, reporting };
  // `thorough` looks for the stiffnesses once more where slopes mislead; `quick` is for comparisons from a near start.
  enum class Effort : std::uint8_t { quick, thorough };

  // Holds on to the first two. Requires orientation and torque in `measured`. `same_motion`: of a recording with the
  // same poses and the same renderers, whose answers need not be rendered again.
  ToolFitter(const recording::Recording& measured, const MakeTool& make, const tool::Coupling& declared,
             const ToolFitter* same_motion = nullptr);

  // The declared renderer's answers.
  const std::vector<Wrench>& declared() { return rendered(declared_); }
  // The values of these effects that fit best; `start` (may be nullptr) is where the stiffnesses start.
  ToolSolution solve(const ToolEffectSet& effects, Effort effort, const ToolSolution* start = nullptr);
  [[nodiscard]] tool::Coupling coupling(const ToolSolution& solution) const;
  // What the sensor shows by this model, a sample each, about the handle in W.
  std::vector<Wrench> shown_W(const ToolSolution& solution);

  ToolErrors errors(const ToolSolution& solution, Part part);
  // The logarithm of the likelihood of each block of a part, by independent normal noise of `solution.noise`; and of
  // how many samples all of them have.
  std::vector<double> log_likelihoods(const ToolSolution& solution, Part part);
  [[nodiscard]] std::size_t samples(Part part) const;

  // The p-value of effect e being nought: an F distribution over the fitted blocks (Hotelling 1931).
  [[nodiscard]] double p_of(const ToolSolution& solution, std::size_t e) const;
  // Of each parameter of effect e: the standard error is well below the prior's width.
  [[nodiscard]] std::vector<bool> determined(const ToolSolution& solution, std::size_t e) const;
  // As they are reported: a stiffness instead of its logarithm.
  struct Reported {
    std::vector<double> values, standard_errors;
  };
  [[nodiscard]] Reported reported(const ToolSolution& solution, std::size_t e) const;

  // Standard deviation of an axis' sample-to-sample noise, from second differences (as var(x) = var(second
  // difference) / 6 for white noise): what of a signal is too quick for a hand. Motion only makes it larger.
  [[nodiscard]] ToolErrors sample_noise() const;

 private:
  static constexpr int jackknife_blocks = 40;
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, most_tool_parameters>;
  struct Placed {
    const ToolEffectTraits* effect;
    int first;  // where its parameters stand among all
  };
  // One linearisation: the sums of the normal equations, and the gradient of each block.
  struct Step;

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] int block_of(std::size_t i) const;
  [[nodiscard]] static Part part_of(int block);
  [[nodiscard]] bool fitted(std::size_t i) const { return part_of(block_of(i)) == Part::fitted; }
  [[nodiscard]] tool::Coupling coupling_of(const ToolValues& values) const;
  [[nodiscard]] Jacobian linear_columns(const Wrench& wrench_W, std::size_t i) const;
  [[nodiscard]] Vec6 shown(const Wrench& wrench_W, std::size_t i, const ToolValues& values) const;
  [[nodiscard]] Jacobian free_columns(const Wrench& wrench_W, std::size_t i) const;
  const std::vector<Wrench>& rendered(const tool::Coupling& coupling);
  void polish(const ToolErrors& noise, double first);
  [[nodiscard]] ToolValues with_linear(ToolValues values, const ToolErrors& noise);
  [[nodiscard]] double loss(const ToolValues& values, const ToolErrors& noise);
  Step linearised(const ToolErrors& noise);
  [[nodiscard]] ToolSquare covariance(const Step& step) const;
  [[nodiscard]] bool any_stiffness_free() const;

  const recording::Recording& measured_;
  const MakeTool& make_;
  tool::Coupling declared_;
  std::vector<Placed> placed_;
  int linear_ = 0;  // parameters that what is shown is linear in: the first of all
  int all_ = 0;
  ToolValues width_;   // of the priors
  ToolValues values_;  // of the solution that is sought
  std::vector<bool> free_;
  std::vector<Vec6> measured_T_;
  // The last renderings, newest last.
  std::vector<std::pair<tool::Coupling, std::vector<Wrench>>> renderings_;
};

}  // namespace touchstone::tool_fitting
