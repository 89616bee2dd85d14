#include "manycontact/contact/pair_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>

#include "manycontact/contact/pair_motion.hpp"
#include "manycontact/sparse/decompositions.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace {

int kind_of(int rank, const std::vector<Contact>& members) {
  static std::mutex mutex;
  static std::map<std::vector<int>, int> kinds;
  std::vector<int> key{rank};
  for (const Contact& member : members) key.push_back(static_cast<int>(member.type));
  const std::lock_guard lock(mutex);
  constexpr int kFirst = 16;  // least kind of a pair, above all contact types
  return kinds.try_emplace(std::move(key), kFirst + static_cast<int>(kinds.size())).first->second;
}

// Returns `of` relative to `to`, accurately even if both are far from their body's origin.
SE3<double> seen_from(const SE3<double>& to, const SE3<double>& of) {
  return {to.R.transpose() * of.R, to.R.transpose() * (of.p - to.p)};
}

// Returns the pair's frame A: at the mean of the origins of the contacts' frames A, with the axes of the first of them.
SE3<double> placement_A(const std::vector<Contact>& members) {
  SE3<double> at{members.front().A.placement.R, Vec3<double>::Zero()};
  for (const Contact& member : members) at.p += member.A.placement.p / static_cast<double>(members.size());
  return at;
}

// Returns the pair's frame B'. It has the placement relative to the first contact's B' that the pair's A has relative
// to the first contact's A.
SE3<double> placement_B(const std::vector<Contact>& members, const SE3<double>& A) {
  return members.front().B.placement * seen_from(members.front().A.placement, A);
}

Contact member_of(const Contact& from) {
  Contact out;
  out.type = from.type;
  out.A = {from.A.robot, from.A.joint, from.A.placement};
  out.B = {from.B.robot, from.B.joint, from.B.placement};
  out.axis = from.axis;
  out.alpha = from.alpha, out.beta = from.beta;
  return out;
}

// Returns B, the rows of all contacts of the pair (contact/pair_rows.hpp): a block S_m W_m X_m for each contact m. A:
// placements of the contacts' frames A in the pair's A.
Eigen::MatrixXd rows_of_all(const PairRows& pair, const std::vector<SE3<double>>& A) {
  Eigen::MatrixXd B(static_cast<Eigen::Index>(pair.unit.size()), 6);
  Eigen::Index row = 0;
  for (std::size_t m = 0; m < pair.members.size(); ++m) {
    const int n = pair.members[m].rows();
    for (int j = 0; j < 6; ++j)
      B.block(row, j, n, 1) =
          rows_of_member<double>(pair.members[m], A[m].act_inverse(Vec6<double>(Vec6<double>::Unit(j))));
    for (int i = 0; i < n; ++i, ++row) B.row(row) *= pair.unit[static_cast<std::size_t>(row)];
  }
  return B;
}

int plain_rank(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr) {  // rank of qr; -1: it is doubtful
  int rank = 0;
  const double largest = std::abs(qr.matrixQR()(0, 0));
  for (Eigen::Index k = 0; k < std::min(qr.rows(), qr.cols()); ++k) {
    const double left = std::abs(qr.matrixQR()(k, k)) / largest;
    if (left > tolerance::kPairIndependent)
      ++rank;
    else if (!(left < tolerance::kPairDependent))
      return -1;
  }
  return rank;
}

// Flags the first `rank` rows of B that are each independent of the rows before.
std::vector<char> first_independent(const Eigen::MatrixXd& B, int rank) {
  const double independent = std::sqrt(tolerance::kPairIndependent * tolerance::kPairDependent);
  std::vector<char> out(static_cast<std::size_t>(B.rows()), 0);
  Eigen::Matrix<double, Eigen::Dynamic, 6> basis(rank, 6);
  int found = 0;
  for (Eigen::Index row = 0; row < B.rows() && found < rank; ++row) {
    Eigen::RowVectorXd left = B.row(row);
    for (int pass = 0; pass < 2; ++pass)
      for (int k = 0; k < found; ++k) left -= left.dot(basis.row(k)) * basis.row(k);
    if (!(left.norm() > independent * B.row(row).norm())) continue;
    basis.row(found++) = left.normalized();
    out[static_cast<std::size_t>(row)] = 1;
  }
  return out;
}

// Returns an orthogonal T such that the flagged rows of Q T are lower triangular with a positive diagonal. With Q T in
// place of Q, a row of R depends on rows before it exactly if the flagged row of B does.
Eigen::MatrixXd triangular_basis(const Eigen::MatrixXd& Q, const std::vector<char>& spans) {
  Eigen::MatrixXd rows(Q.cols(), Q.cols());  // the flagged rows of Q, as columns
  Eigen::Index k = 0;
  for (Eigen::Index row = 0; row < Q.rows(); ++row)
    if (spans[static_cast<std::size_t>(row)]) rows.col(k++) = Q.row(row).transpose();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows.leftCols(k));
  Eigen::MatrixXd out = qr.householderQ();
  for (Eigen::Index i = 0; i < k; ++i)
    if (qr.matrixQR()(i, i) < 0) out.col(i) *= -1;
  return out;
}

// Factorizes the rows B of all contacts of a pair as Q R, and sets R_right and terms. Returns false if B's rows are
// independent or their rank is doubtful.
bool factorize(PairRows& pair, PairNumbers<double>& numbers) {
  const Eigen::MatrixXd B = rows_of_all(pair, numbers.A);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(B);
  const int rank = plain_rank(qr);
  if (rank <= 0 || rank == B.rows()) return false;
  if (rank != plain_rank(Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(B.rowwise().normalized()))) return false;
  numbers.Q = qr.householderQ() * Eigen::MatrixXd::Identity(B.rows(), rank);
  pair.spans = first_independent(B, rank);
  numbers.Q *= triangular_basis(numbers.Q, pair.spans);
  numbers.R = numbers.Q.transpose() * B;
  // Angular columns are scaled to the linear ones, so that moment arms do not affect the right inverse's error.
  Vec6<double> unit = Vec6<double>::Ones();
  const double turns = numbers.R.rightCols<3>().norm(), motions = numbers.R.leftCols<3>().norm();
  if (turns > 0 && motions > 0) unit.tail<3>().setConstant(motions / turns);
  const Eigen::MatrixXd scaled = numbers.R * unit.asDiagonal();
  numbers.R_right = unit.asDiagonal() * scaled.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd sizes = numbers.Q.cwiseAbs().transpose() * B.cwiseAbs();
  numbers.terms.resize(rank, 2);
  numbers.terms << sizes.leftCols<3>().rowwise().maxCoeff(), sizes.rightCols<3>().rowwise().maxCoeff();
  return true;
}

// Updates placements of B', and the pair's gains: the largest of its members', used only to scale terms of a0.
void take_changeable(PairRows& rows, Contact& pair) {
  pair.alpha = pair.beta = 0;
  pair.B.placement = placement_B(rows.members, pair.A.placement);
  for (std::size_t m = 0; m < rows.members.size(); ++m) {
    const Contact& member = rows.members[m];
    pair.alpha = std::max(pair.alpha, std::abs(member.alpha));
    pair.beta = std::max(pair.beta, std::abs(member.beta));
    rows.B[m] = seen_from(pair.B.placement, member.B.placement);
  }
}

}  // namespace

Contact pair_of(const Scene& scene, std::span<const int> contacts) {
  const auto rows = std::make_shared<PairRows>();
  rows->contacts.assign(contacts.begin(), contacts.end());
  for (int c : contacts) {
    rows->members.push_back(member_of(scene.contacts[static_cast<std::size_t>(c)]));
    for (int i = 0; i < rows->members.back().rows(); ++i)
      rows->unit.push_back(i < 3 || scene.damping > 0 ? 1 : scene.moment_length);
  }
  Contact pair = member_of(rows->members.front());
  pair.type = ContactType::k6D;
  pair.A.placement = placement_A(rows->members);
  const auto numbers = std::make_shared<PairNumbers<double>>();
  for (const Contact& member : rows->members) numbers->A.push_back(seen_from(pair.A.placement, member.A.placement));
  if (!factorize(*rows, *numbers)) return pair;
  rows->numbers = numbers;
  rows->B.resize(rows->members.size());
  take_changeable(*rows, pair);
  pair.pair_rank = static_cast<int>(numbers->R.rows());
  rows->kind = kind_of(pair.pair_rank, rows->members);
  pair.pair = rows;
  return pair;
}

namespace {

std::array<std::span<const double>, 3> deciding(const PairNumbers<double>& of) {
  static_assert(sizeof(SE3<double>) == 12 * sizeof(double));
  return {std::span(of.R.data(), static_cast<std::size_t>(of.R.size())),
          std::span(of.Q.data(), static_cast<std::size_t>(of.Q.size())),
          std::span(of.A.front().R.data(), 12 * of.A.size())};
}

}  // namespace

bool PairNumbersLess::operator()(const SharedPairNumbers& a, const SharedPairNumbers& b) const {
  const auto of_a = deciding(*a), of_b = deciding(*b);
  for (std::size_t k = 0; k < of_a.size(); ++k)
    if (!std::ranges::equal(of_a[k], of_b[k])) return std::ranges::lexicographical_compare(of_a[k], of_b[k]);
  return false;
}

void refresh_pair(const Scene& scene, PairRows& rows, Contact& pair) {
  bool changed = false;
  for (std::size_t m = 0; m < rows.members.size(); ++m) {
    const Contact& from = scene.contacts[static_cast<std::size_t>(rows.contacts[m])];
    Contact& member = rows.members[m];
    if (member.alpha == from.alpha && member.beta == from.beta && member.B.placement.R == from.B.placement.R &&
        member.B.placement.p == from.B.placement.p)
      continue;
    changed = true;
    member.alpha = from.alpha, member.beta = from.beta;
    member.B.placement = from.B.placement;
  }
  if (changed) take_changeable(rows, pair);
}

}  // namespace manycontact
