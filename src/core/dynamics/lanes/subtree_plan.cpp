#include "manycontact/sparse/tolerances.hpp"
#include "subtrees.hpp"

namespace manycontact::lanes {

namespace {

// Calls use(coordinate) for the coordinates of `node` and of its ancestors up to `end`, without those of `end`.
template <class Use>
void each_coordinate_up(const BodyPattern& p, int node, int end, Use&& use) {
  for (; node != end; node = p.parent[node])
    for (int k = p.first_dof[node]; k < p.first_dof[node] + p.ndof[node]; ++k) use(k);
}

}  // namespace

bool SubtreePlan::fits(const BodyPattern& p) { return p.nv > 0 && p.nv + p.nc <= tolerance::kLargestSubtree; }

SubtreePlan::SubtreePlan(std::shared_ptr<const BodyPattern> of) : pattern(std::move(of)) {
  const BodyPattern& p = *pattern;
  std::vector<std::pair<int, int>> M, J;
  for (int i = p.nodes - 1; i >= 0; --i)
    for (int k = p.first_dof[i]; k < p.first_dof[i] + p.ndof[i]; ++k) {
      for (int j = p.first_dof[i]; j <= k; ++j) M.emplace_back(place(k), place(j));
      each_coordinate_up(p, p.parent[i], -1, [&](int j) { M.emplace_back(place(k), place(j)); });
    }
  for (int row = 0; row < p.nc; ++row) {
    meeting.push_back(p.A[row] < 0 || p.B[row] < 0 ? -1 : p.meeting(row));
    for (int end : {p.A[row], p.B[row]})
      each_coordinate_up(p, end, meeting.back(), [&](int k) { J.emplace_back(place(k), place_of_row(row)); });
  }
  std::vector<std::pair<int, int>> all = M;
  all.insert(all.end(), J.begin(), J.end());
  K = sparse::make_pattern(p.nv + p.nc, std::move(all));
  schedule = sparse::compile_ldl(K, sparse::ldl_analyze(K));
  for (const auto& [row, col] : M) M_slot.push_back(K.slot(row, col));
  for (const auto& [row, col] : J) J_slot.push_back(K.slot(row, col));
}

}  // namespace manycontact::lanes
