#include "manycontact/dynamics/differentiate.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "internal.hpp"
#include "manycontact/sparse/memory.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "systems/robots/derivatives.hpp"
#include "workspace/threads.hpp"

namespace manycontact {

void IslandDerivatives::check() const {
  if (!stamp.current())
    throw std::logic_error(
        "derivatives of an island: the scene was solved again after differentiate, call differentiate again");
}

namespace internal {

bool has_derivatives(const SceneData& data) {
  if (!data.workspace || data.serial == 0) return false;
  const Workspace& w = *data.workspace;
  if (!w.linearisation && !w.reduction) return false;
  const std::vector<IslandDerivatives>& islands = w.derivatives.islands;
  return islands.size() == (w.reduction ? w.reduction->islands.size() : w.islands.size()) &&
         std::all_of(islands.begin(), islands.end(), [](const auto& of) { return of.stamp.current(); });
}

namespace {

// Returns the number of a robot's columns with respect to torques, if `request` includes these.
int torques_of(const Model& model, const DerivativeRequest& request) { return request.tau ? model.nv : model.nu(); }

int columns_of(const Scene& scene, const Island& island, const DerivativeRequest& request) {
  int columns = (request.q ? island.nv : 0) + (request.v ? island.nv : 0);
  for (int r : island.robots) columns += request.u ? torques_of(*scene.robots[r].model, request) : 0;
  return columns;
}

}  // namespace

void number_torques(const Scene& scene, const Island& island, IslandDerivatives& out) {
  out.u_offset.assign(1, 0);
  for (int r : island.robots)
    out.u_offset.push_back(out.u_offset.back() + torques_of(*scene.robots[r].model, out.request));
  out.nu = out.u_offset.back();
  out.cols = out.u_first + (out.request.u ? out.nu : 0);
}

void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out) {
  out.u_offset.clear();  // stays empty, i.e. panels count as not laid out, if an allocation below throws
  out.request = request;
  out.nv = island.nv;
  out.nc = island.nc;
  out.q_first = 0;
  out.v_first = request.q ? out.nv : 0;
  out.u_first = out.v_first + (request.v ? out.nv : 0);
  out.wrenches.clear();
  for (std::size_t k = 0; request.wrenches && k < scene.wrenches.size(); ++k)
    if (std::binary_search(island.robots.begin(), island.robots.end(), scene.wrenches[k].at.robot))
      out.wrenches.push_back(static_cast<int>(k));
  remake(out.W, island.size(), sparse::padded(static_cast<std::ptrdiff_t>(6 * out.wrenches.size())));
  out.W.setZero();
  remake(out.X, island.size(), sparse::padded(columns_of(scene, island, request)));
  out.X.setZero();
  number_torques(scene, island, out);
}

namespace {

// Allocates the memory of an island's derivatives. Called outside of parallel loops.
void prepare_island(const Scene& scene, SceneData& data, IslandWork& d, const DerivativeRequest& request,
                    IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  // External wrenches or springs reorder the columns after the solve, so that the panel must be laid out again.
  if (forces_are_applied(w) || out.request != request || out.X.rows() != d.island.size() ||
      out.X.cols() != sparse::padded(columns_of(scene, d.island, request)) ||
      out.u_offset.size() != d.island.robots.size() + 1)
    lay_out(scene, d.island, request, out);
  prepare_robots_derivatives(scene, d, out, w);
  if (!d.answered || d.served_in_lanes() || differentiates_by_robots(d)) return;
  make_joint_space(scene, w, d);
  w.linearisation->assign(scene, w, d.island);
}

// Differentiates an island outside SIMD batches: robot by robot if cheaper, else by the system that solved, or by
// MatrixSystem. With method auto, MatrixSystem precedes sparse-bodies unless K is too large (kDifferentiatedByMatrix):
// column by column, sparse-bodies takes 4 to 70 times as long. rank: J's rank, which MatrixSystem must find, too.
void differentiate_island(const Scene& scene, SceneData& data, IslandWork& d, int rank, ThreadWork& thread,
                          IslandDerivatives& out) {
  if (differentiates_by_robots(d) && d.robots->differentiate(scene, data, thread, out)) return;
  if (data.options.method == Method::kAuto && d.answered_by(d.bodies.get()) &&
      d.island.size() <= tolerance::kDifferentiatedByMatrix && d.matrix.make_current(scene, data, thread) &&
      d.matrix.factor->rank() == rank && d.matrix.differentiate(scene, data, thread, out))
    return;
  if (!ask(scene, data, d, thread, [&](IslandSystem& system) {  // d.robots failed above, or is not cheaper
        return &system != d.robots.get() && system.differentiate(scene, data, thread, out);
      }))
    out.X.setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

}  // namespace internal

namespace {

// Throws, before any panel is allocated, if the panels do not fit in memory.
void check_memory(const Scene& scene, const Workspace& w, const DerivativeRequest& request) {
  constexpr int kPanels = 2;  // right-hand sides in the island's order and in the factor's order
  double numbers = 0;
  for (const auto& d : w.islands) {
    if (d->answered_by(d->bodies.get()))
      internal::check_joint_space(*d, "differentiate", ": use the products jvp and vjp");
    numbers += static_cast<double>(d->island.size()) * internal::columns_of(scene, d->island, request);
  }
  sparse::require_memory(kPanels * sizeof(double) * numbers);
}

}  // namespace

const DerivativeData& differentiate(const Scene& scene, SceneData& data, const DerivativeRequest& wanted) {
  internal::check_not_prescribed(scene, data, "differentiate");
  Workspace& w = *data.workspace;
  if (w.reduction) return internal::differentiate_reduced(scene, data, wanted);
  const bool applied = internal::forces_are_applied(w);
  const DerivativeRequest request = applied ? internal::by_all_torques(wanted) : wanted;
  check_memory(scene, w, request);
  (void)internal::linearisation_of(scene, data);
  w.derivatives.islands.resize(w.islands.size());
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    w.derivatives.islands[i].stamp = {};
    internal::prepare_island(scene, data, *w.islands[i], request, w.derivatives.islands[i]);
  }
  internal::differentiate_alone(scene, data);
  internal::each_island(
      w, [](const IslandWork& d) { return d.served_in_lanes(); }, internal::differentiates_by_robots,
      [&](IslandWork& d, std::size_t i, ThreadWork& thread) {
        internal::differentiate_island(scene, data, d, data.report.islands[i].rank, thread, w.derivatives.islands[i]);
      });
  if (applied) internal::join_applied_forces(scene, data, wanted);
  for (IslandDerivatives& out : w.derivatives.islands) out.stamp = {&w.current, data.serial};
  return w.derivatives;
}

const DerivativeData& derivatives(const SceneData& data) {
  if (!internal::has_derivatives(data))
    throw std::logic_error("derivatives: the current solution has no derivatives, call differentiate first");
  return data.workspace->derivatives;
}

namespace {

void release(IslandWork& d) {
  d.derivatives = {};
  if (d.robots && !d.robots->solves)
    d.robots.reset();  // constructed only for derivatives
  else if (d.robots)
    d.robots->derivatives.reset();
  d.matrix.rows.reset();
  for (Factor* factor : {d.matrix.chosen.get(), d.matrix.waiting_in_order.get(), d.matrix.waiting.get(),
                         d.matrix.proximal.get(), d.matrix.dense.get()})
    if (factor) factor->release_panels();
}

}  // namespace

void release_derivatives(SceneData& data) {
  if (!data.workspace) return;
  Workspace& w = *data.workspace;
  w.derivatives = {};
  if (w.reduction) {
    release_derivatives(*w.reduction->data);
    w.reduction->plain.reset();
  }
  for (ThreadWork& thread : w.threads) thread.panel = {};
  for (const auto& island : w.islands) release(*island);
  w.pool.each([](IslandWork& island) { release(island); });
}

}  // namespace manycontact
