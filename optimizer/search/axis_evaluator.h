// optimizer/search/axis_evaluator.h
//
// The objective of every search: the best energy that a given axis allows.
// In:   an axis p in normalised rays.
// Out:  the fitted map and its energy, and the gradient (4) there.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/types/span.h"
#include "base/scratch.h"
#include "optimizer/energy/summary.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/search/affine.h"

namespace lightfit {

class AxisEvaluator {
 public:
  virtual ~AxisEvaluator() = default;

  // The fitted map at `axis`, or nothing where the axis cannot be used: w < min_w on some ray, and
  // anywhere once a StopScope says so. The axis may have any positive length; that of the result
  // has w = 1 at the origin of the rays.
  std::optional<AffineFit> Evaluate(const Eigen::Vector3d& axis);

  // dE/dp with the affine part held fixed, math.md (4) and (8).
  virtual Eigen::Vector3d Gradient(const AffineFit& fit) = 0;

  // How often Evaluate() fitted a map.
  int num_evaluations() const { return num_evaluations_; }

  const AffineProblem& problem() const { return problem_; }
  double min_w() const { return min_w_; }

 protected:
  AxisEvaluator(const AffineProblem& problem, double min_w) : problem_(problem), min_w_(min_w) {}

 private:
  // `axis` has unit third component. Nothing when w < min_w().
  virtual std::optional<AffineFit> EvaluateScaled(const Eigen::Vector3d& axis) = 0;

  AffineProblem problem_;
  double min_w_;
  int num_evaluations_ = 0;
};

// From the summary: O(hull) per axis, whatever the number of samples and pixels.
class SummaryEvaluator final : public AxisEvaluator {
 public:
  SummaryEvaluator(const Summary& summary, const AffineProblem& problem, double min_w)
      : AxisEvaluator(problem, min_w), summary_(summary) {}

  Eigen::Vector3d Gradient(const AffineFit& fit) override;

 private:
  std::optional<AffineFit> EvaluateScaled(const Eigen::Vector3d& axis) override;

  const Summary& summary_;
};

// As published: every axis costs a pass over all receivers, whose hull is taken anew, and one over
// all samples. FitOptions::sample_by_sample; the yardstick for the summary's speed and correctness.
class SampleEvaluator final : public AxisEvaluator {
 public:
  // Samples and receivers must outlive the object.
  SampleEvaluator(const Samples& samples,
                  const Surfaces& surfaces,
                  const MetricWeights& metric,
                  const AffineProblem& problem,
                  double min_w);

  // The same where `hull_rays`, in the samples' coordinates, are known to have the receivers' hull.
  SampleEvaluator(const Samples& samples,
                  absl::Span<const Eigen::Vector3d> hull_rays,
                  const MetricWeights& metric,
                  const AffineProblem& problem,
                  double min_w);

  Eigen::Vector3d Gradient(const AffineFit& fit) override;

 private:
  std::optional<AffineFit> EvaluateScaled(const Eigen::Vector3d& axis) override;

  // Calls visit(ray) for every ray until it returns false, or a little longer.
  template <typename Visitor>
  void ForEachRay(const Visitor& visit) const;

  const Samples& samples_;
  const Surfaces* surfaces_ = nullptr;  // whose rays are too many to keep; else null
  ScratchVector<Eigen::Vector3d> rays_;
  MetricWeights metric_;
};

}  // namespace lightfit
