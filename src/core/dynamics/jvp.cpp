#include "manycontact/dynamics/jvp.hpp"

#include <limits>

#include "internal.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "workspace/threads.hpp"

namespace manycontact {

ProductWork::ProductWork(const Scene& scene) {
  const Vec6<double> zero = Vec6<double>::Zero();
  for (const Robot& r : scene.robots) {
    const int n = r.model->njoints();
    const std::vector<Vec6<double>> zeros(n, zero);
    robots.push_back(
        {std::vector<BodyVariation>(n), zeros, zeros, zeros, zeros, zeros, std::vector<double>(r.model->nv)});
  }
  int rows = 0;
  for (const Contact& contact : scene.contacts) rows += contact.rows();
  a.resize(scene.nv);
  y.resize(rows);
  tau.resize(scene.nv);
}

namespace {

void set_nan(Eigen::Ref<Eigen::VectorXd> x) { x.setConstant(std::numeric_limits<double>::quiet_NaN()); }

// Calls product(system, thread) for each island outside SIMD batches, first with the system that solved the island. If
// the product fails, calls it with MatrixSystem; if that fails too, calls refused(island).
template <class Product, class Refused>
void each_product(const Scene& scene, SceneData& data, Product&& product, Refused&& refused) {
  internal::each_island(
      *data.workspace, [&](const IslandWork& d) { return d.served_in_lanes(); },
      [](const IslandWork& d) { return d.answered_by(d.robots.get()); },
      [&](IslandWork& d, std::size_t, ThreadWork& thread) {
        if (!internal::ask(scene, data, d, thread, [&](IslandSystem& system) { return product(system, thread); }))
          refused(d.island);
      });
}

void begin(const Scene& scene, SceneData& data, const char* function) {
  internal::check_not_prescribed(scene, data, function);
  Workspace& w = *data.workspace;
  Linearisation& linearisation = internal::linearisation_of(scene, data);
  for (const auto& d : w.islands) {  // allocates memory before the parallel loop
    if (!d->answered || d->served_in_lanes()) continue;
    if (d->answered_by(d->bodies.get())) {
      if (d->bodies->make_current(scene, data) || !internal::joint_space_fits(*d)) continue;
    }
    internal::make_joint_space(scene, w, *d);
    linearisation.assign(scene, w, d->island);
  }
  (void)internal::products_of(scene, w);
}

// Adds to dtau the derivative of the torques of wrenches and springs along dq, dv, dw. dw: nullptr means zero.
void add_applied_tangent(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv,
                         const double* dw, Eigen::VectorXd& dtau) {
  const Workspace& w = *data.workspace;
  if (!internal::forces_are_applied(w)) return;
  for (const auto& d : w.islands)
    add_applied_tangent(scene, data.v.data(), w.applied->forces, d->island.robots, dq.data(), dv.data(), dw,
                        w.applied->threads.front().scratch, dtau.data());
}

// Adds to wq, wv the products of wtau with the transposed derivatives of the torques of wrenches and springs.
// Overwrites ww with the product for wrenches, unless ww is nullptr.
void add_applied_adjoint(const Scene& scene, SceneData& data, const Eigen::VectorXd& wtau,
                         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, double* ww) {
  const Workspace& w = *data.workspace;
  if (!internal::forces_are_applied(w)) return;
  for (const auto& d : w.islands)
    add_applied_adjoint(scene, data.v.data(), w.applied->forces, d->island.robots, wtau.data(),
                        w.applied->threads.front().scratch, wq.data(), wv.data(), ww);
}

Eigen::Index wrench_numbers(const Scene& scene) { return static_cast<Eigen::Index>(6 * scene.wrenches.size()); }

// Implements both overloads of jvp. dw: nullptr means zero.
void jvp(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv, const ConstVector& du,
         const double* dw, Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df) {
  internal::check_not_prescribed(scene, data, "jvp");
  internal::check_size("jvp", "dq", dq.size(), scene.nv);
  internal::check_size("jvp", "dv", dv.size(), scene.nv);
  internal::check_size("jvp", "du", du.size(), scene.nu);
  internal::check_size("jvp", "da", da.size(), scene.nv);
  internal::check_size("jvp", "df", df.size(), data.f.size());
  if (Reduction* r = data.workspace->reduction) {
    SceneData& solved = internal::differentiated(scene, data);
    if (&solved == r->plain.get()) return jvp(scene, solved, dq, dv, du, dw, da, df);
    internal::remake(r->df, solved.f.size());
    jvp(r->scene, solved, dq, dv, du, dw, da, r->df);
    return internal::expand_forces(data, r->df.data(), df.data());
  }
  begin(scene, data, "jvp");
  set_nan(da), set_nan(df);
  Eigen::VectorXd& torques = data.workspace->products->tau;
  torques_of_motors(scene, du, torques);
  add_applied_tangent(scene, data, dq, dv, dw, torques);
  internal::multiply_alone(scene, data, &lanes::RobotBlocks::jvp, {dq.data(), dv.data(), torques.data()},
                           {da.data(), df.data()});
  const ConstVector dtau = torques;
  const TangentProduct product{dq, dv, dtau, da, df};
  each_product(
      scene, data, [&](IslandSystem& system, ThreadWork& thread) { return system.jvp(scene, data, thread, product); },
      [&](const Island& island) {
        each_velocity_block(scene, island, [&](int at, int, int n) { set_nan(da.segment(at, n)); });
        each_force_block(scene, data.f_offset, island, [&](int at, int, int n) { set_nan(df.segment(at, n)); });
      });
}

// Implements both overloads of vjp. ww: nullptr if not requested.
void vjp(const Scene& scene, SceneData& data, const ConstVector& wa, const ConstVector& wf,
         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu, double* ww) {
  internal::check_not_prescribed(scene, data, "vjp");
  internal::check_size("vjp", "wa", wa.size(), scene.nv);
  internal::check_size("vjp", "wf", wf.size(), data.f.size());
  internal::check_size("vjp", "wq", wq.size(), scene.nv);
  internal::check_size("vjp", "wv", wv.size(), scene.nv);
  internal::check_size("vjp", "wu", wu.size(), scene.nu);
  if (Reduction* r = data.workspace->reduction) {
    SceneData& solved = internal::differentiated(scene, data);
    if (&solved == r->plain.get()) return vjp(scene, solved, wa, wf, wq, wv, wu, ww);
    internal::remake(r->df, solved.f.size());
    internal::reduce_forces(data, wf.data(), r->df.data());
    return vjp(r->scene, solved, wa, r->df, wq, wv, wu, ww);
  }
  begin(scene, data, "vjp");
  Eigen::VectorXd& torques = data.workspace->products->tau;
  Eigen::Ref<Eigen::VectorXd> wtau = torques;
  set_nan(wq), set_nan(wv), set_nan(wtau);
  internal::multiply_alone(scene, data, &lanes::RobotBlocks::vjp, {wa.data(), wf.data()},
                           {wq.data(), wv.data(), wtau.data()});
  const AdjointProduct product{wa, wf, wq, wv, wtau};
  each_product(
      scene, data, [&](IslandSystem& system, ThreadWork& thread) { return system.vjp(scene, data, thread, product); },
      [&](const Island& island) {
        each_velocity_block(scene, island, [&](int at, int, int n) {
          set_nan(wq.segment(at, n)), set_nan(wv.segment(at, n)), set_nan(wtau.segment(at, n));
        });
      });
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) wu[robot.idx_u + k] = torques[robot.idx_v + robot.model->actuated[k]];
  add_applied_adjoint(scene, data, torques, wq, wv, ww);
}

}  // namespace

void jvp(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv, const ConstVector& du,
         Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df) {
  jvp(scene, data, dq, dv, du, nullptr, da, df);
}

void jvp(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv, const ConstVector& du,
         const ConstVector& dw, Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df) {
  internal::check_size("jvp", "dw", dw.size(), wrench_numbers(scene));
  jvp(scene, data, dq, dv, du, dw.data(), da, df);
}

void vjp(const Scene& scene, SceneData& data, const ConstVector& wa, const ConstVector& wf,
         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu) {
  vjp(scene, data, wa, wf, wq, wv, wu, nullptr);
}

void vjp(const Scene& scene, SceneData& data, const ConstVector& wa, const ConstVector& wf,
         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu,
         Eigen::Ref<Eigen::VectorXd> ww) {
  internal::check_size("vjp", "ww", ww.size(), wrench_numbers(scene));
  ww.setZero();
  vjp(scene, data, wa, wf, wq, wv, wu, ww.data());
}

}  // namespace manycontact
