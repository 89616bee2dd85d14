#include "choice.hpp"

#include "manycontact/kkt/cost.hpp"
#include "table.hpp"

namespace manycontact::cli {

bool has_order(Method method) { return method == Method::kSparseLdl || method == Method::kSparseCholmod; }

long nonzeros_of_K(const KktPattern& pattern, double damping) {
  return 2L * pattern.K.nonzeros() - pattern.size() - (damping == 0 ? pattern.nc : 0);
}

double predicted_dense(const IslandData& d) { return predicted_cost_dense(d.island.nv, d.island.nc); }

IslandCosts predict_costs(const Scene& scene, const IslandData& d) {
  IslandCosts costs;
  costs.K_nonzeros = nonzeros_of_K(*d.safe, scene.damping);
  for (std::size_t k = 0; k < costs.orders.size(); ++k) {
    const KktPattern pattern = analyze(scene, d.island, d.support, kOrders[k]);
    costs.orders[k] = {kOrders[k], pattern.ldl.nonzeros() + pattern.size(), predicted_cost_ldl(pattern),
                       predicted_cost_cholmod(pattern)};
  }
  if (sparse::supernodal_available() && d.island.nc > 0)
    costs.supernodal = predicted_cost_supernodal(
        scene, d.island, d.schur_pattern ? *d.schur_pattern : analyze_schur(scene, d.island, d.support));
  costs.dense = predicted_dense(d);
  return costs;
}

std::string why_chosen(const Options& options, const IslandData& d, const IslandCosts& costs) {
  const OrderCost* chosen = &costs.orders[0];
  const OrderCost* best = chosen;
  for (const OrderCost& o : costs.orders) {
    if (o.order == d.chosen->order) chosen = &o;
    if (o.ldl < best->ldl) best = &o;
  }
  const auto us = [](double cost) { return "predicted " + number(cost) + " us"; };
  const std::string in_order = " in " + to_string(chosen->order) + " order";
  std::string text = to_string(d.method);
  if (has_order(d.method)) text += in_order + (options.order ? " as asked" : "");
  if (d.method == Method::kSparseLdl) text += ", " + us(chosen->ldl);
  if (d.method == Method::kSparseCholmod) text += ", " + us(chosen->cholmod);
  if (d.method == Method::kSparseSupernodal && costs.supernodal) text += ", " + us(*costs.supernodal);
  if (options.method == Method::kAuto) {
    if (d.method == Method::kSparseLdl && costs.supernodal)
      text += " against " + number(*costs.supernodal) + " us for sparse-supernodal";
    if (d.method == Method::kSparseSupernodal)
      text += " against " + number(chosen->ldl) + " us for sparse-ldl" + in_order;
  }
  if (has_order(d.method) && !options.order && best != chosen)
    text += "; " + to_string(best->order) + " with " + number(best->ldl) + " us is not enough cheaper than " +
            to_string(chosen->order);
  return text;
}

std::string why_changed(const IslandData& d, const IslandReport& report) {
  const std::string reason = to_string(report.reason);
  if (report.status == Status::kFailed) return "no answer: " + reason;
  if (!report.dependent_rows.empty() && report.method == Method::kSparseLdl)
    return "rows depend on each other, so sparse-ldl in leaf-to-root order answered without them";
  if (report.changed_order)
    return to_string(d.chosen->order) + " order was unsound (" + reason + "), " + to_string(report.order) + " answered";
  if (report.method != d.method)
    return to_string(d.method) + " gave up (" + reason + "), " + to_string(report.method) + " answered";
  return "";
}

}  // namespace manycontact::cli
