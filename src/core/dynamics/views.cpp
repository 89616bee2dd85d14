#include "manycontact/dynamics/views.hpp"

#include <stdexcept>

#include "internal.hpp"
#include "manycontact/dynamics/follow_kinematics.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

namespace {

const Workspace& prepared(const SceneData& data) {
  if (!data.workspace || !data.workspace->prepared)
    throw std::logic_error("views of a scene's data: the data are not prepared, call prepare first");
  return *data.workspace;
}

const Workspace& solver(const SceneData& data) { return *data_solved(data).workspace; }

[[noreturn]] void not_there() {
  throw std::logic_error(
      "views of a scene's data: the contact is not active, or the tree is so deep that sparse-bodies does not compute "
      "the terms of K");
}

// Returns an island, and evaluates its terms at the state of the solution.
IslandWork& evaluated(const Scene& scene, const SceneData& data, std::size_t island) {
  internal::check_solved(scene, data, "views of a scene's data", &solved_island(data, island));
  internal::prepare_islands(scene, data);
  IslandWork& d = *data.workspace->islands.at(island);
  if (internal::joint_space_fits(d))
    internal::evaluate_at_state(scene, data, d);
  else
    (void)d.bodies->make_current(scene, data);
  return d;
}

const RobotData& robot_at_state(const Scene& scene, const SceneData& data, int robot) {
  const Workspace& w = prepared(data);
  const int island = island_with_robot(data, robot);
  if (!internal::is_evaluated(w, robot)) (void)evaluated(scene, data, static_cast<std::size_t>(island));
  if (!internal::is_evaluated(w, robot)) not_there();
  return w.robots[robot];
}

void evaluate_rows(const Scene& scene, const SceneData& data, int contact) {  // evaluates the rows unless up to date
  const Workspace& w = prepared(data);
  const auto known = [&] { return w.rows_state.at(contact) == w.state && w.contacts.has(contact); };
  if (known()) return;
  (void)evaluated(scene, data, static_cast<std::size_t>(island_with_robot(data, robot_of(scene.contacts[contact]))));
  if (!known()) not_there();
}

const Linearisation& linearised(const SceneData& data, int contact) {
  const Workspace& w = prepared(data);
  if (!internal::has_derivatives(data) || w.linearisation->state.at(contact) != w.state)
    throw std::logic_error(
        "views of a scene's derivatives: call differentiate first, without SIMD batches (Options::simd_level)");
  return *w.linearisation;
}

}  // namespace

bool is_prepared(const SceneData& data) {
  const Workspace* w = data.workspace.get();
  return w && w->prepared && w->active == data.active && w->options == data.options;
}
std::size_t island_count(const SceneData& data) { return solver(data).islands.size(); }
const Island& solved_island(const SceneData& data, std::size_t i) {
  const Workspace& w = prepared(data);
  return w.reduction ? w.reduction->islands.at(i) : w.islands.at(i)->island;
}
int island_with_robot(const SceneData& data, int robot) { return solver(data).robot_island.at(robot); }
Choice chosen_method(const SceneData& data, std::size_t i) { return solver(data).islands.at(i)->choice; }
const std::shared_ptr<IslandShape>& shape_of(const SceneData& data, std::size_t i) {
  return solver(data).islands.at(i)->shape;
}
const Scene& scene_solved(const Scene& scene, const SceneData& data) {
  const Workspace& w = prepared(data);
  return w.reduction ? w.reduction->scene : scene;
}
const SceneData& data_solved(const SceneData& data) {
  const Workspace& w = prepared(data);
  return w.reduction ? *w.reduction->data : data;
}
const IslandSupport& island_support_of(const Scene& scene, const SceneData& data, std::size_t i) {
  internal::prepare_islands(scene, data);
  return prepared(data).islands.at(i)->shape->support();
}
const KktMatrix& assembled_matrix_of(const Scene& scene, const SceneData& data, std::size_t i) {
  IslandWork& d = evaluated(scene, data, i);
  if (!d.matrix.has_terms()) not_there();
  if (d.matrix.state != data.workspace->state) internal::assemble(scene, data, d.choice.order, scene.damping, d.matrix);
  return d.matrix.K;
}
Eigen::SparseMatrix<double> kkt_matrix(const Scene& scene, const SceneData& data, std::size_t i) {
  const KktMatrix& K = assembled_matrix_of(scene, data, i);
  const MatrixSystem& matrix = prepared(data).islands[i]->matrix;
  const KktPattern& p = *K.pattern;
  const auto unit = [&](int row) { return row < p.nv ? 1 : unit_of(matrix, row - p.nv); };
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < p.size(); ++j)
    for (int s = p.K.p[j]; s < p.K.p[j + 1]; ++s) {
      const int row = p.perm[p.K.i[s]], column = p.perm[j];
      const double value = row == column ? K.values[s] : K.values[s] / (unit(row) * unit(column));
      entries.emplace_back(row, column, value);
      if (row != column) entries.emplace_back(column, row, value);
    }
  Eigen::SparseMatrix<double> out(p.size(), p.size());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

const Kinematics<double>& robot_kinematics(const Scene& scene, const SceneData& data, int robot) {
  return robot_at_state(scene, data, robot).kin;
}
std::span<const Inertia<double>> composite_inertias(const Scene& scene, const SceneData& data, int robot) {
  return robot_at_state(scene, data, robot).Yc;
}
std::span<const double> joint_space_inertia(const Scene& scene, const SceneData& data, int robot) {
  return robot_at_state(scene, data, robot).M;
}
const Eigen::VectorXd& bias_torques(const Scene& scene, const SceneData& data, int robot) {
  return robot_at_state(scene, data, robot).h;
}
const ContactData<double>& contact_data(const Scene& scene, const SceneData& data, int contact) {
  evaluate_rows(scene, data, contact);
  return prepared(data).contacts[contact];
}
const ContactSupport& contact_support(const Scene& scene, const SceneData& data, int contact) {
  const Workspace& w = prepared(data);
  if (!w.supports.has(contact)) evaluate_rows(scene, data, contact);
  if (!w.supports.has(contact)) not_there();
  return w.supports[contact];
}

const ContactData<double>& contact_at_solution(const SceneData& data, int contact) {
  return linearised(data, contact).contacts[contact];
}
const ContactDerivatives& contact_derivatives(const SceneData& data, int contact) {
  return linearised(data, contact).derivatives[contact];
}

void update_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data) {
  expect_configuration("update_kinematics", "q", q, scene);
  expect_numbers("update_kinematics", "v", v, scene.nv);
  follow_kinematics(scene, q, v, data);
}

void follow_kinematics(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v, SceneData& data) {
  internal::check_scene(scene, data, "update_kinematics");
  internal::check_size("update_kinematics", "q", q.size(), scene.nq);
  internal::check_size("update_kinematics", "v", v.size(), scene.nv);
  give_up_solution(data);
  Workspace& w = *data.workspace;
  ++w.state;
  for (int i = 0; i < scene.nrobots(); ++i) {
    const Robot& robot = scene.robots[i];
    const Model& model = *robot.model;
    internal::make_robot(scene, w, i);
    RobotData& r = w.robots[i];
    forward_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), r.kin);
    forward_accelerations<double>(model, v.segment(robot.idx_v, model.nv), nullptr, scene.gravity, r.kin);
    r.Yc = r.kin.Y;
    for (int k = model.njoints() - 1; k > 0; --k)
      if (const int parent = model.joints[k].parent; parent >= 0) r.Yc[parent] += r.Yc[k];
    r.state = w.state;
  }
}

}  // namespace manycontact
