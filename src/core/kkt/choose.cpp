#include "manycontact/kkt/choose.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>

#include "manycontact/kkt/costs.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

using namespace costs;

double predicted_cost_ldl(int rows, const sparse::LdlCounts& L) {
  return kLdlRow * rows + kLdlEntry * L.nonzeros + kLdlFlop * L.flops;
}

double predicted_cost_of_terms(int rows, std::size_t contacts) {
  return kTermsRow * rows + kTermsContact * static_cast<double>(contacts);
}

namespace {

// Returns the cost of M's and J's terms, which sparse-bodies does not need. Contacts cost more outside SIMD batches.
double cost_of_terms(const IslandShape& shape) {
  const std::size_t contacts = shape.scene().contacts.size();
  const double one_by_one =
      shape.island().size() > kLargestInLanes ? kTermsContactAlone * static_cast<double>(contacts) : 0;
  return predicted_cost_of_terms(shape.island().size(), contacts) + one_by_one;
}

double cost_ldl(IslandShape& shape, Order order) {
  const sparse::LdlCounts& L = shape.counts(order);
  const double ranges = (order == Order::kContactsEarly ? kLdlShortRange : kLdlRange) * L.scattered;
  return predicted_cost_ldl(shape.island().size(), L) + kLdlBlock * L.blocks + ranges;
}

double cost_cholmod(IslandShape& shape, Order order) {
  const sparse::LdlCounts& L = shape.counts(order);
  return kCholmodCall + kCholmodRow * shape.island().size() + kCholmodEntry * L.nonzeros + kCholmodFlop * L.flops;
}

double cost_bodies(const BodyPattern& p) {
  double cost = kBody * p.nodes + kBodyRow * p.nc + kBodyOpen * p.open_squared + kBodyUpdate * p.open_updates;
  for (int n : p.ndof) cost += n > 1 ? kBodyJoint : 0;
  return cost + kBodyBase * p.open_at_base * p.open_at_base * p.open_at_base;
}

double cost_bodies(IslandShape& shape) {
  const BodyPattern& whole = *shape.bodies();
  if (!may_be_cut(whole)) return cost_bodies(whole);
  const std::vector<BodySubtree>& subtrees = shape.body_subtrees().subtrees;
  std::map<int, int> alike;
  for (const BodySubtree& subtree : subtrees) ++alike[subtree.shape];
  double cost = 0;
  for (const BodySubtree& subtree : subtrees)
    cost += (alike[subtree.shape] > 1 ? kBodyAlike : 1) * cost_bodies(*subtree.pattern);
  return cost;
}

// Whether sparse-bodies is predicted to be cheaper than M's and J's terms and a factor that costs `cost`. Islands with
// too many bodies for it are not analysed.
bool bodies_are_cheaper(IslandShape& shape, double cost) {
  double nodes = 0;
  for (const Robot& robot : shape.scene().robots) nodes += robot.model->njoints();
  cost += cost_of_terms(shape);
  return kBody * nodes < cost && cost_bodies(shape) < cost;
}

// Returns the number of coordinates that move the body of an attachment.
double chain_length(const Scene& scene, const Attachment& at) {
  if (!moves(at)) return 0;
  const Model& model = *scene.robots[at.robot].model;
  const Joint& joint = model.joints[at.joint];
  return model.dof_depth[joint.idx_v] + joint.nv();
}

}  // namespace

double joint_space_size(const IslandShape& shape) {
  double size = 0;
  for (const Robot& robot : shape.scene().robots)
    for (int depth : robot.model->dof_depth) size += depth + 1.0;
  for (const Contact& contact : shape.scene().contacts)  // an upper bound: common ancestors of A and B' count twice
    size += contact.rows() * (chain_length(shape.scene(), contact.A) + chain_length(shape.scene(), contact.B));
  return size;
}

double least_cost_ldl(const IslandShape& shape) {
  sparse::LdlCounts least;
  for (const Robot& robot : shape.scene().robots)
    for (const double depth : robot.model->dof_depth) {  // L has at least M's entries, one per ancestor
      least.nonzeros += depth;
      least.flops += depth * (depth + 2);
    }
  return predicted_cost_ldl(shape.island().size(), least);
}

bool is_deep(IslandShape& shape) { return bodies_are_cheaper(shape, least_cost_ldl(shape)); }

namespace {

double cost_dense(const IslandShape& shape) {
  const double n = shape.island().nv, m = shape.island().nc;
  return kDenseCall + kDenseFlop * (4 * n * n * m + 2 * n * n * n);
}

// Returns the cost of a full triangular factor of the contact rows. entry: cost per entry; flop: cost per multiply-add.
double full_rows_cost(const Island& island, double entry, double flop) {
  const double n = island.nc;
  return entry * n * n / 2 + flop * n * n * n / 3;
}

}  // namespace

PredictedCosts predict_costs(IslandShape& shape) {
  PredictedCosts costs;
  costs.terms = cost_of_terms(shape);
  costs.bodies = cost_bodies(shape);
  costs.dense = cost_dense(shape);
  if (overdetermined(shape.island())) {
    costs.ldl.fill(least_cost_ldl(shape) + full_rows_cost(shape.island(), kLdlEntry, kLdlFlop));
    costs.cholmod.fill(least_cost_ldl(shape) + kCholmodCall +
                       full_rows_cost(shape.island(), kCholmodEntry, kCholmodFlop));
    return costs;
  }
  if (is_deep(shape)) {
    costs.ldl.fill(least_cost_ldl(shape));
    costs.cholmod.fill(std::numeric_limits<double>::infinity());
    return costs;
  }
  for (Order order : kOrders) {
    costs.ldl[static_cast<std::size_t>(order)] = cost_ldl(shape, order);
    costs.cholmod[static_cast<std::size_t>(order)] = cost_cholmod(shape, order);
  }
  return costs;
}

Choice choose(IslandShape& shape, const Options& options) {
  Choice choice{options.method, Order::kLeafToRoot};
  if (options.method == Method::kSparseBodies) return choice;
  if (options.method == Method::kAuto ? overdetermined(shape.island()) && !options.order
                                      : has_order(options.method) && too_full_for_sparse(shape.island()))
    return {Method::kDense, Order::kLeafToRoot};
  if (options.method == Method::kAuto && !options.order && is_deep(shape)) return {Method::kSparseBodies};
  const bool ordered = has_order(options.method) || options.method == Method::kAuto;
  if (options.order) {
    choice.order = *options.order;
  } else if (ordered) {
    double least = cost_ldl(shape, choice.order);
    for (Order order : kOrders) {
      const double cost = cost_ldl(shape, order);
      if (cost < tolerance::kCheaper * least) choice.order = order, least = cost;
    }
  }
  if (options.method != Method::kAuto) return choice;
  choice.method = Method::kSparseLdl;
  if (!options.order && bodies_are_cheaper(shape, cost_ldl(shape, choice.order)))
    return {Method::kSparseBodies, choice.order};  // the order is used if a factor of K replaces sparse-bodies
  return choice;
}

namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", x);
  return text;
}

}  // namespace

std::string why_chosen(const Choice& choice, const PredictedCosts& costs, const Options& options) {
  const std::size_t order = static_cast<std::size_t>(choice.order);
  const double ldl = costs.ldl[order];
  if (choice.method == Method::kDense && options.method != Method::kDense)
    return "dense, at " + number(costs.dense / ldl) +
           " of the predicted cost of sparse-ldl: most rows depend on others";
  if (choice.method == Method::kSparseBodies)
    return to_string(choice.method) + ", at " +
           number(costs.bodies / (costs.terms + *std::min_element(costs.ldl.begin(), costs.ldl.end()))) +
           " or less of the predicted cost of sparse-ldl";
  const std::string in_order = " in " + to_string(choice.order) + " order";
  std::string text = to_string(choice.method);
  if (has_order(choice.method)) text += in_order + (options.order ? " as asked" : "");
  if (has_order(choice.method) && !options.order)
    for (Order other : kOrders)
      if (const double cost = costs.ldl[static_cast<std::size_t>(other)]; cost < ldl)
        text += "; " + to_string(other) + " order, at " + number(cost / ldl) + " of this cost, is not enough cheaper";
  if (options.method == Method::kAuto && costs.dense < ldl)
    text += "; dense, at " + number(costs.dense / ldl) + " of this cost, is not chosen, since dense allocates memory";
  return text;
}

}  // namespace manycontact
