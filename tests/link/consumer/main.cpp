#include <iostream>

#include "manycontact/manycontact.hpp"

int main(int, char** argv) {
  const manycontact::SceneFile file = manycontact::load_scene(argv[1]);
  manycontact::SceneData data(file.scene);
  const manycontact::Report& report = manycontact::solve(file.scene, file.q, file.v, file.u, data);
  std::cout << manycontact::to_string(report.status) << "\n" << data.f << "\n";
}
