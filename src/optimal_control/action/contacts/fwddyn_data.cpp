// Data of DifferentialActionModelContactFwdDynamics, and the rows and columns that change with the contact islands.

#include <map>

#include "contact_columns.hpp"
#include "fwddyn_steps.hpp"
#include "manycontact/dynamics/keep_dependent.hpp"

namespace manycontact {

namespace {

// Makes the scene that is solved. It has the state's robots with the given models, and the contacts sorted by name.
Scene scene_of(const DifferentialActionModelContactFwdDynamics& model,
               const std::vector<std::shared_ptr<const Model>>& models) {
  Scene scene = model.get_model().scene();
  for (std::size_t r = 0; r < models.size(); ++r) scene.robots[r].model = models[r];
  scene.damping = model.get_damping_factor();
  for (const auto& [name, item] : model.get_contacts()->get_contacts()) {
    Contact contact = item->contact->get_contact();
    contact.name = name;
    contact.active = item->active;
    add_contact(scene, contact);
  }
  return scene;
}

}  // namespace

DifferentialActionDataContactFwdDynamics::DifferentialActionDataContactFwdDynamics(
    DifferentialActionModelContactFwdDynamics* model)
    : DifferentialActionDataAbstract(model),
      owner(model->identity_),
      contacts_version(model->get_contacts()->get_version()),
      models(model->models_) {
  multibody = std::make_unique<DataCollector>(scene_of(*model, *models), model->get_options(),
                                              model->get_actuation()->createData());
  if (const Eigen::VectorXd& x0 = model->get_start(); x0.size() > 0) {
    const Scene& scene = multibody->scene;
    const Eigen::VectorXd no_torques = Eigen::VectorXd::Zero(scene.nu);
    (void)solve(scene, x0.head(scene.nq), x0.tail(scene.nv), no_torques, multibody->solution);
    keep_dependent(multibody->solution);
  }
  internal::lay_out_islands(*model->get_actuation(), *this);
  for (const auto& [name, item] : model->get_contacts()->get_contacts())
    multibody->contacts->contacts[name] = std::make_shared<ContactDataAbstract>();
  internal::lay_out_contacts(*model->get_contacts(), *multibody);
  costs = model->get_costs()->createData(multibody.get(), this);
  if (model->get_constraints()) constraints = model->get_constraints()->createData(multibody.get(), this);
}

namespace internal {

std::vector<std::shared_ptr<const Model>> models_with_armature(const Scene& scene, const Eigen::VectorXd& armature) {
  std::vector<std::shared_ptr<const Model>> out;
  std::map<std::pair<const Model*, std::vector<double>>, std::shared_ptr<const Model>> made;
  for (const Robot& robot : scene.robots) {
    const Eigen::VectorXd wanted = armature.segment(robot.idx_v, robot.model->nv);
    if (wanted == robot.model->armature) {
      out.push_back(robot.model);
      continue;
    }
    auto& model = made[{robot.model.get(), std::vector<double>(wanted.begin(), wanted.end())}];
    if (!model) {
      Model copy = *robot.model;
      copy.armature = wanted;
      model = std::make_shared<const Model>(std::move(copy));
    }
    out.push_back(model);
  }
  return out;
}

bool update_contacts(const ContactModelMultiple& contacts, Scene& scene, SceneData& solution) {
  bool same = true;
  std::size_t c = 0;
  for (const auto& [name, item] : contacts.get_contacts()) {
    const Contact& from = item->contact->get_contact();
    Contact& to = scene.contacts[c];
    same &= have_same_rows(from, to);
    to.type = from.type;
    to.reference_frame = from.reference_frame;
    to.A = from.A;
    to.B = from.B;
    to.axis = from.axis;
    to.alpha = from.alpha;
    to.beta = from.beta;
    solution.active[c++] = item->active;
  }
  return same;
}

bool on_same_frames(const ContactModelMultiple& contacts, const ContactDataMultiple& data) {
  auto part = data.contacts.begin();
  for (const auto& [name, item] : contacts.get_contacts())
    if ((part++)->second->frame != item->contact->get_id()) return false;
  return true;
}

Actuation kind(const ActuationModelAbstract& actuation, const Scene& scene) {
  const std::vector<int>& selection = actuation.selection();
  if (selection.size() != actuation.get_nu()) return Actuation::kCustom;
  const auto is = [&](bool all) {
    std::size_t k = 0;
    for (const Robot& robot : scene.robots)
      for (int i = 0; i < (all ? robot.model->nv : robot.model->nu()); ++i, ++k)
        if (k >= selection.size() || selection[k] != robot.idx_v + (all ? i : robot.model->actuated[i])) return false;
    return k == selection.size();
  };
  if (is(false)) return Actuation::kActuated;
  return is(true) ? Actuation::kAll : Actuation::kCustom;
}

void lay_out_islands(const ActuationModelAbstract& actuation, DifferentialActionDataContactFwdDynamics& data) {
  DataCollector& m = *data.multibody;
  const Actuation how = kind(actuation, m.scene);
  const int nv = m.scene.nv, nu = static_cast<int>(actuation.get_nu());
  new (&data.panel) PanelView(nullptr, 0, 0, Eigen::OuterStride<>(0));  // the previous memory may be freed below
  require(data.storage != MatrixStorage::kPanel || island_count(m.solution) == 1,
          "DifferentialActionDataContactFwdDynamics",
          "storage kPanel requires a scene of one island, the scene has " + std::to_string(island_count(m.solution)) +
              " islands: kDense is expected");
  m.islands.assign(island_count(m.solution), {});
  m.custom.assign(how == Actuation::kCustom ? m.islands.size() : 0, {});
  data.Fx.setZero();
  data.Fu.setZero();
  data.Fx_blocks.clear();
  data.Fu_blocks.clear();
  for (std::size_t i = 0; i < m.islands.size(); ++i) {
    IslandColumns& columns = m.islands[i];
    for (int r : solved_island(m.solution, i).robots) {
      const Robot& robot = m.scene.robots[r];
      for (int k = 0; k < robot.model->nv; ++k) columns.v.push_back(robot.idx_v + k);
      for (int k = 0; how == Actuation::kActuated && k < robot.model->nu(); ++k) columns.u.push_back(robot.idx_u + k);
    }
    if (how == Actuation::kAll) columns.u = columns.v;
    if (how == Actuation::kCustom) {  // a custom actuation may couple all coordinates
      columns.x = range(0, 2 * nv);
      columns.u = range(0, nu);
    } else {
      columns.x = columns.v;
      for (int k : columns.v) columns.x.push_back(nv + k);
    }
    if (data.storage == MatrixStorage::kDense || data.storage == MatrixStorage::kPanel) continue;
    data.Fx_blocks.plan(columns.v, columns.x);
    data.Fu_blocks.plan(columns.v, columns.u);
  }
  data.Fx_blocks.finish(nv, 2 * nv);
  data.Fu_blocks.finish(nv, nu);
}

void lay_out_contacts(const ContactModelMultiple& contacts, DataCollector& m) {
  int c = 0;
  for (const auto& [name, item] : contacts.get_contacts()) {
    ContactDataAbstract& data = *m.contacts->contacts.at(name);
    const Contact& contact = m.scene.contacts[c];
    data.index = c;
    data.active = item->active;
    data.frame = item->contact->get_id();
    data.contact = &contact;
    data.f.type = contact.type;
    data.f.axis = contact.axis;
    data.v_columns.clear();
    const auto add = [&](int r) {
      for (int i = 0; i < m.scene.robots[r].model->nv; ++i) data.v_columns.push_back(m.scene.robots[r].idx_v + i);
    };
    add(contact.A.robot);
    if (contact.B.robot >= 0 && contact.B.robot != contact.A.robot) add(contact.B.robot);
    const Eigen::Index nc = contact.rows(), n = data.v_columns.size();
    data.Jc.setZero(nc, n);
    data.a0.setZero(nc);
    data.da0_dx.setZero(nc, 2 * n);
    data.f.setZero(nc);
    const IslandColumns& island = m.islands[island_with_robot(m.solution, robot_of(contact))];
    data.f_x_columns = &island.x;
    data.f_u_columns = &island.u;
    new (&data.df_dx) PanelView(nullptr, 0, 0, Eigen::OuterStride<>(0));
    new (&data.df_du) PanelView(nullptr, 0, 0, Eigen::OuterStride<>(0));
    ++c;
  }
}

}  // namespace internal
}  // namespace manycontact
