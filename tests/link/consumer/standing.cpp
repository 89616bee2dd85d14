#include <iostream>

#include "manycontact/manycontact.hpp"

using namespace manycontact;

int main(int, char** argv) {  // models/humanoid.urdf
  Scene scene;
  add_robot(scene, "humanoid", std::make_shared<const Model>(load_urdf(argv[1], {.floating_base = true})));
  for (const std::string foot : {"left_sole", "right_sole"})
    add_contact(scene, {.name = foot, .type = ContactType::k6D, .A = attach(scene, "humanoid", foot)});

  const Eigen::VectorXd q = neutral(scene), v = Eigen::VectorXd::Zero(scene.nv), u = Eigen::VectorXd::Zero(scene.nu);
  resolve_references(scene, q);  // the soles are held where they are at q

  SceneData data(scene);
  const Report& report = solve(scene, q, v, u, data);
  std::cout << to_string(report.status) << ", rank " << report.rank << " of " << report.nc << "\n"
            << "left sole: " << contact_force(scene, data, "left_sole").transpose() << "\n";
  (void)differentiate(scene, data);
  std::cout << "|da_dq| = " << dense_derivatives(scene, data).da_dq.norm() << "\n";
}
