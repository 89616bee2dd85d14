#include "manycontact/dynamics/jvp.hpp"

#include <algorithm>
#include <limits>

#include "bodies.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/contact/products.hpp"
#include "steps.hpp"
#include "threads.hpp"

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
  f.resize(rows);
}

namespace {

using V6 = Vec6<double>;
const BodyVariation kRest{V6::Zero(), V6::Zero(), V6::Zero(), V6::Zero()};

const BodyVariation& body(const ProductWork& pd, const Attachment& at) {
  return at.robot < 0 || at.joint < 0 ? kRest : pd.robots[at.robot].body[at.joint];
}

// v.b = -dr along (dq, dv, du), in elimination order.
void tangent_rhs(const Scene& scene, const SceneData& data, const IslandWork& d, const ConstVector& dq,
                 const ConstVector& dv, const ConstVector& du, KktVectors& v, ProductWork& pd) {
  const Workspace& w = *data.workspace;
  const int* iperm = d.K.pattern->iperm.data();
  double* b = v.b.data();
  for (int r : d.island.robots) {
    const Robot& robot = scene.robots[r];
    ProductWork::OfRobot& p = pd.robots[r];
    tangent_motions(*robot.model, w.robots[r].kin, data.a.data() + robot.idx_v, dq.data() + robot.idx_v,
                    dv.data() + robot.idx_v, p.body);
    std::fill(p.fext.begin(), p.fext.end(), V6(V6::Zero()));
    std::fill(p.dfext.begin(), p.dfext.end(), V6(V6::Zero()));
  }
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const int c = d.island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = w.linearisation->contacts[c];
    const auto f = data.f.segment(data.f_offset[c], contact.rows());
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> dr2(contact.rows());
    V6 dF;
    contact_tangent<double>(contact, rows, body(pd, contact.A), body(pd, contact.B), f, dr2, dF);
    const V6 F = rows.W.transpose() * f;
    if (contact.A.joint >= 0) {
      pd.robots[contact.A.robot].fext[contact.A.joint] += rows.aMA.act_force(F);
      pd.robots[contact.A.robot].dfext[contact.A.joint] += rows.aMA.act_force(dF);
    }
    if (contact.B.robot >= 0 && contact.B.joint >= 0) {
      pd.robots[contact.B.robot].fext[contact.B.joint] -= rows.bMA.act_force(F);
      pd.robots[contact.B.robot].dfext[contact.B.joint] -= rows.bMA.act_force(dF);
    }
    for (int i = 0; i < contact.rows(); ++i) b[iperm[d.island.nv + d.island.row_offset[k] + i]] = -dr2[i];
  }
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    const Model& model = *robot.model;
    ProductWork::OfRobot& p = pd.robots[d.island.robots[k]];
    const RobotData& rd = w.robots[d.island.robots[k]];
    tangent_torques(model, rd.kin, p.body, p.fext, p.dfext, p.f, p.df, p.w.data());
    const int* at = iperm + d.island.dof_offset[k];
    for (int i = 0; i < model.nv; ++i) b[at[i]] = -p.w[i];
    for (int i = 0; has_friction(model) && i < model.nv; ++i)
      b[at[i]] -= friction_slope(model, i, data.v[robot.idx_v + i]) * dv[robot.idx_v + i];
    for (int i = 0; i < model.nu(); ++i) b[at[model.actuated[i]]] += du[robot.idx_u + i];
  }
}

// wq, wv, wu of one island from l = K^-1 [wa; -wf] in v.x.
void pull_back_island(const Scene& scene, const SceneData& data, const IslandWork& d, const KktVectors& v,
                      ProductWork& pd, Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv,
                      Eigen::Ref<Eigen::VectorXd> wu) {
  const Workspace& w = *data.workspace;
  const int* iperm = d.K.pattern->iperm.data();
  const double* x = v.x.data();
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    const Model& model = *robot.model;
    ProductWork::OfRobot& p = pd.robots[d.island.robots[k]];
    const RobotData& rd = w.robots[d.island.robots[k]];
    for (int i = 0; i < model.nv; ++i) p.w[i] = x[iperm[d.island.dof_offset[k] + i]];
    for (int i = 0; i < model.nu(); ++i) wu[robot.idx_u + i] = p.w[model.actuated[i]];
    virtual_velocities(model, rd.kin, p.w.data(), p.u);
    std::fill(p.body.begin(), p.body.end(), kRest);
    add_body_adjoints(model, rd.kin, p.u, p.body);
  }
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const int c = d.island.contacts[k];
    const Contact& contact = scene.contacts[c];
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> l(contact.rows());
    for (int i = 0; i < contact.rows(); ++i) l[i] = x[iperm[d.island.nv + d.island.row_offset[k] + i]];
    BodyVariation nobody = kRest;
    const auto of = [&](const Attachment& at) -> BodyVariation& {
      return at.robot < 0 || at.joint < 0 ? nobody : pd.robots[at.robot].body[at.joint];
    };
    const auto u = [&](const Attachment& at) {
      return at.robot < 0 || at.joint < 0 ? V6(V6::Zero()) : pd.robots[at.robot].u[at.joint];
    };
    contact_adjoint<double>(contact, w.linearisation->contacts[c], u(contact.A), u(contact.B),
                            data.f.segment(data.f_offset[c], contact.rows()), l, of(contact.A), of(contact.B));
  }
  for (int r : d.island.robots) {
    const Robot& robot = scene.robots[r];
    ProductWork::OfRobot& p = pd.robots[r];
    pull_back(*robot.model, w.robots[r].kin, data.a.data() + robot.idx_v, p.u, p.body, wq.data() + robot.idx_v,
              wv.data() + robot.idx_v);
    wq.segment(robot.idx_v, robot.model->nv) *= -1;  // w = -(dr)^T l
    wv.segment(robot.idx_v, robot.model->nv) *= -1;
    for (int i = 0; has_friction(*robot.model) && i < robot.model->nv; ++i)
      wv[robot.idx_v + i] -= friction_slope(*robot.model, i, data.v[robot.idx_v + i]) * p.w[i];
  }
}

// The derivatives of an island with dependent rows, in full.
const IslandDerivatives& formed(const Scene& scene, SceneData& data, std::size_t i, ThreadWork& thread) {
  IslandWork& d = *data.workspace->islands[i];
  if (!d.all) d.all = std::make_unique<IslandDerivatives>();
  if (d.all->u_offset.empty()) internal::lay_out(scene, d.island, {}, *d.all);
  internal::differentiate_island(scene, data, i, *d.all, thread);
  return *d.all;
}

void formed_jvp(const Scene& scene, SceneData& data, std::size_t i, const ConstVector& dq, const ConstVector& dv,
                const ConstVector& du, Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df,
                ThreadWork& thread) {
  const IslandDerivatives& D = formed(scene, data, i, thread);
  const Island& island = data.workspace->islands[i]->island;
  Eigen::VectorXd &in = thread.formed.columns, &out = thread.formed.rows;
  internal::remake(in, D.cols);
  internal::remake(out, island.size());
  each_velocity_block(scene, island, [&](int from, int to, int n) {
    in.segment(D.q_first + to, n) = dq.segment(from, n);
    in.segment(D.v_first + to, n) = dv.segment(from, n);
  });
  each_torque_block(scene, island,
                    [&](int from, int to, int n) { in.segment(D.u_first + to, n) = du.segment(from, n); });
  out.noalias() = D.X.leftCols(D.cols) * in;
  each_velocity_block(scene, island, [&](int to, int from, int n) { da.segment(to, n) = out.segment(from, n); });
  each_force_block(scene, data.f_offset, island,
                   [&](int to, int from, int n) { df.segment(to, n) = out.segment(D.nv + from, n); });
}

void formed_vjp(const Scene& scene, SceneData& data, std::size_t i, const ConstVector& wa, const ConstVector& wf,
                Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu,
                ThreadWork& thread) {
  const IslandDerivatives& D = formed(scene, data, i, thread);
  const Island& island = data.workspace->islands[i]->island;
  Eigen::VectorXd &out = thread.formed.columns, &in = thread.formed.rows;
  internal::remake(in, island.size());
  internal::remake(out, D.cols);
  each_velocity_block(scene, island, [&](int from, int to, int n) { in.segment(to, n) = wa.segment(from, n); });
  each_force_block(scene, data.f_offset, island,
                   [&](int from, int to, int n) { in.segment(D.nv + to, n) = wf.segment(from, n); });
  out.noalias() = D.X.leftCols(D.cols).transpose() * in;
  each_velocity_block(scene, island, [&](int to, int from, int n) {
    wq.segment(to, n) = out.segment(D.q_first + from, n);
    wv.segment(to, n) = out.segment(D.v_first + from, n);
  });
  each_torque_block(scene, island,
                    [&](int to, int from, int n) { wu.segment(to, n) = out.segment(D.u_first + from, n); });
}

// work(number, memory of the thread) for each island that no lane serves. Those of joined robots have their own use for
// all threads.
template <class Work>
void each_alone(SceneData& data, Work&& work) {
  Workspace& w = *data.workspace;
  const auto joined = [&](std::size_t i) { return internal::solved_joined(data, *w.islands[i]); };
  for (std::size_t i = 0; i < w.islands.size(); ++i)
    if (joined(i)) work(i, w.threads.front());
  internal::each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    if (!w.islands[i]->served_in_lanes() && !joined(i)) work(i, thread);
  });
}

// Whether there is an answer; where lanes gave it, with all that products need.
bool solution_at_hand(const Scene& scene, SceneData& data, IslandWork& d, ThreadWork& thread) {
  if (internal::solved_joined(data, d)) return true;
  if (d.in_lanes) internal::complete_island(scene, data, d, thread);
  return d.factor;
}

// v.x = K^-1 v.b, refined once.
void solve_once_refined(const Scene& scene, SceneData& data, IslandWork& d, KktVectors& v, ProductWork& pd) {
  if (!internal::solved_joined(data, d)) return (void)solve_refined(*d.factor, d.K, v, 1);
  const auto turn = [&] {
    each_force_block(scene, data.f_offset, d.island, [&](int first, int, int n) { pd.f.segment(first, n) *= -1; });
  };
  internal::scatter(scene, data.f_offset, *d.K.pattern, d.island, v.b.data(), pd.a, pd.f);
  turn();
  internal::solve_once_refined_joined(scene, data, d, pd.a, pd.f);
  turn();
  internal::gather(scene, data.f_offset, *d.K.pattern, d.island, pd.a, pd.f, v.x.data());
}

ProductWork& begin(const Scene& scene, SceneData& data, const char* function) {
  internal::check_unasked(scene, data, function);
  internal::evaluate_joined(scene, data);
  Workspace& w = *data.workspace;
  Linearisation& linearisation = internal::linearisation_of(scene, data);
  for (const auto& d : w.islands) {
    internal::complete_bodies(scene, data, *d, w.threads.front());  // by_bodies may not hold any more
    if (!internal::by_bodies(*d)) linearisation.assign(scene, w, *d);
  }
  if (!w.products) w.products = std::make_unique<ProductWork>(scene);
  return *w.products;
}

}  // namespace

void jvp(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv, const ConstVector& du,
         Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df) {
  ProductWork& pd = begin(scene, data, "jvp");
  internal::check_size("jvp", "dq", dq.size(), scene.nv);
  internal::check_size("jvp", "dv", dv.size(), scene.nv);
  internal::check_size("jvp", "du", du.size(), scene.nu);
  internal::check_size("jvp", "da", da.size(), scene.nv);
  internal::check_size("jvp", "df", df.size(), data.f.size());
  da.setConstant(std::numeric_limits<double>::quiet_NaN());
  df.setConstant(std::numeric_limits<double>::quiet_NaN());
  const internal::OneBlasOfThreads one_blas_thread(*data.workspace);
  internal::jvp_in_lanes(scene, data, dq.data(), dv.data(), du.data(), da.data(), df.data());
  each_alone(data, [&](std::size_t i, ThreadWork& thread) {
    IslandWork& d = *data.workspace->islands[i];
    if (!solution_at_hand(scene, data, d, thread)) return;
    if (internal::by_bodies(d)) return internal::jvp_by_bodies(scene, data, d, dq, dv, du, da, df);
    if (!internal::solved_joined(data, d) && internal::rank_deficient(d))
      return formed_jvp(scene, data, i, dq, dv, du, da, df, thread);
    const AtSolution at(scene, data, d.island);
    thread.v.resize(d.K.size());
    tangent_rhs(scene, data, d, dq, dv, du, thread.v, pd);
    solve_once_refined(scene, data, d, thread.v, pd);
    internal::scatter(scene, data.f_offset, *d.K.pattern, d.island, thread.v.x.data(), da, df);
    each_force_block(scene, data.f_offset, d.island,
                     [&](int first, int, int n) { df.segment(first, n) *= -1; });  // x = [da; -df]
  });
}

void vjp(const Scene& scene, SceneData& data, const ConstVector& wa, const ConstVector& wf,
         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu) {
  ProductWork& pd = begin(scene, data, "vjp");
  internal::check_size("vjp", "wa", wa.size(), scene.nv);
  internal::check_size("vjp", "wf", wf.size(), data.f.size());
  internal::check_size("vjp", "wq", wq.size(), scene.nv);
  internal::check_size("vjp", "wv", wv.size(), scene.nv);
  internal::check_size("vjp", "wu", wu.size(), scene.nu);
  for (auto* w : {&wq, &wv, &wu}) w->setConstant(std::numeric_limits<double>::quiet_NaN());
  const internal::OneBlasOfThreads one_blas_thread(*data.workspace);
  internal::vjp_in_lanes(scene, data, wa.data(), wf.data(), wq.data(), wv.data(), wu.data());
  each_alone(data, [&](std::size_t i, ThreadWork& thread) {
    IslandWork& d = *data.workspace->islands[i];
    if (!solution_at_hand(scene, data, d, thread)) return;
    if (internal::by_bodies(d)) return internal::vjp_by_bodies(scene, data, d, wa, wf, wq, wv, wu);
    if (!internal::solved_joined(data, d) && internal::rank_deficient(d))
      return formed_vjp(scene, data, i, wa, wf, wq, wv, wu, thread);
    const AtSolution at(scene, data, d.island);
    thread.v.resize(d.K.size());
    internal::gather(scene, data.f_offset, *d.K.pattern, d.island, wa, wf, thread.v.b.data());
    for (int k = 0; k < d.island.nc; ++k) thread.v.b[d.K.pattern->iperm[d.island.nv + k]] *= -1;
    solve_once_refined(scene, data, d, thread.v, pd);
    pull_back_island(scene, data, d, thread.v, pd, wq, wv, wu);
  });
}

}  // namespace manycontact
