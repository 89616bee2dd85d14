// Derivatives of integrate and difference on the configuration manifold, joint by joint.

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact {

namespace {

using V6 = Vec6<double>;
using M6 = Mat6<double>;
using ConstRef = ConstVectorRef;
using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;

// The coordinates x, y and angle about z of SE(2) as indices into a twist of SE(3).
constexpr int kPlane[3] = {0, 1, 5};
V6 lift(const ConstRef& m) {
  V6 out = V6::Zero();
  for (int i = 0; i < 3; ++i) out[kPlane[i]] = m[i];
  return out;
}
void drop(const M6& J, MatrixRef out) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = J(kPlane[i], kPlane[j]);
}

// Sets a joint's derivative J: for a floating joint to of(v), the derivative on SE(3) at the tangent vector v, for a
// planar joint to the part of it on SE(2), for a joint with one coordinate to `straight`.
template <class Of>
void joint_block(const Joint& joint, const ConstRef& v, double straight, Of&& of, MatrixRef J) {
  if (joint.type == JointType::kFloating)
    J = of(V6(v));
  else if (joint.type == JointType::kPlanar)
    drop(of(lift(v)), J);
  else
    J(0, 0) = straight;
}

}  // namespace

void joint_integrate_derivative(const Joint& joint, const ConstRef& v, bool of_q, MatrixRef J) {
  joint_block(
      joint, v, 1, [of_q](const V6& m) { return of_q ? M6(exp6<double>(m).inverse().action()) : M6(Jexp6<double>(m)); },
      J);
}

void joint_difference_derivative(const Joint& joint, const ConstRef& v, bool of_q0, MatrixRef J) {
  // The derivatives of xi = log(M0^-1 M1) are dxi/dM1 = Jlog(xi) and dxi/dM0 = -Jlog(xi) Ad(exp(-xi)).
  joint_block(
      joint, v, of_q0 ? -1 : 1,
      [of_q0](const V6& xi) {
        const M6 Jlog = Jlog6<double>(xi);
        return of_q0 ? M6(-Jlog * exp6<double>(xi).inverse().action()) : Jlog;
      },
      J);
}

}  // namespace manycontact
