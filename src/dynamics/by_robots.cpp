// What is known of derivatives robot by robot before any number is: patterns, places, predicted cost.

#include "by_robots.hpp"

#include <algorithm>

#include "bodies.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"

namespace manycontact {

ByRobots::ByRobots(const IslandShape& shape, Order order, std::shared_ptr<const Joining> j, ShapeCache& shapes)
    : robots(j->robots.begin(), j->robots.end()), joining(std::move(j)), compiled(joining->schedule.compiled) {
  const Scene& scene = shape.scene();
  const Island& island = shape.island();
  for (std::size_t k = 0; k < robots.size(); ++k) {
    OfRobot& r = robots[k];
    const Island own = alone(shape, *joining, k);
    r.K.reset(shapes.find(scene, own)->pattern(order));
    compiled = compiled && r.K.pattern->schedule().compiled;
    for (int i = 0; i < own.nv; ++i) r.row.push_back(island.dof_offset[k] + i);
    for (int c : r.contacts)
      for (int i = 0; i < scene.contacts[island.contacts[c]].rows(); ++i)
        r.row.push_back(island.nv + island.row_offset[c] + i);
    for (int k : r.joining) r.join.push_back(joining->row[k]);
  }
  for (int k : joining->perm) eliminated.push_back(joining->row[k]);
}

namespace internal {

namespace {

// Multiply-adds of a panel that goes through the island's factor, and is refined in every second state.
double cost_at_once(const IslandWork& d, double ld) {
  const KktPattern& p = *d.shape->pattern(d.choice.order);
  return ld * (3.0 * p.ldl.nonzeros() + p.K.nonzeros());
}

// The same robot by robot. Those of a product run faster than those of a sparse solve; the panels of the robots are
// filled and read once more. Measured on rings and on a beam between two humanoids.
double cost_by_robots(const ByRobots& by, double ld) {
  constexpr double kProduct = 0.4, kPanels = 1.3;
  double cost = ld * 2.0 * by.joining->symbolic.nonzeros();
  for (const ByRobots::OfRobot& r : by.robots) {
    const KktPattern& p = *r.K.pattern;
    cost += r.ld * (4.0 * p.ldl.nonzeros() + 2.0 * p.K.nonzeros());
    cost += kProduct * r.padded() * (p.nv * r.ld + p.size() * ld);
  }
  return kPanels * cost;
}

void lay_out_columns(const Island& island, const IslandDerivatives& out, std::size_t k, ByRobots& by) {
  ByRobots::OfRobot& r = by.robots[k];
  r.columns.clear();
  int at = r.padded();
  const auto add = [&](bool wanted, int first, int count) {
    if (!wanted || count == 0) return;
    r.columns.push_back({first, at, count});
    at += count;
  };
  add(out.request.q, out.q_first + island.dof_offset[k], r.K.nv());
  add(out.request.v, out.v_first + island.dof_offset[k], r.K.nv());
  add(out.request.u, out.u_first + out.u_offset[k], out.u_offset[k + 1] - out.u_offset[k]);
  for (int n : r.neighbours) add(out.request.q, out.q_first + island.dof_offset[n], by.robots[n].K.nv());
  r.ld = sparse::padded(at);
}

// Columns of robots' own, of q, v and u by turns; each meets the factors of all of them. Sixteen at most: they are
// judged one after the other.
void choose_sample(ByRobots& by) {
  by.sample.column.clear();
  for (ByRobots::OfRobot& r : by.robots) r.sampled.clear();
  const std::size_t step = (by.robots.size() + 15) / 16;
  for (std::size_t k = 0; k < by.robots.size(); k += step) {
    const std::vector<ByRobots::Columns>& columns = by.robots[k].columns;
    if (columns.empty()) continue;
    const ByRobots::Columns& block = columns[k / step % columns.size()];
    const int column = block.in_X + static_cast<int>(7 * k) % block.count;
    for (ByRobots::OfRobot& r : by.robots)
      for (const ByRobots::Columns& c : r.columns)
        if (c.in_X <= column && column < c.in_X + c.count)
          r.sampled.push_back({static_cast<int>(by.sample.column.size()), c.in_P + column - c.in_X, 1});
    by.sample.column.push_back(column);
  }
}

void take_memory(const IslandWork& d, std::size_t threads, ByRobots& by) {
  const std::size_t rows = by.joining->row.size(), n = d.island.size();
  for (ByRobots::OfRobot& r : by.robots) {
    if (!r.factor) r.factor = make_ldl_factor(Method::kSparseLdl);
    r.J.resize(r.contacts.size());
    r.G.assign(static_cast<std::size_t>(r.K.nv()) * r.padded(), 0.0);
    r.P.assign(static_cast<std::size_t>(r.size()) * r.ld, 0.0);
    r.H.assign(static_cast<std::size_t>(r.padded()) * r.ld, 0.0);
    r.T.assign(r.joining.size() * sparse::padded(r.size()), 0.0);
    r.nonzero.resize(r.size());
  }
  by.Sx.resize(by.joining->S.nonzeros());
  by.L.resize(by.joining->symbolic.nonzeros());
  by.D.resize(rows);
  by.scale.resize(rows);
  by.buffers.resize(threads);
  for (ByRobots::Buffers& b : by.buffers) {
    b.work.resize(sparse::panel_kernels().work_size(by.joining->schedule));
    b.nonzero.resize(rows);
    b.x.resize(n);
    b.r.resize(n);
    b.scale.resize(n);
  }
  by.sample.X.resize(n, sparse::padded(by.sample.column.size()));
  by.sample.X.setZero();
  by.sample.b.resize(n * by.sample.column.size());
  by.sample.error.resize(by.sample.column.size());
}

}  // namespace

void prepare_by_robots(IslandWork& d, const IslandDerivatives& out, Workspace& w) {
  if (d.island.robots.size() == 1 || has_bodies(d) || w.options.order) return;
  if (d.choice.method != Method::kSparseLdl && d.choice.method != Method::kSparseSupernodal) return;
  const Order order = d.cut ? d.choice.order : Order::kLeafToRoot;
  if (!d.by_robots) d.by_robots = std::make_unique<ByRobots>(*d.shape, order, joining_of(d), w.shapes);
  ByRobots& by = *d.by_robots;
  if (by.laid_out && by.request == out.request) return;
  by.laid_out = false;  // should memory run out
  for (std::size_t k = 0; k < by.robots.size(); ++k) lay_out_columns(d.island, out, k, by);
  choose_sample(by);
  const double ld = static_cast<double>(out.X.cols());
  by.cheaper = by.compiled && out.cols > 0 && cost_by_robots(by, ld) < tolerance::kCheaper * cost_at_once(d, ld);
  if (by.cheaper) take_memory(d, w.threads.size(), by);
  by.request = out.request;
  by.laid_out = true;
}

}  // namespace internal

}  // namespace manycontact
