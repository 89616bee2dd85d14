#include <algorithm>
#include <set>

#include "../files/json_file.hpp"
#include "../text/describe.hpp"
#include "../text/findings.hpp"
#include "manycontact/analysis/remedy.hpp"
#include "manycontact/analysis/rounding.hpp"
#include "manycontact/sparse/largest.hpp"
#include "solve.hpp"

namespace manycontact::cli {

namespace {

Json matrix(const Eigen::MatrixXd& x) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < x.rows(); ++i) rows.push_back(json_of(Eigen::VectorXd(x.row(i).transpose())));
  return rows;
}

Json times_us(const SolvedScene& s) {
  Json out = {{"symbolic", s.time.symbolic}, {"setup", s.time.setup}, {"solve", s.time.solve}};
  if (s.derivatives) out["derivatives"] = s.time.derivatives;
  return out;
}

Json order_of(const IslandReport& r) { return has_order(r.method) ? Json(to_string(r.order)) : Json(nullptr); }

// Returns the members that the report of an island and the report of the scene have in common.
Json accuracy_of(const auto& report) {
  return {{"residual_dynamics", report.residual_dynamics},   {"residual_contact", report.residual_contact},
          {"backward_error", report.backward_error},         {"condition", report.condition},
          {"error_acceleration", report.error_acceleration}, {"error_forces", report.error_forces},
          {"rounding", find_rounding(report).names()}};
}

Json island_entry(const Scene& scene, const Island& island, const IslandReport& r,
                  const std::vector<std::string>& force_names) {
  Json robots = Json::array(), dependent = Json::array();
  for (int k : island.robots) robots.push_back(scene.robots[k].name);
  for (int row : r.dependent_rows) dependent.push_back(force_names[row]);
  Json out = {{"robots", robots},
              {"status", to_string(r.status)},
              {"method", to_string(r.method)},
              {"order", order_of(r)},
              {"precision", to_string(r.precision)},
              {"reason", to_string(r.reason)},
              {"remedy", remedy(r)},
              {"nv", r.nv},
              {"nc", r.nc},
              {"rank", r.rank},
              {"factor_nonzeros", r.factor_nonzeros},
              {"refinement_steps", r.refinement_steps}};
  out.update(accuracy_of(r));
  out["dependent_rows"] = dependent;
  return out;
}

Json quality_entry(const SystemQuality& of) {
  return {{"componentwise_backward_error", of.componentwise_backward_error},
          {"normwise_backward_error", of.normwise_backward_error},
          {"growth", of.growth},
          {"condition", of.condition},
          {"scaled_condition", of.scaled_condition},
          {"signature", {of.positive, of.negative, of.zero}}};
}

// Returns the lowest precision that an island was solved with, or the requested precision if there are no islands.
Precision least_precision(const Report& report, Precision asked) {
  Precision least = report.islands.empty() ? asked : report.islands.front().precision;
  for (const IslandReport& island : report.islands) least = std::min(least, island.precision);
  return least;
}

Json report(const SolvedScene& s) {
  const Report& r = s.data.report;
  Json list = Json::array();
  std::set<std::string> answered;
  const std::vector<std::string> names = force_names(s.file.scene, s.data);
  for (std::size_t i = 0; i < r.islands.size(); ++i) {
    list.push_back(island_entry(s.file.scene, solved_island(s.data, i), r.islands[i], names));
    if (!s.quality.empty()) list.back()["quality"] = quality_entry(s.quality[i]);
    answered.insert(to_string(r.islands[i].method));
  }
  Json out = {{"status", to_string(r.status)},
              {"remedy", remedy(r)},
              {"method", to_string(r.method)},
              {"precision", to_string(least_precision(r, s.data.options.precision))},
              {"answered_by", answered},
              {"islands", count_islands(s.file.scene, s.data)},
              {"nv", r.nv},
              {"nc", r.nc},
              {"rank", r.rank},
              {"rank_gap", s.findings.rank_gap},
              {"factor_nonzeros", r.factor_nonzeros}};
  out.update(accuracy_of(r));
  out.update({{"refinement_steps", r.refinement_steps}, {"time_us", times_us(s)}, {"island_list", list}});
  return out;
}

struct Block {
  const char* name;
  Eigen::MatrixXd SceneDerivatives::*matrix;
  double DerivativeBounds::*bound;
};
constexpr Block kBlocks[] = {
    {"da_dq", &SceneDerivatives::da_dq, &DerivativeBounds::da_dq},
    {"da_dv", &SceneDerivatives::da_dv, &DerivativeBounds::da_dv},
    {"da_du", &SceneDerivatives::da_du, &DerivativeBounds::da_du},
    {"dforces_dq", &SceneDerivatives::dforces_dq, &DerivativeBounds::dforces_dq},
    {"dforces_dv", &SceneDerivatives::dforces_dv, &DerivativeBounds::dforces_dv},
    {"dforces_du", &SceneDerivatives::dforces_du, &DerivativeBounds::dforces_du},
};

// Returns the largest error bounds of all islands. Unknown bounds are NaN, which is written as null.
Json largest_of(const std::vector<DerivativeBounds>& errors) {
  DerivativeBounds most;
  Json out;
  for (const Block& block : kBlocks) {
    double& of = most.*block.bound;
    for (const DerivativeBounds& x : errors) of = sparse::larger_or_nan(of, x.*block.bound);
    out[block.name] = of;
  }
  return out;
}

Json document(const SolvedScene& s) {
  Json json = {{"scene", s.file.scene.name},
               {"velocity_names", velocity_names(s.file.scene)},
               {"force_names", force_names(s.file.scene, s.data)},
               {"acceleration", json_of(s.data.a)},
               {"forces", json_of(s.data.f)}};
  json["forces_unique"] = Json::array();
  for (const char unique : s.unique) json["forces_unique"].push_back(unique != 0);
  if (s.derivatives) {
    const SceneDerivatives d = dense_derivatives(s.file.scene, s.data);
    for (const Block& block : kBlocks) json[block.name] = matrix(d.*block.matrix);
    json["derivative_errors"] = largest_of(s.derivative_errors);
    if (!s.file.scene.wrenches.empty()) {
      json["wrench_names"] = wrench_names(s.file.scene);
      json["da_dw"] = matrix(d.da_dw);
      json["dforces_dw"] = matrix(d.dforces_dw);
    }
  }
  if (s.quasi_static_u) {
    json["quasi_static_u"] = json_of(*s.quasi_static_u);
    json["unbalanced"] = Json::array();
    for (const Unbalanced& x : s.unbalanced)
      json["unbalanced"].push_back({{"joint", name_of(s.file.scene, x)}, {"force", x.force}});
  }
  add_findings(s.file.scene, s.findings, json);
  json["report"] = report(s);
  return json;
}

}  // namespace

void write_json(const SolvedScene& solved, const std::string& path) { write_json_file(document(solved), path); }

}  // namespace manycontact::cli
