#include "manycontact/algorithm/integrate.hpp"

#include "manycontact/spatial/explog.hpp"

namespace manycontact {

namespace {

template <class S>
void integrate_floating(const ConstVecRef<S>& q, int iq, const ConstVecRef<S>& v, int iv, VecRef<S>& out) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const Vec6<S> m = v.template segment<6>(iv);
  const SE3<S> M = placement_of_pose(q.template segment<7>(iq)), E = exp6<S>(m);
  out.template segment<3>(iq) = M.p + M.R * E.p;
  // Multiplies the quaternion of q by that of the rotation vector w. Unlike a conversion of M.R E.R to a quaternion,
  // this does not reverse the quaternion's sign, and is accurate for small w.
  const Vec3<S> w = m.template tail<3>();
  const S t = sqrt(w.squaredNorm());
  const detail::ExpCoefficients<S> half(t * t / S(4));
  const Vec3<S> b = (half.a / S(2)) * w;
  const S bw = cos(t / S(2));
  const Vec3<S> a = q.template segment<3>(iq + 3);
  const S aw = q[iq + 6];
  Eigen::Matrix<S, 4, 1> r;
  r.template head<3>() = aw * b + bw * a + a.cross(b);
  r[3] = aw * bw - a.dot(b);
  out.template segment<4>(iq + 3) = r / S(sqrt(r.squaredNorm()));
}

}  // namespace

template <class S>
void integrate(const Model& model, const ConstVecRef<S>& q, const ConstVecRef<S>& v, VecRef<S> out) {
  using std::cos;
  using std::sin;
  for (const Joint& joint : model.joints) {
    const int iq = joint.idx_q, iv = joint.idx_v;
    switch (joint.type) {
      case JointType::kRevolute:
      case JointType::kPrismatic:
        out[iq] = q[iq] + v[iv];
        break;
      case JointType::kFloating:
        integrate_floating<S>(q, iq, v, iv, out);
        break;
      case JointType::kPlanar: {
        const Vec3<S> d = exp_se2<S>(v.template segment<3>(iv));
        const S c = cos(q[iq + 2]), s = sin(q[iq + 2]);
        out[iq] = q[iq] + c * d[0] - s * d[1];
        out[iq + 1] = q[iq + 1] + s * d[0] + c * d[1];
        out[iq + 2] = q[iq + 2] + d[2];
        break;
      }
    }
  }
}

template <class S>
void difference(const Model& model, const ConstVecRef<S>& q0, const ConstVecRef<S>& q1, VecRef<S> out) {
  using std::cos;
  using std::sin;
  for (const Joint& joint : model.joints) {
    const int iq = joint.idx_q, iv = joint.idx_v;
    switch (joint.type) {
      case JointType::kRevolute:
      case JointType::kPrismatic:
        out[iv] = q1[iq] - q0[iq];
        break;
      case JointType::kFloating: {
        const SE3<S> M0 = placement_of_pose(q0.template segment<7>(iq)),
                     M1 = placement_of_pose(q1.template segment<7>(iq));
        out.template segment<6>(iv) = log6<S>(M0.inverse() * M1);
        break;
      }
      case JointType::kPlanar: {
        const S c = cos(q0[iq + 2]), s = sin(q0[iq + 2]);
        const S dx = q1[iq] - q0[iq], dy = q1[iq + 1] - q0[iq + 1];
        out.template segment<3>(iv) = log_se2<S>(Vec3<S>(c * dx + s * dy, -s * dx + c * dy, q1[iq + 2] - q0[iq + 2]));
        break;
      }
    }
  }
}

using Real = InstantiatedScalar;
template void integrate<Real>(const Model&, const ConstVecRef<Real>&, const ConstVecRef<Real>&, VecRef<Real>);
template void difference<Real>(const Model&, const ConstVecRef<Real>&, const ConstVecRef<Real>&, VecRef<Real>);

}  // namespace manycontact
