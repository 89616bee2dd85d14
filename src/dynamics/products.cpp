#include "manycontact/dynamics/products.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "internal.hpp"
#include "manycontact/contact/products.hpp"

namespace manycontact {

ProductData::ProductData(const Scene& scene, const std::vector<ContactSupport>& supports) {
  const Vec6<double> zero = Vec6<double>::Zero();
  for (const Robot& r : scene.robots) {
    const int n = r.model->njoints();
    const std::vector<Vec6<double>> zeros(n, zero);
    robots.push_back(
        {std::vector<BodyVariation>(n), zeros, zeros, zeros, zeros, zeros, std::vector<double>(r.model->nv)});
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) rows.emplace_back(scene.contacts[c], supports[c]);
}

namespace {

using V6 = Vec6<double>;
const BodyVariation kRest{V6::Zero(), V6::Zero(), V6::Zero(), V6::Zero()};

void check_size(const char* function, const char* what, Eigen::Index given, Eigen::Index expected) {
  if (given != expected)
    throw std::invalid_argument(std::string(function) + ": " + what + " has " + std::to_string(given) +
                                " numbers, the scene expects " + std::to_string(expected));
}

// Motions and rows at the solution's accelerations.
ProductData& linearise(const Scene& scene, SceneData& data, const Island& island) {
  ProductData& pd = *data.products;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    forward_accelerations<double>(*robot.model, data.v.segment(robot.idx_v, robot.model->nv),
                                  data.a.data() + robot.idx_v, scene.gravity, data.robots[r].kin);
  }
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    contact_rows<double>(scene, contact, data.supports[c], data.robots[contact.A.robot].kin,
                         contact.B.robot < 0 ? nullptr : &data.robots[contact.B.robot].kin, pd.rows[c]);
  }
  return pd;
}

// x <- K^-1 x in the order of the system's b, refined once.
void solve_refined(const Scene& scene, IslandData& d) {
  KktSystem& s = d.system;
  s.x = s.b;
  internal::solve_with_factor(scene, d, s.x.data());
  if (d.factor != Factor::kDense) refine(s, 1, [&](double* x) { internal::solve_with_factor(scene, d, x); });
}

const BodyVariation& body(const ProductData& pd, const Attachment& at) {
  return at.robot < 0 || at.joint < 0 ? kRest : pd.robots[at.robot].body[at.joint];
}

// b = -dr along (dq, dv, du), in elimination order.
void tangent_rhs(const Scene& scene, SceneData& data, IslandData& d, const ConstVector& dq, const ConstVector& dv,
                 const ConstVector& du) {
  ProductData& pd = linearise(scene, data, d.island);
  const int* iperm = d.system.pattern->iperm.data();
  double* b = d.system.b.data();
  for (int r : d.island.robots) {
    const Robot& robot = scene.robots[r];
    ProductData::OfRobot& p = pd.robots[r];
    tangent_motions(*robot.model, data.robots[r].kin, data.a.data() + robot.idx_v, dq.data() + robot.idx_v,
                    dv.data() + robot.idx_v, p.body);
    std::fill(p.fext.begin(), p.fext.end(), V6(V6::Zero()));
    std::fill(p.dfext.begin(), p.dfext.end(), V6(V6::Zero()));
  }
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const int c = d.island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = pd.rows[c];
    const auto f = data.f.segment(data.f_offset[c], contact.rows());
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> dr2(contact.rows());
    V6 dF;
    contact_tangent(contact, rows, body(pd, contact.A), body(pd, contact.B), f, dr2, dF);
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
    ProductData::OfRobot& p = pd.robots[d.island.robots[k]];
    const RobotData& rd = data.robots[d.island.robots[k]];
    tangent_torques(model, rd.kin, p.body, p.fext, p.dfext, p.f, p.df, p.w.data());
    const int first = model.first_actuated();
    for (int i = 0; i < model.nv; ++i)
      b[iperm[d.island.dof_offset[k] + i]] = (i < first ? 0.0 : du[robot.idx_u + i - first]) - p.w[i];
  }
}

// wq, wv, wu of one island from l = K^-1 [wa; -wf] in system.x.
void pull_back_island(const Scene& scene, SceneData& data, const IslandData& d, Eigen::Ref<Eigen::VectorXd> wq,
                      Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu) {
  ProductData& pd = linearise(scene, data, d.island);
  const int* iperm = d.system.pattern->iperm.data();
  const double* x = d.system.x.data();
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    const Model& model = *robot.model;
    ProductData::OfRobot& p = pd.robots[d.island.robots[k]];
    const RobotData& rd = data.robots[d.island.robots[k]];
    for (int i = 0; i < model.nv; ++i) p.w[i] = x[iperm[d.island.dof_offset[k] + i]];
    for (int i = model.first_actuated(); i < model.nv; ++i) wu[robot.idx_u + i - model.first_actuated()] = p.w[i];
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
    contact_adjoint(contact, pd.rows[c], u(contact.A), u(contact.B), data.f.segment(data.f_offset[c], contact.rows()),
                    l, of(contact.A), of(contact.B));
  }
  for (int r : d.island.robots) {
    const Robot& robot = scene.robots[r];
    ProductData::OfRobot& p = pd.robots[r];
    pull_back(*robot.model, data.robots[r].kin, data.a.data() + robot.idx_v, p.u, p.body, wq.data() + robot.idx_v,
              wv.data() + robot.idx_v);
    wq.segment(robot.idx_v, robot.model->nv) *= -1;  // w = -(dr)^T l
    wv.segment(robot.idx_v, robot.model->nv) *= -1;
  }
}

// The derivatives of an island with dependent rows, in full.
ProductData::Dense& dense_island(const Scene& scene, SceneData& data, std::size_t i) {
  internal::prepare_derivatives(scene, data);
  data.products->dense.resize(data.islands.size());
  ProductData::Dense& out = data.products->dense[i];
  internal::lay_out(scene, data.islands[i].island, {}, out.D);
  internal::differentiate_island(scene, data, i, out.D);
  out.rows.resize(out.D.X.rows());
  out.columns.resize(out.D.cols);
  return out;
}

// An island's part of a scene's vectors, and back.
struct Part {
  const Scene& scene;
  const SceneData& data;
  const Island& island;

  template <class Use>  // use(index in the scene, index in the island)
  void velocities(Use&& use) const {
    int k = 0;
    for (int r : island.robots)
      for (int i = 0; i < scene.robots[r].model->nv; ++i) use(scene.robots[r].idx_v + i, k++);
  }
  template <class Use>
  void torques(Use&& use) const {
    int k = 0;
    for (int r : island.robots)
      for (int i = 0; i < scene.robots[r].model->nu(); ++i) use(scene.robots[r].idx_u + i, k++);
  }
  template <class Use>
  void forces(Use&& use) const {
    int k = 0;
    for (int c : island.contacts)
      for (int i = 0; i < scene.contacts[c].rows(); ++i) use(data.f_offset[c] + i, k++);
  }
};

void dense_jvp(const Part& part, ProductData::Dense& dense, const ConstVector& dq, const ConstVector& dv,
               const ConstVector& du, Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df) {
  auto& [D, out, in] = dense;
  part.velocities([&](int s, int k) { in[D.q_first + k] = dq[s], in[D.v_first + k] = dv[s]; });
  part.torques([&](int s, int k) { in[D.u_first + k] = du[s]; });
  out.noalias() = D.X.leftCols(D.cols) * in;
  part.velocities([&](int s, int k) { da[s] = out[k]; });
  part.forces([&](int s, int k) { df[s] = out[D.nv + k]; });
}

void dense_vjp(const Part& part, ProductData::Dense& dense, const ConstVector& wa, const ConstVector& wf,
               Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu) {
  auto& [D, in, out] = dense;
  part.velocities([&](int s, int k) { in[k] = wa[s]; });
  part.forces([&](int s, int k) { in[D.nv + k] = wf[s]; });
  out.noalias() = D.X.leftCols(D.cols).transpose() * in;
  part.velocities([&](int s, int k) { wq[s] = out[D.q_first + k], wv[s] = out[D.v_first + k]; });
  part.torques([&](int s, int k) { wu[s] = out[D.u_first + k]; });
}

// An island's right-hand side and solution, as long as it lives those of a product.
class OwnVectors {
 public:
  OwnVectors(KktSystem& system, ProductData& memory) : s(system), m(memory) {
    for (auto* x : {&m.b, &m.x, &m.r, &m.scale}) x->resize(s.b.size());
    swap();
  }
  ~OwnVectors() { swap(); }
  OwnVectors(const OwnVectors&) = delete;

 private:
  void swap() {
    s.b.swap(m.b);
    s.x.swap(m.x);
    s.r.swap(m.r);
    s.scale.swap(m.scale);
  }
  KktSystem& s;
  ProductData& m;
};

bool usable(const SceneData& data, std::size_t i) {
  return data.islands[i].factor != Factor::kNone && data.islands[i].factor != Factor::kDenseSchur;
}

void begin(const Scene& scene, SceneData& data, const char* function) {
  internal::check_solved(data, function);
  if (!data.products) data.products = std::make_unique<ProductData>(scene, data.supports);
}

}  // namespace

void jvp(const Scene& scene, SceneData& data, const ConstVector& dq, const ConstVector& dv, const ConstVector& du,
         Eigen::Ref<Eigen::VectorXd> da, Eigen::Ref<Eigen::VectorXd> df) {
  begin(scene, data, "jvp");
  check_size("jvp", "dq", dq.size(), scene.nv);
  check_size("jvp", "dv", dv.size(), scene.nv);
  check_size("jvp", "du", du.size(), scene.nu);
  check_size("jvp", "da", da.size(), scene.nv);
  check_size("jvp", "df", df.size(), data.f.size());
  da.setConstant(std::numeric_limits<double>::quiet_NaN());
  df.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    if (!usable(data, i)) continue;
    IslandData& d = data.islands[i];
    if (internal::rank_deficient(d)) {
      dense_jvp({scene, data, d.island}, dense_island(scene, data, i), dq, dv, du, da, df);
      continue;
    }
    const OwnVectors own(d.system, *data.products);
    tangent_rhs(scene, data, d, dq, dv, du);
    solve_refined(scene, d);
    internal::scatter(scene, data, d, d.system.x.data(), da, df);
    for (int c : d.island.contacts) df.segment(data.f_offset[c], scene.contacts[c].rows()) *= -1;  // x = [da; -df]
  }
}

void vjp(const Scene& scene, SceneData& data, const ConstVector& wa, const ConstVector& wf,
         Eigen::Ref<Eigen::VectorXd> wq, Eigen::Ref<Eigen::VectorXd> wv, Eigen::Ref<Eigen::VectorXd> wu) {
  begin(scene, data, "vjp");
  check_size("vjp", "wa", wa.size(), scene.nv);
  check_size("vjp", "wf", wf.size(), data.f.size());
  check_size("vjp", "wq", wq.size(), scene.nv);
  check_size("vjp", "wv", wv.size(), scene.nv);
  check_size("vjp", "wu", wu.size(), scene.nu);
  for (auto* w : {&wq, &wv, &wu}) w->setConstant(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    if (!usable(data, i)) continue;
    IslandData& d = data.islands[i];
    if (internal::rank_deficient(d)) {
      dense_vjp({scene, data, d.island}, dense_island(scene, data, i), wa, wf, wq, wv, wu);
      continue;
    }
    const OwnVectors own(d.system, *data.products);
    internal::gather(scene, data, d, wa, wf, d.system.b.data());
    for (int k = 0; k < d.island.nc; ++k) d.system.b[d.system.pattern->iperm[d.island.nv + k]] *= -1;
    solve_refined(scene, d);
    pull_back_island(scene, data, d, wq, wv, wu);
  }
}

}  // namespace manycontact
