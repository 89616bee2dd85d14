#include <iostream>

#include "manycontact/manycontact.hpp"

using namespace manycontact;

int main(int, char** argv) {  // a scene file
  const SceneFile file = load_scene(argv[1]);
  const Scene& scene = file.scene;
  SceneData data(scene);
  if (solve(scene, file.q, file.v, file.u, data).status == Status::kFailed) return 1;

  // Blocks of each island: rows and columns are those of its own robots and contacts.
  const IslandDerivatives& island = differentiate(scene, data).islands[0];
  std::cout << "da_dq " << island.da_dq().rows() << " x " << island.da_dq().cols() << ", dforces_du "
            << island.dforces_du().rows() << " x " << island.dforces_du().cols() << "\n";

  // The gradient of any function of a and f, here |f|^2 / 2, without a matrix.
  const Eigen::VectorXd wa = Eigen::VectorXd::Zero(scene.nv), wf = data.f, a = data.a;
  Eigen::VectorXd wq(scene.nv), wv(scene.nv), wu(scene.nu);
  vjp(scene, data, wa, wf, wq, wv, wu);

  // The same by central differences: q moves on its manifold, by integrate.
  Eigen::VectorXd dq = Eigen::VectorXd::LinSpaced(scene.nv, -1, 1), half(2);
  const double h = 1e-6;
  for (const int side : {0, 1}) {
    const Eigen::VectorXd q = integrate(scene, file.q, (side ? h : -h) * dq);
    if (solve(scene, q, file.v, file.u, data).status == Status::kFailed) return 1;
    half[side] = data.f.squaredNorm() / 2;
  }
  const double difference = (half[1] - half[0]) / (2 * h);
  std::cout << "along dq: " << wq.dot(dq) << ", by differences: " << difference << "\n"
            << (std::abs(wq.dot(dq) - difference) < 1e-6 * std::abs(difference) ? "they agree\n" : "they differ\n");
}
