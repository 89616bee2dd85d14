#include <algorithm>

#include "manycontact/action/residuals/gravity_residuals.hpp"
#include "manycontact/dynamics/static_torque.hpp"
#include "residual_parts.hpp"

namespace manycontact {

namespace {

struct GravityData : ResidualDataAbstract {
  GravityData(const ResidualModelAbstract* model, DataCollector* collector)
      : ResidualDataAbstract(model, collector), statics(collector->scene) {}
  StaticTorque statics;                      // set by calc: torques without motion, and their workspace
  std::vector<int> local;                    // set by lay_out: index of each velocity coordinate in its island
  std::vector<int> island;                   // set by lay_out: island of each velocity coordinate
  std::vector<std::vector<int>> q_column;    // set by lay_out, by island: columns of the island's q in its block
  std::vector<IslandDerivatives::Panel> dg;  // set by calcDiff: derivative of the static torque, per island
};

void set_static_part(GravityData& d, bool contacts) {
  for (std::size_t i = 0; i < d.blocks.size(); ++i) {
    ResidualBlock& block = d.blocks[i];
    static_torque_derivative(d.shared->scene, d.shared->solution, i, contacts, d.statics, d.dg[i]);
    block.Rx.setZero();
    block.Ru.setZero();
    for (Eigen::Index j = 0; j < d.dg[i].rows(); ++j)
      for (Eigen::Index k = 0; k < d.dg[i].cols(); ++k) block.Rx(j, d.q_column[i][k]) = -d.dg[i](j, k);
  }
}

// Adds to `out` the entries of `matrix` (nv rows) that are in the rows of an island and in the given columns.
void add_part(const GravityData& d, int island, const Eigen::SparseMatrix<double>& matrix,
              const std::vector<int>& columns, RowMajorMatrix& out) {
  if (matrix.nonZeros() == 0) return;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, columns[j]); it; ++it)
      if (d.island[it.row()] == island) out(d.local[it.row()], static_cast<Eigen::Index>(j)) += it.value();
}

// Adds J^T df of the contacts of island i to its block of the residual. The derivatives df of the contact forces are
// in the island's panel, below the rows of the accelerations.
void add_force_part(GravityData& d, std::size_t i) {
  ResidualBlock& block = d.blocks[i];
  const Island& island = solved_island(d.shared->solution, i);
  const PanelView panel = d.shared->panel(i);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = d.shared->scene.contacts[island.contacts[k]];
    const Eigen::MatrixXd& J = contact_data(d.shared->scene, d.shared->solution, island.contacts[k]).J;
    const ContactSupport& support = contact_support(d.shared->scene, d.shared->solution, island.contacts[k]);
    const auto above_A = static_cast<Eigen::Index>(support.a.size());
    const auto df = panel.middleRows(island.nv + island.row_offset[k], J.rows());
    for (Eigen::Index c = 0; c < J.cols(); ++c) {
      const int row = c < above_A ? first_dof(island, contact.A) + support.a[c]
                                  : first_dof(island, contact.B) + support.b[c - above_A];
      for (Eigen::Index m = 0; m < J.rows(); ++m) {
        block.Rx.row(row) += J(m, c) * df.row(m).head(block.Rx.cols());
        block.Ru.row(row) += J(m, c) * df.row(m).segment(block.Rx.cols(), block.Ru.cols());
      }
    }
  }
}

}  // namespace

// Declares dependence on v, which forces and general actuations cause. lay_out omits columns of v if neither exists.
GravityResidual::GravityResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nu, bool contacts)
    : NamedResidual(name, state, internal::given(state).get_nv(), nu,
                    {.q = true, .v = true, .u = true, .forces = contacts}),
      contacts_(contacts) {
  require(nu_ > 0, name, "nu is 0, one control or more is expected");
}

std::shared_ptr<ResidualDataAbstract> GravityResidual::createData(DataCollector* shared) {
  if (contacts_)
    internal::expect_dynamics(name_, shared);
  else
    internal::expect_motion(name_, shared);
  require(shared->actuation != nullptr, name_,
          "the collector has no data of an actuation, a collector with such data is expected");
  auto data = std::make_shared<GravityData>(this, shared);
  lay_out(*data);
  return data;
}

void GravityResidual::lay_out(ResidualDataAbstract& data) const {
  auto& d = internal::own<GravityData>(data);
  const std::vector<IslandColumns>& islands = d.shared->islands;
  d.blocks.clear();
  d.dg.clear();
  d.q_column.assign(islands.size(), {});
  d.local.assign(nr_, -1);
  d.island.assign(nr_, -1);
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const std::vector<int>& v = islands[i].v;
    for (std::size_t k = 0; k < v.size(); ++k) {
      d.local[v[k]] = static_cast<int>(k);
      d.island[v[k]] = static_cast<int>(i);
    }
    std::vector<int> x = islands[i].x;
    if (!contacts_ && d.shared->custom.empty()) x = v;  // only columns of q: the residual does not depend on v
    for (int dof : v) d.q_column[i].push_back(static_cast<int>(std::find(x.begin(), x.end(), dof) - x.begin()));
    d.blocks.emplace_back(v, std::move(x), islands[i].u);
    d.dg.emplace_back(v.size(), v.size());
  }
}

void GravityResidual::evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef&) const {
  auto& d = internal::own<GravityData>(data);
  static_torque(d.shared->scene, d.shared->solution, x.data(), contacts_, d.statics);
  d.r = d.shared->actuation->tau - d.statics.tau;
}

void GravityResidual::calc(const DataPtr& data, const ConstVectorRef& x) {
  auto& d = internal::own<GravityData>(*data);
  static_torque(d.shared->scene, d.shared->solution, x.data(), false, d.statics);
  d.r = -d.statics.tau;
}

void GravityResidual::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&, const ConstVectorRef&) const {
  auto& d = internal::own<GravityData>(data);
  set_static_part(d, contacts_);
  for (std::size_t i = 0; i < d.blocks.size(); ++i) {
    ResidualBlock& block = d.blocks[i];
    add_part(d, static_cast<int>(i), d.shared->actuation->dtau_dx, block.xcols, block.Rx);
    add_part(d, static_cast<int>(i), d.shared->actuation->dtau_du, block.ucols, block.Ru);
    if (contacts_) add_force_part(d, i);
  }
}

void GravityResidual::differentiate(const DataPtr& data, const ConstVectorRef&) {
  set_static_part(internal::own<GravityData>(*data), false);
}

}  // namespace manycontact
