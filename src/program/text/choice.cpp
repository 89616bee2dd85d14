#include "choice.hpp"

namespace manycontact::cli {

std::string why_changed(const Choice& choice, const IslandReport& report) {
  if (report.status == Status::kFailed) return "no solution: " + to_string(report.reason);
  // The reason kUncertain is not printed, because a later check of the solution may remove it.
  const std::string reason = report.reason == Reason::kUncertain ? "" : " (" + to_string(report.reason) + ")";
  if (!report.dependent_rows.empty() && report.method == Method::kSparseLdl)
    return report.reason == Reason::kNone ? ""
                                          : "rows are dependent: sparse-ldl in " + to_string(report.order) +
                                                " order computed the forces of least norm";
  if (report.changed_order)
    return to_string(choice.order) + " order was not accurate" + reason + ", and " + to_string(report.order) +
           " order was used";
  if (report.method != choice.method)
    return to_string(choice.method) + " failed" + reason + ", and " + to_string(report.method) + " was used";
  return "";
}

double nonzeros_of_K(const IslandShape& shape, double damping) {
  double nonzeros = damping == 0 ? 0 : shape.island().nc;
  for (const Robot& robot : shape.scene().robots)
    for (const int depth : robot.model->dof_depth) nonzeros += 2.0 * depth + 1;
  for (std::size_t c = 0; c < shape.scene().contacts.size(); ++c)
    nonzeros += 2.0 * shape.scene().contacts[c].rows() * static_cast<double>(shape.support().columns[c].size());
  return nonzeros;
}

}  // namespace manycontact::cli
