#include "manycontact/contact/pair_motion.hpp"

#include "spatial/pack_explog.hpp"

namespace manycontact {

namespace {

template <class S>
using OfRows = Eigen::Matrix<S, Eigen::Dynamic, 1, 0, 6, 1>;

// Returns S_m W_m x for contact m of a pair: W_m selects its rows from the motion x, S_m weights them. row: number of
// its first row among the rows of all contacts of the pair.
template <class S>
OfRows<S> weighed_rows(const PairRows& pair, std::size_t m, int row, const Vec6<S>& x) {
  OfRows<S> out = rows_of_member<S>(pair.members[m], x);
  for (int i = 0; i < static_cast<int>(out.size()); ++i) out[i] *= S(pair.unit[row + i]);
  return out;
}

}  // namespace

template <class S>
void take_pair(const Contact& contact, ContactData<S>& data) {
  const PairNumbers<double>& from = *contact.pair->numbers;
  PairNumbers<S>& to = *data.pair;
  to.Q = from.Q.template cast<S>();
  to.R = from.R.template cast<S>();
  to.R_right = from.R_right.template cast<S>();
  to.terms = from.terms.template cast<S>();
  for (std::size_t m = 0; m < from.A.size(); ++m) {
    to.A[m] = from.A[m].template cast<S>();
    data.pair_B[m] = contact.pair->B[m].template cast<S>();
  }
}

namespace {

template <class S>
S largest_in(const Vec3<S>& x) {
  using std::abs;
  return larger(larger(S(abs(x[0])), S(abs(x[1]))), S(abs(x[2])));
}

// Computes the last two numbers of ContactData::left: the largest terms of the bias accelerations of the members' rows,
// and how far the two bodies are from moving as one body at their reference placement.
template <class S>
void judge_motion(const Contact& c, ContactData<S>& d) {
  const auto of_both = [&](int at) {
    return larger(largest_in<S>(d.vA.template segment<3>(at)), largest_in<S>(d.vB.template segment<3>(at)));
  };
  S lever = largest_in<S>(d.aMA.p) + largest_in<S>(d.bMA.p), reach(0), off(0);
  for (std::size_t m = 0; m < c.pair->members.size(); ++m) {
    const SE3<S>& A = d.pair->A[m];
    reach = larger(largest_in<S>(A.p), reach);
    if (c.pair->members[m].alpha == 0) continue;
    const Vec6<S> error = contact_error<S>(c.pair->members[m], d.pair_B[m].inverse() * (d.G * A));
    off = larger(larger(largest_in<S>(error.template head<3>()), largest_in<S>(error.template tail<3>())), off);
  }
  lever += reach;
  const S w = of_both(3), v = of_both(0) + w * lever, alpha(c.alpha), beta(c.beta);
  const S moving = larger(largest_in<S>(d.nu.template head<3>()), S(lever * largest_in<S>(d.nu.template tail<3>())));
  const Eigen::Index n = d.left.size() - 2;
  d.left[n] = (w + beta) * v + beta * w + w * w + alpha * (lever + largest_in<S>(d.on_B) + S(1));
  d.left[n + 1] = larger(select(v > S(0), S(moving / v), S(0)), select(lever > S(0), S(off / lever), off));
}

}  // namespace

template <class S>
void pair_motion(const Contact& c, ContactData<S>& d) {
  const PairRows& pair = *c.pair;
  const PairNumbers<S>& numbers = *d.pair;
  d.W = numbers.R;
  auto own = d.left.head(numbers.Q.rows());
  int row = 0;
  for (std::size_t m = 0; m < pair.members.size(); ++m) {
    const int rows = pair.members[m].rows();
    own.segment(row, rows) = weighed_rows<S>(pair, m, row, MemberMotion<S>(d, pair, m).drift());
    row += rows;
  }
  const OfRows<S> e = numbers.Q.transpose().lazyProduct(own);
  own -= numbers.Q.lazyProduct(e);
  d.x = d.nudot;
  d.x += numbers.R_right.lazyProduct(e);
  d.a0 = e;
  d.a0 += numbers.R.lazyProduct(d.nudot);
  judge_motion<S>(c, d);
}

template <class S>
PairSlopes<S> pair_slopes(const Contact& c, const ContactData<S>& d) {
  const PairRows& pair = *c.pair;
  const PairNumbers<S>& numbers = *d.pair;
  Eigen::Matrix<S, Eigen::Dynamic, 6, 0, 6, 6> by_motion, by_displacement;
  by_motion.setZero(c.rows(), 6), by_displacement.setZero(c.rows(), 6);
  int row = 0;
  for (std::size_t m = 0; m < pair.members.size(); ++m) {
    const Contact& member = pair.members[m];
    const auto Q = numbers.Q.middleRows(row, member.rows());
    const MemberMotion<S> motion(d, pair, m);
    Mat6<S> log = Mat6<S>::Zero();
    if (member.alpha != 0 && member.type == ContactType::k6D) log = log6_derivative(motion.G);
    for (int j = 0; j < 6; ++j) {
      const Vec6<S> unit = numbers.A[m].act_inverse(Vec6<S>(Vec6<S>::Unit(j)));
      by_motion.col(j) += Q.transpose().lazyProduct(weighed_rows<S>(pair, m, row, motion.by_motion(unit)));
      if (member.alpha == 0) continue;
      by_displacement.col(j) +=
          Q.transpose().lazyProduct(weighed_rows<S>(pair, m, row, motion.by_displacement(unit, log)));
    }
    row += member.rows();
  }
  return {numbers.R_right.lazyProduct(by_motion), numbers.R_right.lazyProduct(by_displacement)};
}

using Scalar = InstantiatedScalar;
template void take_pair<Scalar>(const Contact&, ContactData<Scalar>&);
template void pair_motion<Scalar>(const Contact&, ContactData<Scalar>&);
template PairSlopes<Scalar> pair_slopes<Scalar>(const Contact&, const ContactData<Scalar>&);

}  // namespace manycontact
