#pragma once
// Every algorithm is tested on these robots and their states.

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "manycontact/algorithm/aba.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "spatial/compare.hpp"
#include "support/random.hpp"

namespace manycontact::test {

inline constexpr double kTight = 64 * kEps;  // of a few operations on numbers of size 1

struct Shape {
  std::string name;
  ModelOptions options;
  unsigned seed = 11;

  friend std::ostream& operator<<(std::ostream& out, const Shape& shape) { return out << shape.name; }
};

inline std::vector<Shape> shapes() {
  using enum JointType;
  const ModelOptions mixed;
  return {
      {"one_revolute", {.njoints = 1, .types = {kRevolute}}},
      {"free_body", {.njoints = 1, .floating_base = true}},
      {"arm_coordinate_axes", {.njoints = 7, .types = {kRevolute}, .coordinate_axes = 1, .branching = 0}},
      {"arm_any_axes", {.njoints = 7, .types = {kRevolute}, .coordinate_axes = 0, .branching = 0}},
      {"prismatic", {.njoints = 6, .types = {kPrismatic}}},
      {"planar", {.njoints = 5, .types = {kPlanar}}},
      {"inner_floating", {.njoints = 5, .types = {kFloating}}},
      {"mixed_fixed_base", {.njoints = 10, .types = mixed.types}},
      {"mixed_floating_base", {.njoints = 10, .floating_base = true, .types = mixed.types}},
      {"mixed_armature", {.njoints = 10, .floating_base = true, .types = mixed.types, .armature = 0.5}},
      {"mixed_floating_base_2", {.njoints = 14, .floating_base = true, .types = mixed.types, .branching = 0.5}, 12},
      {"mixed_fixed_base_2", {.njoints = 14, .types = mixed.types, .branching = 0.1, .armature = 0.2}, 13},
      {"star", {.njoints = 12, .floating_base = true, .types = mixed.types, .branching = 1}},
      {"legged", {.njoints = 25, .floating_base = true, .types = {kRevolute}, .coordinate_axes = 0.9}},
      {"chain_of_60", {.njoints = 60, .types = {kRevolute}, .branching = 0}},
  };
}

/// A model and a state of it, in double.
struct Specimen {
  explicit Specimen(const ModelOptions& options, unsigned seed = 11) : rng(seed), model(random_model(rng, options)) {
    base = random_placement(rng, 2);
    q = random_configuration(model, rng);
    v = random_vector(model.nv, rng);
    qdd = random_vector(model.nv, rng);
    tau = random_vector(model.nv, rng, 5);
    for (int i = 0; i < model.njoints(); ++i) fext.push_back(random_vector(6, rng, 3));
  }
  std::mt19937 rng;
  Model model;
  SE3<double> base;
  Vec3<double> gravity{0.4, -0.7, -9.81};  // tilted, to leave no axis out
  Eigen::VectorXd q, v, qdd, tau;
  std::vector<Vec6<double>> fext;
};

class Robots : public testing::TestWithParam<Shape> {
 protected:
  Specimen s{GetParam().options, GetParam().seed};
  const Model& model = s.model;
};

inline const auto shape_name = [](const testing::TestParamInfo<Shape>& info) { return info.param.name; };

/// Returns tau(q, v, qdd) from RNEA. fext: in the child frames, or empty.
template <class S>
VecX<S> torques(const Specimen& s, const VecX<S>& q, const VecX<S>& v, const VecX<S>& qdd, const Vec3<double>& gravity,
                const std::vector<Vec6<S>>& fext = {}) {
  Kinematics<S> kin(s.model);
  std::vector<Vec6<S>> f;
  VecX<S> tau(s.model.nv);
  rnea<S>(s.model, s.base, q, v, qdd, gravity, fext, kin, f, tau);
  return tau;
}

/// Returns qdd from ABA.
template <class S>
VecX<S> accelerations(const Specimen& s, const VecX<S>& q, const VecX<S>& v, const VecX<S>& tau,
                      const Vec3<double>& gravity, const std::vector<Vec6<S>>& fext = {}) {
  Kinematics<S> kin(s.model);
  AbaData<S> data(s.model);
  VecX<S> qdd(s.model.nv);
  EXPECT_TRUE(aba<S>(s.model, s.base, q, v, tau, gravity, fext, kin, data, qdd));
  return qdd;
}

/// Returns M from CRBA, dense.
template <class S>
MatX<S> inertia_matrix(const Specimen& s, const VecX<S>& q) {
  Kinematics<S> kin(s.model);
  forward_kinematics<S>(s.model, s.base, q, kin);
  std::vector<Inertia<S>> Yc;
  VecX<S> packed(s.model.M_begin[s.model.nv]);
  crba<S>(s.model, kin, Yc, packed.data());
  MatX<S> M(s.model.nv, s.model.nv);
  unpack_inertia<S>(s.model, packed.data(), M);
  return M;
}

}  // namespace manycontact::test
