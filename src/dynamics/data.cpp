#include "manycontact/dynamics/data.hpp"

#include <stdexcept>

#include "manycontact/kkt/cost.hpp"

namespace manycontact {

RobotData::RobotData(const Model& model)
    : kin(model), Yc(model.njoints()), f(model.njoints()), M(model.M_begin[model.nv]), h(model.nv) {}

SceneData::SceneData(const Scene& scene, const Options& opts)
    : options(opts), v(Eigen::VectorXd::Zero(scene.nv)), tau(v), a(v) {
  robots.reserve(scene.robots.size());
  for (const Robot& robot : scene.robots) robots.emplace_back(*robot.model);
  contacts.reserve(scene.contacts.size());
  for (const Contact& contact : scene.contacts) {
    active.push_back(contact.active);
    supports.push_back(contact_support(scene, contact));
    contacts.emplace_back(contact, supports.back());
  }
  prepare(scene, *this);
}

namespace {

std::shared_ptr<const KktPattern> find_pattern(const Scene& scene, SceneData& data, const IslandData& island,
                                               const std::vector<long>& key, Order order) {
  auto& pattern = data.patterns[{key, order}];
  if (!pattern) pattern = std::make_shared<const KktPattern>(analyze(scene, island.island, island.support, order));
  return pattern;
}

// The method and the order of least predicted cost, where the options leave the choice.
void choose(const Scene& scene, SceneData& data, IslandData& island) {
  const std::vector<long> key = shape_key(scene, island.island, island.support);
  const auto pattern = [&](Order order) { return find_pattern(scene, data, island, key, order); };
  island.safe = pattern(Order::kLeafToRoot);
  if (data.options.order) {
    island.chosen = pattern(*data.options.order);
  } else {
    island.chosen = island.safe;
    for (Order order : kOrders)
      if (predicted_cost_ldl(*pattern(order)) < 0.9 * predicted_cost_ldl(*island.chosen))
        island.chosen = pattern(order);
  }
  island.method = data.options.method;
  if (island.method == Method::kSparseSupernodal ||
      (island.method == Method::kAuto && sparse::supernodal_available() && island.island.nc > 0))
    island.schur_pattern = std::make_shared<const SchurPattern>(analyze_schur(scene, island.island, island.support));
  if (island.method == Method::kAuto) {
    island.method = Method::kSparseLdl;
    if (island.schur_pattern &&
        predicted_cost_supernodal(scene, island.island, *island.schur_pattern) < predicted_cost_ldl(*island.chosen))
      island.method = Method::kSparseSupernodal;
  }
}

IslandData make_island(const Scene& scene, SceneData& data, Island island) {
  IslandData d;
  d.island = std::move(island);
  d.support = island_support(scene, d.island);
  for (int r : d.island.robots) d.M.emplace_back(data.robots[r].M);
  for (int c : d.island.contacts) {
    const Eigen::MatrixXd& J = data.contacts[c].J;
    d.J.emplace_back(J.data(), static_cast<std::size_t>(J.size()));
  }
  choose(scene, data, d);
  d.system.reset(d.chosen);
  return d;
}

}  // namespace

void prepare(const Scene& scene, SceneData& data) {
  if (data.active.size() != scene.contacts.size())
    throw std::invalid_argument("prepare: " + std::to_string(data.active.size()) + " active flags for " +
                                std::to_string(scene.contacts.size()) + " contacts");
  if (data.islands_active == data.active && data.islands_options == data.options &&
      (!data.islands.empty() || scene.robots.empty()))
    return;
  data.solved = false;
  data.islands.clear();
  if (data.derivatives) data.derivatives->islands.clear();
  for (Island& island : find_islands(scene, data.active))
    data.islands.push_back(make_island(scene, data, std::move(island)));
  data.islands_active = data.active;
  data.islands_options = data.options;
  data.robot_island.assign(scene.robots.size(), 0);
  for (std::size_t i = 0; i < data.islands.size(); ++i)
    for (int r : data.islands[i].island.robots) data.robot_island[r] = static_cast<int>(i);
  data.f_offset.assign(scene.contacts.size(), -1);
  int rows = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (!data.active[c]) continue;
    data.f_offset[c] = rows;
    rows += scene.contacts[c].rows();
  }
  data.f = Eigen::VectorXd::Zero(rows);
  data.report.islands.assign(data.islands.size(), {});
}

std::vector<std::string> force_names(const Scene& scene, const SceneData& data) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    for (int k = 0; data.f_offset[c] >= 0 && k < scene.contacts[c].rows(); ++k)
      names.push_back(scene.contacts[c].name + "[" + std::to_string(k) + "]");
  return names;
}

}  // namespace manycontact
