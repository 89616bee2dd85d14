#include "manycontact/detail/action/collector.hpp"

namespace manycontact {

namespace {
// Switches off SIMD batches and Options::reduce_pairs, because these do not store contact data that costs read.
Options robot_by_robot(Options options) {
  options.simd_level = SimdLevel::kOff;
  options.reduce_pairs = false;
  return options;
}
}  // namespace

MultibodyData::MultibodyData(const Multibody& model)
    : scene(model.scene()),
      solution(scene, robot_by_robot({})),
      q(Eigen::VectorXd::Zero(scene.nq)),
      v(Eigen::VectorXd::Zero(scene.nv)),
      a(v) {
  manycontact::prepare(scene, solution);
  for (const Robot& robot : scene.robots) {
    motion.emplace_back(*robot.model);
    terms.emplace_back(*robot.model);
  }
}

void MultibodyData::update(const ConstVectorRef& at_q, const ConstVectorRef& at_v, const ConstVectorRef& at_a) {
  check_size("MultibodyData::update", "a", at_a.size(), static_cast<std::size_t>(scene.nv));
  update_kinematics(scene, at_q, at_v, solution);
  q = at_q;
  v = at_v;
  a = at_a;
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    motion[r] = robot_kinematics(scene, solution, static_cast<int>(r));
    const std::span<const Inertia<double>> Yc = composite_inertias(scene, solution, static_cast<int>(r));
    forward_accelerations<double>(*robot.model, v.segment(robot.idx_v, robot.model->nv), a.data() + robot.idx_v,
                                  scene.gravity, motion[r]);
    rnea_derivatives<double>(*robot.model, motion[r], {Yc.begin(), Yc.end()}, {}, terms[r]);
  }
}

struct DataCollector::Own {  // the scene of an action model, and its solution
  Own(const Scene& s, const Options& options) : scene(s), solution(scene, options) {}
  Scene scene;
  SceneData solution;
};

DataCollector::DataCollector(const Scene& s, const Options& options, std::shared_ptr<ActuationDataAbstract> act)
    : own_(std::make_unique<Own>(s, robot_by_robot(options))),
      whole(false),
      scene(own_->scene),
      solution(own_->solution),
      actuation(std::move(act)),
      contacts(std::make_shared<ContactDataMultiple>()) {
  prepare();
}

DataCollector::DataCollector(MultibodyData* motion, std::shared_ptr<ActuationDataAbstract> act,
                             std::shared_ptr<ContactDataMultiple> contact)
    : own_(motion ? nullptr : std::make_unique<Own>(Scene{}, Options{})),
      whole(true),
      pinocchio(motion),
      scene(motion ? motion->scene : own_->scene),
      solution(motion ? motion->solution : own_->solution),
      actuation(std::move(act)),
      contacts(contact ? std::move(contact) : std::make_shared<ContactDataMultiple>()) {
  if (!motion) return;
  // A general actuation may couple all coordinates, so that every island depends on all of x and u.
  const int nv = scene.nv, nu = actuation ? static_cast<int>(actuation->u.size()) : 0;
  for (std::size_t i = 0; i < island_count(solution); ++i) {
    IslandColumns& columns = islands.emplace_back();
    columns.x = internal::range(0, 2 * nv);
    columns.u = internal::range(0, nu);
    for (const int r : solved_island(solution, i).robots) {
      const std::vector<int> of_robot = internal::range(scene.robots[r].idx_v, scene.robots[r].model->nv);
      columns.v.insert(columns.v.end(), of_robot.begin(), of_robot.end());
    }
  }
  custom.resize(islands.size());
}

DataCollector::~DataCollector() = default;

void DataCollector::prepare() {
  manycontact::prepare(scene, solution);
  for (std::size_t i = 0; i < island_count(solution); ++i) {
    if (chosen_method(solution, i).method != Method::kSparseBodies) continue;
    solution.options.method = Method::kSparseLdl;
    manycontact::prepare(scene, solution);
    return;
  }
}

PanelView DataCollector::panel(std::size_t i) const {
  if (!custom.empty()) {
    (void)derivatives(solution);  // throws if no derivatives of the last solve exist
    const RowMajorMatrix& X = custom[i];
    return PanelView(X.data(), X.rows(), X.cols(), Eigen::OuterStride<>(X.cols()));
  }
  const IslandDerivatives& d = derivatives(solution).islands[i];
  return PanelView(d.X.data(), d.X.rows(), d.cols, Eigen::OuterStride<>(d.X.cols()));
}

const ContactDataAbstract& DataCollector::contact_on(FrameIndex frame, const std::string& who,
                                                     const std::string& wanted) const {
  const ContactDataAbstract* found = nullptr;
  std::string names;
  int count = 0;
  for (const auto& [name, contact] : contacts->contacts) {
    if (contact->frame != frame || (!wanted.empty() && name != wanted)) continue;
    found = contact.get();
    names += (count++ ? ", " : "") + name;
  }
  require(count == 1, who,
          count == 0 ? "frame " + std::to_string(frame) + " has no contact" + (wanted.empty() ? "" : " " + wanted) +
                           ", a contact is expected"
                     : "frame " + std::to_string(frame) + " has several contacts (" + names +
                           "), exactly one contact is expected");
  return *found;
}

}  // namespace manycontact
