#include "ranks.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace manycontact::cli {

namespace {

constexpr double kMostWork = 2e10;   // multiplications of one rank
constexpr double kSamePoint = 1e-9;  // relative to the extent of the points [m]

// Which columns of Jt depend on those before them. Gram-Schmidt, twice.
std::vector<char> dependent_columns(const Eigen::MatrixXd& Jt) {
  std::vector<char> dependent(static_cast<std::size_t>(Jt.cols()), 0);
  if (Jt.cols() == 0) return dependent;
  const double smallest = kRankTolerance * Jt.colwise().norm().maxCoeff();
  Eigen::MatrixXd Q(Jt.rows(), std::min(Jt.rows(), Jt.cols()));
  Eigen::Index rank = 0;
  for (Eigen::Index j = 0; j < Jt.cols(); ++j) {
    Eigen::VectorXd w = Jt.col(j);
    for (int pass = 0; pass < 2; ++pass) w -= Q.leftCols(rank) * (Q.leftCols(rank).transpose() * w).eval();
    const double norm = w.norm();
    if (norm > smallest && rank < Q.cols())
      Q.col(rank++) = w / norm;
    else
      dependent[static_cast<std::size_t>(j)] = 1;
  }
  return dependent;
}

int rank_of(const Eigen::MatrixXd& Jt) {
  if (Jt.size() == 0) return 0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(kRankTolerance);
  qr.compute(Jt);
  return static_cast<int>(qr.rank());
}

// J^T of some contacts of an island (positions in it), of the columns they act on only.
Eigen::MatrixXd transposed(const IslandData& d, const SceneData& data, const std::vector<int>& positions) {
  std::map<int, int> column;  // of the island -> of the result
  int rows = 0;
  for (int c : positions) {
    for (int k : d.support.columns[c]) column.emplace(k, 0);
    rows += static_cast<int>(data.contacts[d.island.contacts[c]].J.rows());
  }
  int n = 0;
  for (auto& [from, to] : column) to = n++;
  Eigen::MatrixXd Jt = Eigen::MatrixXd::Zero(n, rows);
  int row = 0;
  for (int c : positions) {
    const Eigen::MatrixXd& J = data.contacts[d.island.contacts[c]].J;
    for (Eigen::Index k = 0; k < J.cols(); ++k)
      Jt.row(column[d.support.columns[c][static_cast<std::size_t>(k)]]).segment(row, J.rows()) = J.col(k).transpose();
    row += static_cast<int>(J.rows());
  }
  return Jt;
}

// Positions in the island of the contacts between each two bodies.
std::map<std::pair<Body, Body>, std::vector<int>> sort_by_bodies(const Scene& scene, const Island& island) {
  std::map<std::pair<Body, Body>, std::vector<int>> sorted;
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    const auto [low, high] = std::minmax({body_of(contact.A), body_of(contact.B)});
    sorted[{low, high}].push_back(static_cast<int>(c));
  }
  return sorted;
}

// The points on body A, one per contact; empty when some contact has its frame A on the other body.
std::vector<Vec3<double>> points_on(const Scene& scene, const BodyPair& pair) {
  std::vector<Vec3<double>> points;
  for (int c : pair.contacts) {
    if (body_of(scene.contacts[c].A) != pair.A) return {};
    points.push_back(scene.contacts[c].A.placement.p);
  }
  return points;
}

// 0: one point, 1: on a line, 2: neither.
int spread(const std::vector<Vec3<double>>& points) {
  Vec3<double> direction = Vec3<double>::Zero();
  for (const Vec3<double>& p : points)
    if ((p - points[0]).norm() > direction.norm()) direction = p - points[0];
  double scale = 1;
  for (const Vec3<double>& p : points) scale = std::max(scale, p.norm());
  const double length = direction.norm();
  if (length <= kSamePoint * scale) return 0;
  for (const Vec3<double>& p : points)
    if ((p - points[0]).cross(direction / length).norm() > kSamePoint * scale) return 2;
  return 1;
}

Holds what_holds(const Scene& scene, const IslandData& d, const SceneData& data, const std::vector<int>& positions,
                 BodyPair& pair) {
  if (pair.rank == pair.rows) return Holds::kEach;
  for (int c : positions) {
    if (positions.size() == 1 || rank_of(transposed(d, data, {c})) < pair.rank) continue;
    pair.alone = d.island.contacts[c];
    return Holds::kOneContact;
  }
  if (pair.rank == 6 && pair.rows > 6) return Holds::kSixD;
  const auto all_of = [&](auto&& test) {
    return std::all_of(pair.contacts.begin(), pair.contacts.end(), [&](int c) { return test(scene.contacts[c].type); });
  };
  const std::vector<Vec3<double>> points = points_on(scene, pair);
  if (points.empty()) return Holds::kFewerRows;
  if (pair.rank == 3 && pair.rows > 3 && all_of([](ContactType t) { return t != ContactType::k6D; }) &&
      spread(points) == 0)
    return Holds::kThreeD;
  if (pair.rank == 5 && all_of([](ContactType t) { return t == ContactType::k3D; }) && spread(points) == 1)
    return Holds::kLine;
  return Holds::kFewerRows;
}

BodyPair examine(const Scene& scene, const SceneData& data, const IslandData& d, const std::vector<int>& positions) {
  BodyPair pair;
  const Contact& first = scene.contacts[d.island.contacts[positions[0]]];
  const bool turned = body_of(first.A).joint < 0;  // the moving body goes first
  pair.A = body_of(turned ? first.B : first.A);
  pair.B = body_of(turned ? first.A : first.B);
  pair.point_A = pair.point_B = Vec3<double>::Zero();
  for (int position : positions) {
    const Contact& contact = scene.contacts[d.island.contacts[position]];
    const bool same = body_of(contact.A) == pair.A;
    pair.point_A += (same ? contact.A : contact.B).placement.p / double(positions.size());
    pair.point_B += (same ? contact.B : contact.A).placement.p / double(positions.size());
    pair.contacts.push_back(d.island.contacts[position]);
    pair.rows += contact.rows();
  }
  pair.rank = rank_of(transposed(d, data, positions));
  pair.holds = what_holds(scene, d, data, positions, pair);
  return pair;
}

// The lightest type at the contact's own frame that has its rank: rows k, or x and z, or the first three.
std::string lightest(const Contact& contact, const Eigen::MatrixXd& J, int rank) {
  if (contact.type != ContactType::k3D && contact.type != ContactType::k6D) return "";
  const char* along[] = {"1d along x", "1d along y", "1d along z"};
  Eigen::Index k = 0;
  if (rank == 1 && J.topRows(3).rowwise().norm().maxCoeff(&k) > kRankTolerance * J.rowwise().norm().maxCoeff())
    return along[k];
  Eigen::MatrixXd plane(2, J.cols());
  plane << J.row(0), J.row(2);
  if (rank == 2 && rank_of(plane.transpose()) == rank) return "2d (x and z)";
  if (contact.type == ContactType::k6D && rank <= 3 && rank_of(J.topRows(3).transpose()) == rank) return "3d";
  return "";
}

}  // namespace

std::vector<long> IslandRanks::key() const {
  std::vector<long> key{known, rank};
  key.insert(key.end(), redundant.begin(), redundant.end());
  for (const BodyPair& p : pairs)
    key.insert(key.end(), {p.rank, static_cast<long>(p.holds),
                           std::find(p.contacts.begin(), p.contacts.end(), p.alone) - p.contacts.begin()});
  for (const Lighter& l : lighter) key.push_back(l.rank);
  return key;
}

IslandRanks find_ranks(const Scene& scene, const SceneData& data, const IslandData& d) {
  IslandRanks out;
  for (const auto& [bodies, positions] : sort_by_bodies(scene, d.island))
    out.pairs.push_back(examine(scene, data, d, positions));
  std::sort(out.pairs.begin(), out.pairs.end(),
            [](const BodyPair& x, const BodyPair& y) { return x.contacts[0] < y.contacts[0]; });
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const int c = d.island.contacts[k];
    const int rank = rank_of(transposed(d, data, {static_cast<int>(k)}));
    if (rank < scene.contacts[c].rows())
      out.lighter.push_back({c, rank, lightest(scene.contacts[c], data.contacts[c].J, rank)});
  }
  const double nv = d.island.nv, nc = d.island.nc;
  if (nv * nc * nc > kMostWork) return out;
  std::vector<int> all(d.island.contacts.size());
  std::iota(all.begin(), all.end(), 0);
  const Eigen::MatrixXd Jt = transposed(d, data, all);
  out.known = true;
  out.rank = rank_of(Jt);
  out.redundant = dependent_columns(Jt);
  return out;
}

}  // namespace manycontact::cli
