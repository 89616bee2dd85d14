// Plans derivatives robot by robot: patterns, offsets and predicted cost, independent of the state.

#include <algorithm>

#include "../../internal.hpp"
#include "derivatives.hpp"
#include "manycontact/kkt/costs.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

RobotsDerivatives::RobotsDerivatives(const IslandShape& shape, const RobotsSystem& system)
    : robots(system.robots.size()) {
  const Scene& scene = shape.scene();
  const Island& island = shape.island();
  const Interface& interface = *system.interface;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    OfRobot& r = robots[k];
    const Interface::OfRobot& of = interface.robots[k];
    r.nv = scene.robots[k].model->nv;
    for (int i = 0; i < r.nv; ++i) r.row.push_back(island.dof_offset[k] + i);
    for (int c : of.contacts)
      for (int i = 0; i < scene.contacts[island.contacts[c]].rows(); ++i)
        r.row.push_back(island.nv + island.row_offset[c] + i);
    for (int row : of.interface_rows) r.join.push_back(interface.row[row]);
  }
  for (int k : interface.perm) eliminated.push_back(interface.row[k]);
}

namespace internal {

namespace {

// Returns the multiply-adds to solve a panel of `ld` columns with K's factor, if every second state needs refinement.
// kPanelDropping, for dependent rows, was measured on humanoids with contacts at their soles' corners.
double cost_at_once(const IslandWork& d, double ld, bool dropping) {
  const KktPattern& p = *d.shape->pattern(d.choice.order);
  return (dropping ? costs::kPanelDropping : 1) * ld * (3.0 * p.ldl.nonzeros() + p.K.nonzeros());
}

double cost_of_interface(double nonzeros, double ld) { return ld * 2 * nonzeros; }

// Returns multiply-adds to solve a panel robot by robot. Constants were measured on rings and humanoids with a beam.
double cost_by_robots(const RobotsSystem& system, const RobotsDerivatives& by, double ld) {
  double cost = cost_of_interface(system.interface->schedule.nonzeros(), ld);
  for (std::size_t k = 0; k < by.robots.size(); ++k) {
    const RobotsDerivatives::OfRobot& r = by.robots[k];
    const KktPattern& p = *system.robots[k].group->plan->inner;
    cost += r.ld * (4.0 * p.ldl.nonzeros() + 2.0 * p.K.nonzeros());
    cost += costs::kPanelProduct * r.padded() * (p.nv * r.ld + p.size() * ld);
  }
  return costs::kPanelsOnceMore * cost;
}

void lay_out_columns(const Island& island, const Interface& interface, const IslandDerivatives& out, std::size_t k,
                     RobotsDerivatives& by) {
  RobotsDerivatives::OfRobot& r = by.robots[k];
  const Interface::OfRobot& of = interface.robots[k];
  r.columns.clear();
  int at = static_cast<int>(6 * of.joins.size());
  const auto add = [&](bool wanted, int first, int count) {
    if (!wanted || count == 0) return;
    r.columns.push_back({first, at, count});
    at += count;
  };
  r.q_first = at;
  add(out.request.q, out.q_first + island.dof_offset[k], r.nv);
  r.v_first = at;
  add(out.request.v, out.v_first + island.dof_offset[k], r.nv);
  r.u_first = at;
  add(out.request.u, out.u_first + out.u_offset[k], out.u_offset[k + 1] - out.u_offset[k]);
  r.own = at = sparse::padded(at);
  for (int n : of.neighbours) add(out.request.q, out.q_first + island.dof_offset[n], by.robots[n].nv);
  r.ld = sparse::padded(at);
}

// Chooses up to sixteen sample columns of X, each with respect to q, v or u of another robot. The backward error of
// these columns is computed to test the factors; each column depends on the factors of all robots.
void choose_sample(RobotsDerivatives& by) {
  by.sample.column.clear();
  for (RobotsDerivatives::OfRobot& r : by.robots) r.sampled.clear();
  const std::size_t step = (by.robots.size() + 15) / 16;
  for (std::size_t k = 0; k < by.robots.size(); k += step) {
    const std::vector<RobotsDerivatives::Columns>& columns = by.robots[k].columns;
    if (columns.empty()) continue;
    const RobotsDerivatives::Columns& block = columns[k / step % columns.size()];
    const int column = block.in_X + static_cast<int>(7 * k) % block.count;
    for (RobotsDerivatives::OfRobot& r : by.robots)
      for (const RobotsDerivatives::Columns& c : r.columns)
        if (c.in_X <= column && column < c.in_X + c.count)
          r.sampled.push_back({static_cast<int>(by.sample.column.size()), c.in_P + column - c.in_X, 1});
    by.sample.column.push_back(column);
  }
}

void take_memory(const IslandWork& d, std::size_t threads, RobotsDerivatives& by) {
  const RobotsSystem& system = *d.robots;
  const std::size_t rows = system.interface->row.size(), n = d.island.size();
  for (std::size_t k = 0; k < by.robots.size(); ++k) {
    RobotsDerivatives::OfRobot& r = by.robots[k];
    r.ends.resize(system.robots[k].group->plan->ends_size());
    r.P.resize(r.size(), r.ld);
    r.P.setZero();
    r.G.assign(static_cast<std::size_t>(r.nv) * r.padded(), 0.0);
    r.H.assign(static_cast<std::size_t>(r.padded()) * r.ld, 0.0);
    r.T.assign(r.join.size() * sparse::padded(r.size()), 0.0);
    r.B.assign(r.sampled.size() * r.size(), 0.0);
    r.x.assign(2 * static_cast<std::size_t>(r.size()), 0.0);
    r.left.resize(2 * by.sample.column.size() * r.join.size());
    r.copied.clear();
    for (std::size_t s = 0; s < r.sampled.size(); ++s)
      if (r.sampled[s].in_P < r.own) r.copied.push_back({r.sampled[s].in_P, r.B.data() + s * r.size()});
  }
  int largest = 0;
  for (const RobotsDerivatives::OfRobot& r : by.robots) largest = std::max(largest, r.size());
  by.at.resize(d.island.contacts.size());
  std::size_t size = 0, most = 0;
  for (const RobotsSystem::Coupling& coupling : system.contacts) {
    const int cols = static_cast<int>(d.shape->support().columns[coupling.number].size());
    by.at[coupling.number] = size;
    size += lanes::JoinTerms::size(coupling.rows, cols);
    for (int k : {coupling.A, coupling.B})
      most = std::max(most, static_cast<std::size_t>(by.robots[k].size()) * lanes::JoinTerms::padded(cols));
  }
  by.terms.resize(size);
  by.D.resize(rows);
  by.buffers.resize(threads);
  for (RobotsDerivatives::Buffers& b : by.buffers) {
    b.work.resize(sparse::panel_kernels().work_size(system.interface->schedule));
    b.nonzero.resize(rows);
    b.ED.resize(most);
    b.E.resize(6 * static_cast<std::size_t>(sparse::padded(largest)));
  }
  by.sample.X.resize(n, sparse::padded(by.sample.column.size()));
  by.sample.X.setZero();
  by.sample.b.assign(rows * by.sample.column.size(), 0.0);
}

}  // namespace

void prepare_robots_derivatives(const Scene& scene, IslandWork& d, const IslandDerivatives& out, Workspace& w) {
  if (d.island.robots.size() == 1 || d.bodies || w.options.order) return;
  if (d.choice.method != Method::kSparseLdl) return;
  const double ld = static_cast<double>(out.X.cols());
  const auto most = [&](bool dropping) { return tolerance::kCheaper * cost_at_once(d, ld, dropping); };
  if (!d.robots && (!w.lanes.level || !d.joinable)) return;
  if (!d.robots &&
      costs::kPanelsOnceMore * cost_of_interface(least_interface_counts(*d.shape).nonzeros, ld) >= most(false))
    d.joinable = false;  // independent of the request, as the costs by K and by robots grow with its columns
  make_robots(scene, w, d);
  if (!d.robots) return;
  if (!d.robots->derivatives) d.robots->derivatives = std::make_unique<RobotsDerivatives>(*d.shape, *d.robots);
  RobotsDerivatives& by = *d.robots->derivatives;
  if (by.request != out.request) {
    by.request.reset(), by.has_room = false;  // remains so if an allocation throws
    for (std::size_t k = 0; k < by.robots.size(); ++k) lay_out_columns(d.island, *d.robots->interface, out, k, by);
    choose_sample(by);
    for (const bool dropping : {false, true})
      by.cheaper[dropping] = out.cols > 0 && cost_by_robots(*d.robots, by, ld) < most(dropping);
    by.request = out.request;
  }
  if (by.has_room || !(by.cheaper[false] || by.cheaper[d.deficient])) return;
  take_memory(d, w.threads.size(), by);
  by.has_room = true;
}

}  // namespace internal

}  // namespace manycontact
