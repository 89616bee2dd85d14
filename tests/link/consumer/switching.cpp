#include <iostream>

#include "manycontact/manycontact.hpp"

using namespace manycontact;

int main(int, char** argv) {  // models/tasks/quadruped_scene.xml: four feet, each a 3D contact
  const SceneFile file = load_scene(argv[1]);
  const Scene& scene = file.scene;
  SimulationData motion(scene, file.q, file.v, Integrator::kSemiImplicitEuler, 1e-3);
  std::vector<char>& active = motion.dynamics.active;  // one flag per contact of the scene

  for (const std::vector<std::string>& lifted : {std::vector<std::string>{}, {"LF", "RH"}, {"RF", "LH"}, {}}) {
    std::fill(active.begin(), active.end(), 1);
    for (const std::string& foot : lifted) active[scene.contact_index.at(foot)] = 0;
    const Eigen::VectorXd u = quasi_static(scene, motion.q, motion.dynamics);  // by the feet that are down
    for (int i = 0; i < 10; ++i)
      if (const StepStatus status = step(scene, u, motion); status != StepStatus::kOk) {
        std::cerr << failure(scene, motion, status) << "\n";
        return 1;
      }
    std::cout << motion.time() << " s, " << to_string(motion.dynamics.report.status) << ":";
    for (const Contact& contact : scene.contacts)
      if (active[scene.contact_index.at(contact.name)])
        std::cout << " " << contact.name << " " << contact_force(scene, motion, contact.name)[2];
    std::cout << " N\n";
  }
}
