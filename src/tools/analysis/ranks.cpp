#include "manycontact/analysis/ranks.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <stdexcept>

#include "at_rest.hpp"
#include "manycontact/analysis/near_dependent.hpp"
#include "manycontact/analysis/text.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/sparse/decompositions.hpp"

namespace manycontact {

namespace {

constexpr double kMostWork = 3e9;    // largest nv nc^2 of a dense rank computation, which takes a second or two
constexpr int kMostThresholds = 4;   // most trial values of the threshold RowRemainders::dependent
constexpr double kSamePoint = 1e-9;  // points coincide if closer than this times the larger of 1 m and the largest |p|

struct Examined {
  const Scene& scene;
  const SceneData& data;
  const Island& island;
  const IslandSupport& support;

  const Contact& contact(int position) const { return scene.contacts[island.contacts[position]]; }
  const ContactData<double>& numbers(int position) const {
    return contact_data(scene, data, island.contacts[position]);
  }
  /// Returns the positions of all contacts in the island, or nothing if the island is too deep to store J explicitly.
  std::vector<int> all() const {
    std::vector<int> out(island.contacts.size());
    std::iota(out.begin(), out.end(), 0);
    const bool too_deep =
        std::ranges::any_of(out, [this](int k) { return numbers(k).J.size() == 0 && contact(k).rows() > 0; });
    return too_deep ? std::vector<int>() : out;
  }
};

// Returns J^T of some contacts of an island, restricted to the coordinates that they act on. Each row of J is divided
// by its scale, so that remainders up to tolerance::kRank count as zero.
Eigen::MatrixXd rows_of(const Examined& x, const std::vector<int>& positions) {
  std::map<int, int> column;  // key: column of the island; value: column of the result
  int rows = 0;
  for (int c : positions) {
    for (int k : x.support.columns[c]) column.emplace(k, 0);
    rows += x.contact(c).rows();
  }
  int n = 0;
  for (auto& [from, to] : column) to = n++;
  Eigen::MatrixXd Jt = Eigen::MatrixXd::Zero(n, rows);
  int row = 0;
  for (int c : positions) {
    const Eigen::MatrixXd& J = x.numbers(c).J;
    for (Eigen::Index k = 0; k < J.cols(); ++k)
      Jt.row(column[x.support.columns[c][k]]).segment(row, J.rows()) = J.col(k).transpose();
    for (int k = 0; k < J.rows(); ++k, ++row) {
      const double size = std::max(row_size(x.contact(c), x.numbers(c), k), Jt.col(row).norm());
      if (size > 0) Jt.col(row) /= size;
    }
  }
  return Jt;
}

// Returns the norm of each column of J^T after projection on the complement of the earlier independent columns
// (Gram-Schmidt). A column is independent if this norm is above `dependent`.
std::vector<double> remainders_of(const Eigen::MatrixXd& Jt, double dependent) {
  std::vector<double> left;
  Eigen::MatrixXd Q(Jt.rows(), std::min(Jt.rows(), Jt.cols()));
  Eigen::Index rank = 0;
  for (Eigen::Index j = 0; j < Jt.cols(); ++j) {
    Eigen::VectorXd w = Jt.col(j);
    for (int pass = 0; pass < 2; ++pass) w -= Q.leftCols(rank) * (Q.leftCols(rank).transpose() * w).eval();
    const double norm = rank < Q.cols() ? w.norm() : 0;
    if (norm > dependent) Q.col(rank++) = w / norm;
    left.push_back(norm);
  }
  return left;
}

// Returns whether the last solve determined the rank of an island: it must be undamped, and not failed.
bool has_rank(const Scene& scene, const IslandReport& report) {
  return scene.damping == 0 && report.status != Status::kFailed;
}

// Returns the remainders of an island's rows. The solver tests pivots of K instead, and may retain a row below
// tolerance::kRank or drop one above it. `dependent` is chosen such that as many rows are independent as in the solver.
internal::RowRemainders remainders_of(const Scene& scene, const IslandReport& report, const Eigen::MatrixXd& Jt) {
  internal::RowRemainders out;
  out.left = remainders_of(Jt, out.dependent);
  for (int k = 0; has_rank(scene, report) && k < kMostThresholds; ++k) {
    std::vector<double> largest = out.left;
    std::ranges::sort(largest, std::greater<>());
    const auto count = [&](double dependent) {
      return static_cast<std::size_t>(std::ranges::count_if(largest, [&](double x) { return x > dependent; }));
    };
    const auto rank = static_cast<std::size_t>(report.rank);
    if (count(out.dependent) == rank || rank > largest.size()) break;
    const double next = rank < largest.size() ? largest[rank] : 0, last = rank > 0 ? largest[rank - 1] : 1;
    if (!(last > next)) break;
    out.dependent = count(out.dependent) < rank ? std::max(next, last / 2) : next;
    out.left = remainders_of(Jt, out.dependent);
  }
  return out;
}

// Returns the rank of J^T: the number of diagonal entries above `least` in a QR factor with column pivoting.
int rank_of(const Eigen::MatrixXd& Jt, double least) {
  if (Jt.size() == 0) return 0;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(Jt);
  return static_cast<int>((qr.matrixR().diagonal().array().abs() > least).count());
}

// Returns for each pair of bodies the contacts between them, as positions in island.contacts.
std::map<std::pair<Body, Body>, std::vector<int>> sort_by_bodies(const Scene& scene, const Island& island) {
  std::map<std::pair<Body, Body>, std::vector<int>> sorted;
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    const auto [low, high] = std::minmax({body_of(contact.A), body_of(contact.B)});
    sorted[{low, high}].push_back(static_cast<int>(c));
  }
  return sorted;
}

// Returns the contact points on body A, one per contact, or nothing if the frame A of a contact is on body B.
std::vector<Vec3<double>> points_on(const Scene& scene, const BodyPair& pair) {
  std::vector<Vec3<double>> points;
  for (int c : pair.contacts) {
    if (body_of(scene.contacts[c].A) != pair.A) return {};
    points.push_back(scene.contacts[c].A.placement.p);
  }
  return points;
}

int spread(const std::vector<Vec3<double>>& points) {  // 0: the points coincide; 1: they are on a line; 2: otherwise
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

Holds what_holds(const Examined& x, const std::vector<int>& positions, double least, BodyPair& pair) {
  if (pair.rank == pair.rows) return Holds::kEach;
  for (int c : positions) {
    if (positions.size() == 1 || rank_of(rows_of(x, {c}), least) < pair.rank) continue;
    pair.alone = x.island.contacts[c];
    return Holds::kOneContact;
  }
  if (pair.rank == 6 && pair.rows > 6) return Holds::kSixD;
  const auto all_of = [&](auto&& test) {
    return std::ranges::all_of(pair.contacts, [&](int c) { return test(x.scene.contacts[c].type); });
  };
  const std::vector<Vec3<double>> points = points_on(x.scene, pair);
  if (points.empty()) return Holds::kFewerRows;
  if (pair.rank == 3 && pair.rows > 3 && all_of([](ContactType t) { return t != ContactType::k6D; }) &&
      spread(points) == 0)
    return Holds::kThreeD;
  if (pair.rank == 5 && all_of([](ContactType t) { return t == ContactType::k3D; }) && spread(points) == 1)
    return Holds::kLine;
  return Holds::kFewerRows;
}

BodyPair examine(const Examined& x, const std::vector<int>& positions, double least) {
  BodyPair pair;
  const Contact& first = x.contact(positions[0]);
  const bool turned = body_of(first.A).joint < 0;  // pair.A must be a body that moves
  pair.A = body_of(turned ? first.B : first.A);
  pair.B = body_of(turned ? first.A : first.B);
  std::vector<const Attachment*> on_A, on_B;
  for (int position : positions) {
    const Contact& contact = x.contact(position);
    const bool same = body_of(contact.A) == pair.A;
    on_A.push_back(same ? &contact.A : &contact.B);
    on_B.push_back(same ? &contact.B : &contact.A);
    pair.contacts.push_back(x.island.contacts[position]);
    pair.rows += contact.rows();
  }
  pair.place_A = place_name(x.scene, on_A);
  pair.place_B = place_name(x.scene, on_B);
  pair.rank = rank_of(rows_of(x, positions), least);
  pair.holds = what_holds(x, positions, least, pair);
  return pair;
}

// Returns the contact type that has the fewest rows among those with the given rank at the contact's frame. least:
// smallest remainder of an independent row.
std::string lightest(const Contact& contact, const Eigen::MatrixXd& Jt, int rank, double least) {
  if (contact.rows() < 3) return "";
  const auto rank_of_columns = [&](const std::vector<int>& k) { return rank_of(Jt(Eigen::all, k), least); };
  const char* along[] = {"1d along x", "1d along y", "1d along z"};
  Eigen::Index k = 0;
  if (rank == 1 && Jt.leftCols(3).colwise().norm().maxCoeff(&k) > least) return along[k];
  if (rank == 2 && rank_of_columns({0, 2}) == rank) return "2d (x and z)";
  if (rank == 2 && rank_of_columns({0, 1}) == rank) return "2d, rotated so that the new y is along the present z,";
  if (rank == 2 && rank_of_columns({1, 2}) == rank) return "2d, rotated so that the new y is along the present x,";
  if (holds_turning(contact.type) && rank <= 3 && rank_of_columns({0, 1, 2}) == rank) return "3d";
  return "";
}

// Returns the name of a contact of which only `rows` are kept.
std::string kept_as(const Contact& contact, const std::vector<int>& rows) {
  std::vector<std::string> names;
  for (int r : rows) names.push_back(row_name(contact, r));
  const bool linear = contact.type == ContactType::k3D || contact.type == ContactType::k6D;
  if (linear && rows.size() == 1 && rows[0] < 3) return contact.name + " as 1d along " + "xyz"[rows[0]];
  if (contact.type == ContactType::k2D) return contact.name + " as 1d along " + (rows[0] == 0 ? "x" : "z");
  if (linear && rows == std::vector<int>{0, 2}) return contact.name + " as 2d (x and z)";
  if (linear && rows == std::vector<int>{0, 1, 2}) return contact.name + " as 3d";
  return text::join(names);
}

// Returns whether all dependent rows are between the same two bodies; the solver finds these without testing pivots.
bool depends_in_pairs_alone(const SceneData& data, std::size_t number) {
  const SceneData& solved = data_solved(data);
  const IslandReport& report = solved.report.islands[number];
  return &solved != &data && report.status <= Status::kRedundant && report.rank == report.nc;
}

// Sets known, rank and redundant. Returns the remainder above which a row counts as independent.
double rank_all(const Examined& x, std::size_t number, const std::vector<int>& all, IslandRanks& out) {
  const IslandReport& report = x.data.report.islands[number];
  if (depends_in_pairs_alone(x.data, number)) {
    out.known = true;
    out.rank = report.rank;
    internal::each_row(x.scene, x.data, number, [&](int row) {
      out.redundant.push_back(std::ranges::binary_search(report.dependent_rows, row));
    });
    return tolerance::kRank;
  }
  const double nv = x.island.nv, nc = x.island.nc;
  if (nv * nc * nc > kMostWork) return tolerance::kRank;
  const Eigen::MatrixXd rows = rows_of(x, all);
  const internal::RowRemainders remainders = remainders_of(x.scene, report, rows);
  out.known = true;
  out.rank = has_rank(x.scene, report) ? report.rank : rank_of(rows, tolerance::kRank);
  for (const double left : remainders.left) out.redundant.push_back(!(left > remainders.dependent));
  return remainders.dependent;
}

}  // namespace

IslandRanks find_ranks(const Scene& scene, const SceneData& data, std::size_t number) {
  if (data.serial == 0) throw std::logic_error("find_ranks: there is no solution, call solve first");
  const Island& island = solved_island(data, number);
  const Examined x{scene, data, island, island_support_of(scene, data, number)};
  IslandRanks out;
  const std::vector<int> all = x.all();
  if (all.size() != island.contacts.size()) return out;
  const double least = rank_all(x, number, all, out);
  for (const auto& [bodies, positions] : sort_by_bodies(scene, island))
    out.pairs.push_back(examine(x, positions, least));
  std::ranges::sort(out.pairs, {}, [](const BodyPair& p) { return p.contacts[0]; });
  for (int k : all) {
    const Eigen::MatrixXd rows = rows_of(x, {k});
    const int rank = rank_of(rows, least), plain = std::min(rank, rank_of(rows, kOnlyJust));
    if (rank < x.contact(k).rows() || plain < rank)
      out.lighter.push_back({island.contacts[k], plain, lightest(x.contact(k), rows, plain, kOnlyJust), rank - plain});
  }
  return out;
}

internal::RowRemainders internal::row_remainders(const Scene& scene, const SceneData& data, std::size_t number) {
  const Island& island = solved_island(data, number);
  const Examined x{scene, data, island, island_support_of(scene, data, number)};
  const std::vector<int> all = x.all();
  if (all.size() != island.contacts.size()) return {};
  return remainders_of(scene, data.report.islands[number], rows_of(x, all));
}

RowSelection select_rows(const Scene& scene, const Island& island, const IslandRanks& ranks) {
  RowSelection s;
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[island.contacts[c]];
    std::vector<int> rows;
    for (int i = 0; i < contact.rows(); ++i)
      if (ranks.redundant[island.row_offset[c] + i])
        s.redundant.push_back(row_name(contact, i));
      else
        rows.push_back(i);
    if (rows.empty())
      s.dropped.push_back(contact.name);
    else
      s.kept.push_back(static_cast<int>(rows.size()) == contact.rows() ? contact.name : kept_as(contact, rows));
  }
  return s;
}

}  // namespace manycontact
