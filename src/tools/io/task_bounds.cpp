// Reads activations (functions of a cost's residual), and bounds of barriers and constraints.

#include <limits>

#include "task_parts.hpp"

namespace manycontact::io {

namespace {

// Reads n numbers, which may be "inf" or "-inf". If the attribute is missing, all n are `otherwise`.
Eigen::VectorXd read_bound(const Element& e, const char* attribute, int n, double otherwise) {
  if (!e.has(attribute)) return Eigen::VectorXd::Constant(n, otherwise);
  const std::string text = e.required(attribute);
  const auto parts = words(text);
  if (static_cast<int>(parts.size()) != n)
    e.refuse(attribute, " has " + std::to_string(parts.size()) + " number" + (parts.size() == 1 ? "" : "s") +
                            ", expected " + std::to_string(n));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::VectorXd out(n);
  for (int i = 0; i < n; ++i)
    out[i] = parts[i] == "inf"    ? kInfinity
             : parts[i] == "-inf" ? -kInfinity
                                  : parse_number(e.where(attribute), e.label(attribute), parts[i]);
  return out;
}

}  // namespace

void read_bounds(const Element& e, TaskTerm& term) {
  const bool given = e.has("lower") || e.has("upper");
  if (!given && takes(term.residual, "normal")) return;
  if (!given) e.fail("<" + e.name() + "> has no bounds, expected lower, upper or both");
  term.lower = read_bound(e, "lower", term.nr, -std::numeric_limits<double>::infinity());
  term.upper = read_bound(e, "upper", term.nr, std::numeric_limits<double>::infinity());
  for (int i = 0; i < term.nr; ++i)
    if (!(term.lower[i] <= term.upper[i]) || term.lower[i] == std::numeric_limits<double>::infinity() ||
        term.upper[i] == -std::numeric_limits<double>::infinity())
      e.where(e.has("upper") ? "upper" : "lower")
          .fail("bounds of <" + e.name() + ">: number " + std::to_string(i + 1) + " is " + show(term.lower[i]) +
                " to " + show(term.upper[i]) + ", expected lower <= upper");
}

void read_activation(const Element& e, TaskTerm& term) {
  term.weight = e.number_from_0("weight", 1);
  const bool weighted = e.has("weights");
  const int otherwise =
      static_cast<int>(takes(term.residual, "normal")
                           ? (weighted ? TaskActivation::kWeightedQuadraticBarrier : TaskActivation::kQuadraticBarrier)
                           : (weighted ? TaskActivation::kWeightedQuad : TaskActivation::kQuad));
  term.activation = static_cast<TaskActivation>(e.choice(
      "activation", {"quad", "weighted_quad", "quadratic_barrier", "weighted_quadratic_barrier", "smooth_1norm"},
      otherwise));
  const TaskActivation a = term.activation;
  const std::string with = e.optional("activation", "quad");
  const bool needs_weights = a == TaskActivation::kWeightedQuad || a == TaskActivation::kWeightedQuadraticBarrier;
  if (needs_weights) {
    const auto list =
        parse_numbers(e.where("weights"), e.label("weights"), e.required("weights"), static_cast<std::size_t>(term.nr));
    term.weights = Eigen::Map<const Eigen::VectorXd>(list.data(), term.nr);
    if (term.weights.minCoeff() < 0)
      e.refuse("weights", " has the number " + show(term.weights.minCoeff()) + ", expected numbers of 0 or more");
  } else if (weighted) {
    e.refuse("weights",
             " cannot be combined with activation " + with + ", expected weights only with a weighted activation");
  }
  if (a == TaskActivation::kQuadraticBarrier || a == TaskActivation::kWeightedQuadraticBarrier)
    read_bounds(e, term);
  else
    for (const char* bound : {"lower", "upper"})
      if (e.has(bound))
        e.refuse(bound, " cannot be combined with activation " + with + ", expected bounds only with a barrier");
  if (e.has("eps") && a != TaskActivation::kSmooth1Norm)
    e.refuse("eps", " cannot be combined with activation " + with + ", expected eps only with smooth_1norm");
  term.eps = e.positive("eps", 1);
}

}  // namespace manycontact::io
