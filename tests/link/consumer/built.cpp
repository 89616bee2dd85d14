#include <iostream>

#include "manycontact/manycontact.hpp"

using namespace manycontact;

int main(int, char** argv) {  // argv[1]: the folder models
  const auto load = [&](const std::string& urdf) {
    return std::make_shared<const Model>(load_urdf(argv[1] + urdf, {.floating_base = true}));
  };
  Scene scene;
  add_robot(scene, "humanoid", load("/humanoid.urdf"), {.p = {0, 0, 0.7884}});
  add_robot(scene, "crate", load("/box.urdf"), {.p = {0.31, 0.2, 0.75}});
  add_contact(scene, {.name = "left", .A = attach(scene, "humanoid", "left_sole")});  // 6D, to the world
  add_contact(scene, {.name = "right", .A = attach(scene, "humanoid", "right_sole")});
  const int hand = add_contact(scene, {.name = "hand",
                                       .reference_frame = ReferenceFrame::kLocalWorldAligned,
                                       .A = attach(scene, "crate", "face_top"),
                                       .B = attach(scene, "humanoid", "left_hand")});

  Eigen::VectorXd q = neutral(scene), v = Eigen::VectorXd::Zero(scene.nv);
  for (const std::string side : {"left", "right"}) {
    q[q_index(scene, "humanoid", side + "_hip_pitch")] = -0.4;
    q[q_index(scene, "humanoid", side + "_knee")] = 0.8;
    q[q_index(scene, "humanoid", side + "_ankle_pitch")] = -0.4;
  }
  q[q_index(scene, "humanoid", "left_elbow")] = -1.57;
  resolve_references(scene, q);  // every contact holds what it finds at q

  SceneData data(scene);
  const Eigen::VectorXd u = quasi_static(scene, q, data);
  std::cout << to_string(solve(scene, q, v, u, data).status) << ": the hand carries "
            << contact_force(scene, data, "hand")[2] << " N, |a| = " << data.a.norm() << "\n";
  (void)differentiate(scene, data);
  const int z = v_index(scene, "crate", "root") + 2, elbow = u_index(scene, "humanoid", "left_elbow");
  std::cout << "the elbow's torque moves it by " << dense_derivatives(scene, data).da_du(z, elbow)
            << " m/s^2 per N m\n";

  data.active[hand] = false;
  std::cout << to_string(solve(scene, q, v, u, data).status) << ": let go, it accelerates by " << data.a[z]
            << " m/s^2\n";

  SimulationData through_time(scene, q, v, Integrator::kRk4, 1e-3);
  through_time.dynamics.active[hand] = false;
  while (through_time.steps < 100)
    if (step(scene, u, through_time) != StepStatus::kOk) return 1;
  const int height = q_index(scene, "crate", "root") + 2;
  std::cout << "after " << through_time.time() << " s it has fallen " << q[height] - through_time.q[height] << " m\n";
}
