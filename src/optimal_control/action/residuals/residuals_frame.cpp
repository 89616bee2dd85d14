#include <ostream>

#include "manycontact/action/residuals/frame_residuals.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/spatial/explog.hpp"
#include "residual_parts.hpp"

namespace manycontact {

namespace {

struct FrameResidualData : ResidualDataAbstract {
  using ResidualDataAbstract::ResidualDataAbstract;
  const Multibody::BodyFrame* frame = nullptr;  // set by lay_out: the frame with the residual's id
  std::vector<int> chain;                       // set by lay_out: coordinates of the robot that move the frame

  const Kinematics<double>& kin() const { return shared->kinematics(frame->robot); }
  const SE3<double>& base() const { return shared->scene.robots[frame->robot].base; }
  const Model& model() const { return *shared->scene.robots[frame->robot].model; }
  SE3<double> oMf() const { return frame_placement<double>(kin(), base(), frame->joint, frame->placement); }
  // Returns the frame's placement in the tree frame of its robot. The frame must not be fixed to the base.
  SE3<double> in_tree() const { return kin().oMi[frame->joint] * frame->placement; }
};

// Transforms the spatial velocity m = [linear; angular] at the origin to that at the point p, in the same axes.
Vec6<double> at_point(const Eigen::Vector3d& p, const Vec6<double>& m) {
  Vec6<double> out = m;
  out.head<3>() -= p.cross(m.tail<3>());
  return out;
}

}  // namespace

FrameResidual::FrameResidual(const char* name, std::shared_ptr<StateMultibody> state, FrameIndex id, std::size_t nr,
                             std::size_t nu, Dependence on)
    : NamedResidual(name, std::move(state), nr, nu, on) {
  set_id(id);
}

void FrameResidual::set_id(FrameIndex id) {
  internal::body_frame(name_, internal::multibody(state_), id);
  id_ = id;
}

std::shared_ptr<ResidualDataAbstract> FrameResidual::createData(DataCollector* shared) {
  internal::expect_motion(name_, shared);
  auto data = std::make_shared<FrameResidualData>(this, shared);
  lay_out(*data);
  return data;
}

void FrameResidual::lay_out(ResidualDataAbstract& data) const {
  auto& d = static_cast<FrameResidualData&>(data);
  d.frame = &internal::body_frame(name_, internal::multibody(state_), id_);
  d.chain = dof_chain(d.model(), d.frame->joint);
  d.blocks.clear();
  if (d.chain.empty()) return;
  const int q = d.shared->scene.robots[d.frame->robot].idx_v, v = static_cast<int>(state_->get_nv()) + q;
  std::vector<int> columns;
  for (int i : d.chain) columns.push_back(q + i);
  if (get_v_dependent())
    for (int i : d.chain) columns.push_back(v + i);
  d.blocks.emplace_back(internal::range(0, static_cast<int>(nr_)), columns, std::vector<int>{});
}

bool FrameResidual::fits(const ResidualDataAbstract& data) const {
  const auto* d = dynamic_cast<const FrameResidualData*>(&data);
  require(d, name_, "the data were created by another residual, data of this residual's createData() are expected");
  return d->frame == &internal::multibody(state_).get_model()->frames[id_];
}

void FrameResidual::print(std::ostream& os) const {
  os << name_ << " {frame=" << internal::multibody(state_).get_model()->frames[id_].name << "}";
}

void ResidualModelFramePlacement::evaluate(ResidualDataAbstract& data, const ConstVectorRef&,
                                           const ConstVectorRef&) const {
  data.r = log6<double>(reference_.inverse() * internal::own<FrameResidualData>(data).oMf());
}

void ResidualModelFramePlacement::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                              const ConstVectorRef&) const {
  auto& d = internal::own<FrameResidualData>(data);
  const Mat6<double> J = Jlog6<double>(d.r);
  const SE3<double> M = d.in_tree();
  for (std::size_t k = 0; k < d.chain.size(); ++k)
    d.blocks[0].Rx.col(k).noalias() = J * M.act_inverse(d.kin().J.col(d.chain[k]));
}

void ResidualModelFrameTranslation::evaluate(ResidualDataAbstract& data, const ConstVectorRef&,
                                             const ConstVectorRef&) const {
  data.r = internal::own<FrameResidualData>(data).oMf().p - reference_;
}

void ResidualModelFrameTranslation::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                                const ConstVectorRef&) const {
  auto& d = internal::own<FrameResidualData>(data);
  const Eigen::Vector3d p = d.in_tree().p;
  for (std::size_t k = 0; k < d.chain.size(); ++k)
    d.blocks[0].Rx.col(k) = at_point(p, d.kin().J.col(d.chain[k])).head<3>();
}

void ResidualModelFrameRotation::evaluate(ResidualDataAbstract& data, const ConstVectorRef&,
                                          const ConstVectorRef&) const {
  data.r = log3<double>(reference_.transpose() * internal::own<FrameResidualData>(data).oMf().R);
}

void ResidualModelFrameRotation::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                             const ConstVectorRef&) const {
  auto& d = internal::own<FrameResidualData>(data);
  Vec6<double> xi = Vec6<double>::Zero();
  xi.tail<3>() = d.r;
  const Eigen::Matrix3d J = Jlog6<double>(xi).bottomRightCorner<3, 3>() * d.in_tree().R.transpose();
  for (std::size_t k = 0; k < d.chain.size(); ++k)
    d.blocks[0].Rx.col(k).noalias() = J * d.kin().J.col(d.chain[k]).tail<3>();
}

void ResidualModelFrameVelocity::evaluate(ResidualDataAbstract& data, const ConstVectorRef&,
                                          const ConstVectorRef&) const {
  const auto& d = internal::own<FrameResidualData>(data);
  const Vec6<double> v = frame_velocity<double>(d.kin(), d.base(), d.frame->joint, d.frame->placement, type_);
  data.r = v - reference_;
}

// In the tree frame, with S = S_i, the body's velocity v, and the velocity v_p of the parent of joint i:
//   dv/dq_i = v_p x S - v x S = S x v - S x v_p. In the frame's own axes S x v cancels, because they also move with S.
void ResidualModelFrameVelocity::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                             const ConstVectorRef&) const {
  auto& d = internal::own<FrameResidualData>(data);
  const Kinematics<double>& kin = d.kin();
  const Model& model = d.model();
  const SE3<double> M = d.in_tree();
  const Vec6<double> v = kin.v[d.frame->joint], v_here = at_point(M.p, v);
  const Eigen::Index n = d.chain.size();
  RowMajorMatrix& Rx = d.blocks[0].Rx;
  for (Eigen::Index k = 0; k < n; ++k) {
    const int i = d.chain[k], parent = model.joints[model.dof_joint[i]].parent;
    const Vec6<double> S = kin.J.col(i);
    Vec6<double> dq = Vec6<double>::Zero();
    if (parent >= 0) dq = cross_motion(kin.v[parent], S);
    switch (type_) {
      case ReferenceFrame::kLocal:
        Rx.col(k) = M.act_inverse(dq);
        Rx.col(n + k) = M.act_inverse(S);
        break;
      case ReferenceFrame::kLocalWorldAligned: {
        const Eigen::Vector3d w = S.tail<3>();
        dq = at_point(M.p, dq);
        dq.head<3>() += w.cross(v_here.head<3>());
        dq.tail<3>() += w.cross(v_here.tail<3>());
        Rx.col(k) = dq;
        Rx.col(n + k) = at_point(M.p, S);
        break;
      }
      case ReferenceFrame::kWorld:
        Rx.col(k) = at_point(-kin.origin(d.frame->joint), dq - cross_motion(v, S));
        Rx.col(n + k) = at_point(-kin.origin(d.frame->joint), S);
        break;
    }
  }
}

}  // namespace manycontact
