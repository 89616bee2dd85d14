#pragma once
// The terms of robots side by side in the lanes of S = Pack<W>, and of contacts alike: dynamics/evaluate.cpp for all
// lanes at once, from and into the arrays of each.

#include <limits>

#include "../robot_quantities.hpp"
#include "lanes.hpp"

namespace manycontact::lanes {

/// to[k] lane l = from[l][k] for k < count. Lanes beyond those given repeat the last one.
template <int W>
[[gnu::noinline]] void load_arrays(std::span<const double* const> from, int count, Pack<W>* to) {
  const auto lane = [&](int l) { return from[std::min<std::size_t>(l, from.size() - 1)]; };
  int k = 0;
  for (; k + W <= count; k += W) {
    for (int l = 0; l < W; ++l) to[k + l] = Pack<W>::load(lane(l) + k);
    transpose(to + k);
  }
  for (int l = 0; l < W; ++l)
    for (int i = k; i < count; ++i) to[i].set(l, lane(l)[i]);
}

/// to[l][k] = from[k] lane l for k < count.
template <int W>
[[gnu::noinline]] void store_arrays(const Pack<W>* from, int count, std::span<double* const> to) {
  int k = 0;
  for (; k + W <= count; k += W) {
    Pack<W> block[W];
    for (int i = 0; i < W; ++i) block[i] = from[k + i];
    transpose(block);
    for (std::size_t l = 0; l < to.size(); ++l) block[l].store(to[l] + k);
  }
  for (std::size_t l = 0; l < to.size(); ++l)
    for (int i = k; i < count; ++i) to[l][i] = from[i][static_cast<int>(l)];
}

/// One of the pointers that each of `items` has, at(item), side by side.
template <class P, class Item, class At>
std::span<P const> side_by_side(std::span<Item> items, P (&memory)[8], At&& at) {
  for (std::size_t l = 0; l < items.size(); ++l) memory[l] = at(items[l]);
  return {memory, items.size()};
}

/// Per lane, the largest entry of the row of J whose entries are the smallest.
template <class S>
S smallest_row(const ContactData<S>& rows) {
  S smallest(std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < rows.J.rows(); ++i) {
    S size(0);
    for (Eigen::Index j = 0; j < rows.J.cols(); ++j) size = larger(abs(rows.J(i, j)), size);
    smallest = -larger(-size, -smallest);
  }
  return smallest;
}

/// Origin of the tree frame that a joint's body is in.
template <class S>
const WorldPoint<S>& origin_at(const Kinematics<S>& kin, int joint) {
  return kin.origins[kin.tree_of[joint]];
}
template <class S>
S* origin_numbers(Kinematics<S>& kin, int joint) {
  return kin.origins[kin.tree_of[joint]].p.data();
}

/// Rows of a contact of a robot with itself, or with the world, where B stands at in_world.
template <class S>
void rows_on_one_robot(const Vec3<double>& gravity, const Contact& contact, const ContactSupport& support,
                       const Kinematics<S>& kin, const SE3<S>& in_world, ContactData<S>& rows) {
  const SE3<S> aMA = kin.oMi[contact.A.joint] * contact.A.placement.cast<S>();
  if (contact.B.robot < 0)
    contact_rows_with_world<S>(gravity, contact, support, kin, aMA, origin_at<S>(kin, contact.A.joint), in_world, rows);
  else
    contact_rows_between<S>(gravity, contact, support, kin, aMA, &kin,
                            kin.oMi[contact.B.joint] * contact.B.placement.cast<S>(),
                            origin_at<S>(kin, contact.A.joint).seen_from(origin_at<S>(kin, contact.B.joint)), rows);
}

template <class S>
class RobotTermsOf {
 public:
  explicit RobotTermsOf(std::shared_ptr<const Model> model)
      : model_(std::move(model)), q_(model_->nq), v_(model_->nv), robot_(*model_), M_(model_->M_begin[model_->nv]) {}

  void evaluate(const Vec3<double>& gravity, std::span<RobotTerms::Robot> robots) {
    const double* from[8];
    using Robot = RobotTerms::Robot;
    load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.q; }), model_->nq, q_.data());
    load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.v; }), model_->nv, v_.data());
    if (!model_->floating_base)
      load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.base; }), 12, numbers_of(base_));
    internal::evaluate_bias<S>(*model_, base_, q_, v_, gravity, robot_);
    internal::evaluate_inertia<S>(*model_, robot_, nullptr, M_.data());
    store(robots);
  }

 private:
  static S* numbers_of(SE3<S>& M) { return M.R.data(); }

  void store(std::span<RobotTerms::Robot> robots) {
    const RobotTerms::Arrays<S> arrays = RobotTerms::arrays_of(robot_.kin, robot_.Yc, M_.data(), robot_.h.data());
    const RobotTerms::Counts counts = RobotTerms::counts_of(*model_);
    S sum(0);  // finite numbers times zero are zero
    for (std::size_t k = 0; k < arrays.size(); ++k) {
      double* to[8];
      store_arrays(arrays[k], counts[k], side_by_side(robots, to, [k](const auto& r) { return r.out[k]; }));
      for (int i = 0; i < counts[k]; ++i) sum += arrays[k][i] * S(0);
    }
    const auto sound = sum <= S(0);
    for (std::size_t l = 0; l < robots.size(); ++l) robots[l].sound = sound[static_cast<int>(l)];
  }

  std::shared_ptr<const Model> model_;
  VecX<S> q_, v_;
  SE3<S> base_;
  RobotQuantities<S> robot_;
  std::vector<S> M_;
};

template <class S>
class ContactTermsOf {
 public:
  ContactTermsOf(const Scene& scene, const Contact& contact, const ContactSupport& support)
      : support_(support),
        A_(*scene.robots[contact.A.robot].model, support.a),
        B_(*scene.robots[contact.B.robot < 0 ? contact.A.robot : contact.B.robot].model, support.b),
        rows_(contact, support) {}

  void evaluate(const Vec3<double>& gravity, const Contact& contact, std::span<const ContactTerms::Rows> rows) {
    A_.load(rows, contact.A.joint, [](const ContactTerms::Rows& r) -> const ContactTerms::Body& { return r.A; });
    const double* from[8];
    SE3<S> on_A, on_B;
    load_arrays(side_by_side(rows, from, [](const auto& r) { return r.placement_A; }), 12, on_A.R.data());
    load_arrays(side_by_side(rows, from, [](const auto& r) { return r.placement_B; }), 12, on_B.R.data());
    if (contact.B.robot >= 0)
      B_.load(rows, contact.B.joint, [](const ContactTerms::Rows& r) -> const ContactTerms::Body& { return r.B; });
    evaluate_between(gravity, contact, on_A, on_B);
    const ContactTerms::Arrays<S> arrays = ContactTerms::arrays_of(rows_);
    const ContactTerms::Counts counts = ContactTerms::counts_of(contact.rows(), support_.cols());
    for (std::size_t k = 0; k < arrays.size(); ++k) {
      double* to[8];
      store_arrays(arrays[k], counts[k], side_by_side(rows, to, [k](const auto& r) { return r.out[k]; }));
    }
  }

  void evaluate(const Vec3<double>& gravity, std::span<ContactTerms::JoiningRows> rows) {
    using Rows = ContactTerms::JoiningRows;
    const Contact& contact = *rows.front().contact;
    const double* from[8];
    SE3<S> on_A, on_B;
    load_arrays(side_by_side(rows, from, [](const Rows& r) { return r.contact->A.placement.R.data(); }), 12,
                on_A.R.data());
    load_arrays(side_by_side(rows, from, [](const Rows& r) { return r.contact->B.placement.R.data(); }), 12,
                on_B.R.data());
    A_.load_joined(rows, contact.A.joint, [](const Rows& r) { return r.A; });
    B_.load_joined(rows, contact.B.joint, [](const Rows& r) { return r.B; });
    evaluate_between(gravity, contact, on_A, on_B);
    double* to[8];
    const int at_A = static_cast<int>(rows_.J.rows() * support_.a.size());
    store_arrays(rows_.J.data(), at_A, side_by_side(rows, to, [](const Rows& r) { return r.A; }));
    store_arrays(rows_.J.data() + at_A, static_cast<int>(rows_.J.size()) - at_A,
                 side_by_side(rows, to, [](const Rows& r) { return r.B; }));
    store_arrays(rows_.a0.data(), contact.rows(), side_by_side(rows, to, [](const Rows& r) { return r.a0; }));
    const S smallest = smallest_row(rows_), motion = motion_size(contact, rows_);
    for (std::size_t l = 0; l < rows.size(); ++l) {
      const int lane = static_cast<int>(l);
      rows[l].smallest_row = smallest[lane];
      rows[l].motion =
          (holds_turning(contact.type) ? motion : motion_size(*rows[l].contact, rows_))[lane];  // placement
    }
  }

 private:
  // What the rows need of the robot at one end.
  struct End {
    Kinematics<S> kin;
    std::vector<std::pair<int, int>> stretches;  // of coordinates: begin, end

    End(const Model& model, const std::vector<int>& coordinates) : kin(model) {
      for (int i : coordinates) {
        if (stretches.empty() || stretches.back().second != i) stretches.emplace_back(i, i);
        stretches.back().second = i + 1;
      }
    }
    template <class Of>
    void load(std::span<const ContactTerms::Rows> rows, int joint, Of&& end) {
      const double* from[8];
      const auto at = [&](auto array, int offset) {
        return side_by_side(rows, from, [&](const auto& r) { return end(r).*array + offset; });
      };
      using Body = ContactTerms::Body;
      load_arrays(at(&Body::origin, 6 * kin.tree_of[joint]), 6, origin_numbers(kin, joint));
      load_arrays(at(&Body::oMi, 12 * joint), 12, kin.oMi[joint].R.data());
      load_arrays(at(&Body::v, 6 * joint), 6, kin.v[joint].data());
      load_arrays(at(&Body::a, 6 * joint), 6, kin.a[joint].data());
      for (const auto& [begin, stop] : stretches)
        load_arrays(at(&Body::J, 6 * begin), 6 * (stop - begin), kin.J.col(begin).data());
    }
    template <class Of>
    void load_joined(std::span<ContactTerms::JoiningRows> rows, int joint, Of&& end) {
      const double* from[8];
      int next = 0;
      const auto load = [&](int count, S* to) {
        load_arrays(side_by_side(rows, from, [&](const auto& r) { return end(r) + next; }), count, to);
        next += count;
      };
      load(6, origin_numbers(kin, joint));
      load(12, kin.oMi[joint].R.data());
      load(6, kin.v[joint].data());
      load(6, kin.a[joint].data());
      for (const auto& [begin, stop] : stretches) load(6 * (stop - begin), kin.J.col(begin).data());
    }
  };

  // on_A, on_B: the contact's frames on their bodies, or in the world.
  void evaluate_between(const Vec3<double>& gravity, const Contact& contact, const SE3<S>& on_A, const SE3<S>& on_B) {
    const SE3<S> aMA = A_.kin.oMi[contact.A.joint] * on_A;
    const WorldPoint<S>& origin = origin_at(A_.kin, contact.A.joint);
    if (contact.B.robot < 0)
      return contact_rows_with_world<S>(gravity, contact, support_, A_.kin, aMA, origin, on_B, rows_);
    contact_rows_between<S>(gravity, contact, support_, A_.kin, aMA, &B_.kin, B_.kin.oMi[contact.B.joint] * on_B,
                            origin.seen_from(origin_at(B_.kin, contact.B.joint)), rows_);
  }

  ContactSupport support_;
  End A_, B_;
  ContactData<S> rows_;
};

}  // namespace manycontact::lanes
