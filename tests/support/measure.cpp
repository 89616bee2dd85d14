#include "support/measure.hpp"

#include <ostream>

#include "support/islands.hpp"

namespace manycontact::test {

namespace {

double worse(double a, double b) { return b <= a ? a : a != a ? a : b; }

double relative(double difference, double size) { return difference == 0 ? 0 : difference / size; }

// Returns the relative error of the forces of contacts on a robot.
template <class S>
double force_error(const Scene& scene, const SceneData& data, int robot, const VecX<S>& f) {
  double difference = 0, size = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (data.f_offset[c] < 0 || (contact.A.robot != robot && contact.B.robot != robot)) continue;
    const auto truth = f.segment(data.f_offset[c], contact.rows());
    difference = worse(difference, difference_of(data.f.segment(data.f_offset[c], contact.rows()), truth));
    size = worse(size, size_of(truth));
  }
  return relative(difference, size);
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const Errors& e) {
  return out << "a " << e.acceleration << ", f " << e.forces << ", " << e.excess << " times the allowed";
}

template <class S>
Errors errors(const Scene& scene, const SceneData& data, const VecX<S>& a, const VecX<S>& f,
              const std::vector<double>& condition, const Eigen::VectorXd& a_free) {
  Errors e;
  const std::vector<int> island = island_numbers(scene, data.active);
  for (int r = 0; r < scene.nrobots(); ++r) {
    const int o = scene.robots[r].idx_v, nv = scene.robots[r].model->nv;
    const auto truth = a.segment(o, nv);
    double size = size_of(truth);
    if (a_free.size() > 0) size = worse(size, size_of(a_free.segment(o, nv)));
    const double ea = relative(difference_of(data.a.segment(o, nv), truth), size);
    const double ef = force_error<S>(scene, data, r, f);
    e.acceleration = worse(e.acceleration, ea);
    e.forces = worse(e.forces, ef);
    e.excess = worse(e.excess, worse(ea, ef) / allowed(condition[island[r]]));
  }
  return e;
}

template Errors errors<double>(const Scene&, const SceneData&, const VecX<double>&, const VecX<double>&,
                               const std::vector<double>&, const Eigen::VectorXd&);
template Errors errors<Quad>(const Scene&, const SceneData&, const VecX<Quad>&, const VecX<Quad>&,
                             const std::vector<double>&, const Eigen::VectorXd&);

std::vector<double> conditions(const Scene& scene, SceneData& data) {
  estimate_condition(scene, data);
  std::vector<double> out;
  for (const IslandReport& island : data.report.islands) out.push_back(island.condition);
  return out;
}

Eigen::VectorXd free_accelerations(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                   const Eigen::VectorXd& u) {
  SceneData data(scene, {Method::kDense, {}});
  data.active.assign(scene.contacts.size(), 0);
  (void)solve(scene, q, v, u, data);
  return data.a;
}

}  // namespace manycontact::test
