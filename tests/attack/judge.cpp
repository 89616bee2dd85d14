#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/simulation/switch.hpp"
#include "reference.hpp"
#include "support/truth.hpp"

namespace manycontact::attack {

namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kNoise = 100;  // allowed multiple of the truth's change by an eps in every number of the input
constexpr int kBlurs = 4;
constexpr double kQuadRounding = 1e-32;  // error of a truth in quadruple precision, times the condition
// Errors that precisions allow: a solution in single is refused beyond the first; one in extended is at most wrong by
// the second, up to the condition.
constexpr double kMostOfSingle = 1e-2, kMostOfExtended = 4 * kEps, kMostCondition = 1e15;

double most(double a, double b) { return a > b || std::isnan(a) ? a : b; }

// Returns |x - truth| in the maximum norm, over some entries.
double distance(std::span<const double> x, const Column& truth, std::size_t first, std::size_t count) {
  double d = 0;
  for (std::size_t k = first; k < first + count; ++k) d = most(static_cast<double>(fabsq(Quad(x[k]) - truth[k])), d);
  return d;
}
double size_of(const Column& x, std::size_t first, std::size_t count) {
  double d = 0;
  for (std::size_t k = first; k < first + count; ++k) d = most(static_cast<double>(fabsq(x[k])), d);
  return d;
}
std::span<const double> span(const Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }
double largest(const Eigen::MatrixXd& x) { return x.size() == 0 ? 0 : x.cwiseAbs().maxCoeff(); }

std::string text(const char* format, auto... values) {
  char line[400];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

// A case, its truths, and their changes when its numbers change.
struct Trial {
  explicit Trial(const Case& given) : c(given), truth(given) {}

  const Case& c;
  Reference truth;
  std::vector<std::unique_ptr<Reference>> blurs;
  std::optional<manycontact::Truth<manycontact::Quad>> read;
  std::optional<bool> constant_rank;             // set by rank_is_constant
  std::map<std::pair<int, int>, Slopes> slopes;  // per rank and number of the direction, the same for every method

  const Slopes& along(int rank, int number, const Direction& direction) {
    const auto [at, is_new] = slopes.try_emplace({rank, number});
    if (is_new) at->second = truth.along(rank, direction);
    return at->second;
  }
  // Returns the truth for the scene of the file.
  const manycontact::Truth<manycontact::Quad>& as_read(const SceneFile& file) {
    const auto quad = [](const Eigen::VectorXd& x) { return x.cast<manycontact::Quad>().eval(); };
    if (!read)
      read = solve_truth<manycontact::Quad>(file.scene, std::vector<char>(file.scene.contacts.size(), 1), quad(file.q),
                                            quad(file.v), quad(file.u));
    return *read;
  }
  void blur() {
    for (int k = 0; blurs.empty() || k < kBlurs; ++k) blurs.push_back(std::make_unique<Reference>(blurred(c, k)));
  }
  // Whether the rank is constant nearby. If not (singular; or mechanisms closed redundantly), no derivative exists.
  bool rank_is_constant() {
    const int rank = truth.ranks().front();
    if (rank == std::min(truth.rows(), truth.nv())) return true;
    if (!constant_rank) {
      Case beside = c;
      std::mt19937 rng(5);
      const auto move = [&rng](double& q, double unit) {
        q += 1e-2 * unit * (0x1p-31 * static_cast<double>(rng()) - 1);
      };
      for (Tree& tree : beside.trees)
        for (const Link& l : tree.links) {
          if (!l.moves()) continue;
          double* const q = tree.q.data() + l.iq;
          if (l.kind != Kind::kFloating) {
            for (int k = 0; k < nq_of(l.kind); ++k) move(q[k], 1);
            continue;
          }
          const double far = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2])});
          for (int k = 0; k < 7; ++k) move(q[k], k < 3 && far > 0 ? far : 1);
          const double n = std::hypot(std::hypot(q[3], q[4]), std::hypot(q[5], q[6]));
          for (int k = 3; k < 7; ++k) q[k] /= n;
        }
      constant_rank = Reference(beside).ranks() == truth.ranks();
    }
    return *constant_rank;
  }
  // Returns the largest change of a (or f) over some entries.
  double noise(int rank, Column Answer::*part, std::size_t first, std::size_t count) {
    if (blurs.empty()) blur();
    const Column& x = truth.at(rank).*part;
    double most_moved = kEps * size_of(x, first, count);
    for (auto& b : blurs) {
      const Answer& other = b->at(rank);
      if (!other.regular) return std::numeric_limits<double>::infinity();
      for (std::size_t k = first; k < first + count; ++k)
        most_moved = most(static_cast<double>(fabsq((other.*part)[k] - x[k])), most_moved);
    }
    return most_moved;
  }
};

constexpr int kKinds = 4;  // kinds of coordinates: q, v, u, and external wrenches

struct Blocks {  // blocks of derivatives
  const Eigen::MatrixXd *a[kKinds], *f[kKinds];
};

struct Probe;

// The solution of one method.
struct Trying {
  Trial& trial;
  const SceneFile& file;
  Options options;
  std::string name;
  Judgement& out;
  SceneData data;

  Trying(Trial& t, const SceneFile& f, Method method, Precision precision, Judgement& o)
      : trial(t), file(f), options{method, {}}, name(to_string(method)), out(o), data(f.scene) {
    options.precision = precision;
    if (precision != Precision::kDouble) name += " in " + to_string(precision);
    data.options = options;
  }

  void find(Fault fault, std::string words) { out.findings.push_back({fault, name, std::move(words)}); }
  bool one_island() const { return data.report.islands.size() == 1; }
  // Whether an island was solved in this precision.
  bool in(Precision precision) const {
    return std::ranges::any_of(data.report.islands, [=](const auto& i) { return i.precision == precision; });
  }

  bool values();
  double excess(const Answer& t) const;
  double allowed(const Answer& t) const;
  void judge_values(const Answer& t);
  void judge_status(const Answer& t);
  void judge_bounds(const Answer& t);
  void judge_condition(const Answer& t);
  void judge_derivatives(const Answer& t);
  std::array<bool, 2> judge_derivative_bounds(const Answer& t, const std::vector<DerivativeBounds>& stated,
                                              const Blocks& blocks, const Probe& p, const Slopes& truth, double floor_a,
                                              double floor_f);
  void judge_products(const Answer& t, const Blocks& blocks, const double* floor_a, const double* floor_f,
                      double bound);
  double derivative_noise(const Answer& t, const Slopes& truth, const Direction& along, bool of_a);
};

double allowed(const Answer& t) { return std::max(1e-12, 100 * kEps * t.condition); }

double Trying::allowed(const Answer& t) const {
  return std::max(in(Precision::kSingle) ? kMostOfSingle : 0, attack::allowed(t));
}

constexpr double kVanishing = 1e-26;  // products of two rounding errors of terms that cancel

// Returns the largest error of a, tree by tree, and of f, relative to the allowed one.
double Trying::excess(const Answer& t) const {
  double worst = 0;
  std::size_t first = 0;
  for (const Tree& tree : trial.c.trees) {
    const double size = size_of(t.a, first, tree.nv);
    const double d = distance(span(data.a), t.a, first, tree.nv);
    worst = most(d == 0 ? 0 : d / size, worst);
    first += tree.nv;
  }
  const double d = distance(span(data.f), t.f, 0, t.f.size());
  return most(d == 0 ? 0 : d / size_of(t.f, 0, t.f.size()), worst) / allowed(t);
}

void Trying::judge_values(const Answer& t) {
  const Report& r = data.report;
  const auto part = [&](const char* name, const Eigen::VectorXd& x, Column Answer::*of, std::size_t first,
                        std::size_t count, double bound) {
    const double d = distance(span(x), t.*of, first, count), size = size_of(t.*of, first, count);
    if (d <= allowed(t) * size) return;
    const double gravity = Vec3<double>(trial.c.gravity.data()).norm();
    if (in(Precision::kSingle) && of == &Answer::a && d <= kMostOfSingle * gravity) return;
    // A vanishing value has the rounding error of the terms that cancel in it.
    const double of_terms =
        kEps * (of == &Answer::a ? std::max(t.terms, trial.truth.free_size())
                                 : std::min(t.condition, 1e4) * trial.truth.load() / trial.truth.largest_J());
    const double noise = std::max(trial.noise(t.rank, of, first, count), of_terms);
    if (d <= kNoise * noise) return;
    if (bound < 1 && d <= bound * largest(x)) return;
    const bool silent = !(bound < 1);
    find(silent ? Fault::kSilent : Fault::kValue,
         text("%s off by %.1e of %.1e, allowed %.1e, noise %.1e, bound %.1e, %s, rank %d of %d, condition %.1e", name,
              d, size, allowed(t), noise, bound, to_string(r.status).c_str(), t.rank, trial.truth.rows(), t.condition));
  };
  std::size_t first = 0;
  for (const Tree& tree : trial.c.trees) {
    part("a", data.a, &Answer::a, first, tree.nv, r.error_acceleration);
    first += tree.nv;
  }
  part("f", data.f, &Answer::f, 0, t.f.size(), r.error_forces);
}

void Trying::judge_status(const Answer& t) {
  const Status status = data.report.status;
  bool agree = true, contradict = false;
  for (const Balance& b : t.balance) {
    const double size = b.moved + b.drift;
    // Between the two limits rounding errors decide, and either status is right. Without loads the whole residual is
    // rounding error of the reference. Rows with a0 = 0 agree: the residual of a in a dropped row is no inconsistency.
    const bool agrees = b.drift == 0 || b.left <= 1e-10 * size || b.left <= 1e-14 * b.terms || b.left <= 1e-25;
    agree = agree && agrees;
    contradict = contradict || (!agrees && b.left > 1e-6 * size && b.left > 1e-9 * b.terms);
  }
  if (!agree && !contradict) return;
  const Status right = contradict                     ? Status::kInconsistent
                       : t.rank == trial.truth.rows() ? Status::kOk
                                                      : Status::kRedundant;
  if (status == right) return;
  std::string left;
  for (const Balance& b : t.balance)
    left += text("; J a + a0 leaves %.1e of %.1e, and of terms of %.1e", b.left, b.moved + b.drift, b.terms);
  find(Fault::kStatus, to_string(status) + ", right is " + to_string(right) + left);
}

void Trying::judge_condition(const Answer& t) {
  const double ratio = data.report.condition / t.condition;
  if (one_island() && trial.truth.ranks().size() == 1 && t.condition > 0 && t.condition < 1e14 &&
      !(ratio > 0.1 && ratio < 10))
    find(Fault::kCondition, text("condition %.2e, right is %.2e", data.report.condition, t.condition));
}

// The scene's indices of an island's accelerations and forces.
struct Places {
  std::vector<std::size_t> a, f;
};
std::vector<Places> places_of(const Scene& scene, const SceneData& data) {
  std::vector<Places> list(data.report.islands.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto add_to = [](std::vector<std::size_t>& to) {
      return [&to](int at, int, int n) {
        for (int k = 0; k < n; ++k) to.push_back(static_cast<std::size_t>(at + k));
      };
    };
    each_velocity_block(scene, solved_island(data, i), add_to(list[i].a));
    each_force_block(scene, data.f_offset, solved_island(data, i), add_to(list[i].f));
  }
  return list;
}

// Bounds include the rounding errors of reading the file's numbers, but not in extended precision. Extended solutions
// are therefore compared with a quadruple-precision solution of the scene as it was read, from the library's own terms.
void Trying::judge_bounds(const Answer& t) {
  if (data.report.islands.size() != island_count(data)) return;  // one system of the whole scene
  const auto& truth = trial.as_read(file);
  const std::vector<Places> places = places_of(file.scene, data);
  const double gravity = std::max(t.terms, trial.truth.free_size()),
               load = trial.truth.load() / trial.truth.largest_J();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const IslandReport& report = data.report.islands[i];
    const bool extended = report.precision == Precision::kExtended;
    if (extended && (!truth.regular[i] || truth.rank[i] != report.rank)) continue;
    if (extended && t.condition > kMostCondition) continue;  // the truth is no more accurate
    const auto part = [&](const char* name, const Eigen::VectorXd& x, const VecX<manycontact::Quad>& of_read,
                          const Column& of_file, const std::vector<std::size_t>& rows, double bound, double terms) {
      double off = 0, size = 0;
      for (std::size_t row : rows) {
        const double error =
            extended ? static_cast<double>(x[row] - of_read[row]) : static_cast<double>(Quad(x[row]) - of_file[row]);
        off = most(std::abs(error), off);
        size = most(std::abs(x[row]), size);
      }
      const double of_truth = kQuadRounding * t.condition * std::max(size, terms);
      const bool last_digits = extended && size > 1e-12 * terms;  // a value that vanishes is judged by its bound
      const auto text_of = [&] {
        return text("%s of island %zu off by %.2e of %.2e, bound %.2e, %s, condition %.1e", name, i, off / size, size,
                    bound, to_string(report.status).c_str(), t.condition);
      };
      if (!extended && off > 0 && bound < 1) out.bound_over_error.push_back(bound * size / off);
      if (off > bound * size + of_truth)
        find(Fault::kBound, text_of());
      else if (last_digits && off > kMostOfExtended * size + of_truth)
        find(Fault::kValue, text_of());
    };
    part("a", data.a, truth.a, t.a, places[i].a, report.error_acceleration, gravity);
    part("f", data.f, truth.f, t.f, places[i].f, report.error_forces, load);
  }
}

// A direction of one kind of coordinate: signs from a seed, or a single coordinate.
struct Probe {
  int kind;
  Eigen::VectorXd x;
};
std::vector<Probe> probes(const std::array<int, kKinds>& sizes) {
  std::vector<Probe> list;
  for (int kind = 0; kind < kKinds; ++kind) {
    const int n = sizes[kind];
    std::mt19937 rng(7 + kind);
    for (int k = 0; k < std::min(n, 3); ++k) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
      if (n <= 3)
        x[k] = 1;
      else
        for (double& e : x) e = rng() % 2 ? 1 : -1;
      list.push_back({kind, x});
    }
  }
  return list;
}

void add(const Case& c, const Probe& p, Direction& d) {
  if (p.kind != 2) {
    (p.kind == 0 ? d.q : p.kind == 1 ? d.v : d.w).assign(p.x.begin(), p.x.end());
    return;
  }
  int first = 0, u = 0;
  for (const Tree& t : c.trees) {
    for (int k = t.free(); k < t.nv; ++k) d.tau[first + k] = p.x[u++];
    first += t.nv;
  }
}
Direction direction_of(const Case& c, const std::vector<Probe>& all) {
  const std::vector<double> none(c.nv(), 0.0);
  Direction d{none, none, none, std::vector<double>(c.wrench_entries(), 0.0)};
  for (const Probe& p : all) add(c, p, d);
  return d;
}

constexpr const char* kNames[2][kKinds] = {{"da_dq", "da_dv", "da_du", "da_dw"},
                                           {"dforces_dq", "dforces_dv", "dforces_du", "dforces_dw"}};
using Bounds = std::array<std::array<double, kKinds>, 2>;
Bounds numbers(const DerivativeBounds& b) {
  return {{{b.da_dq, b.da_dv, b.da_du, b.da_dw}, {b.dforces_dq, b.dforces_dv, b.dforces_du, b.dforces_dw}}};
}

// Returns the change of derivatives along a direction when the case's numbers change; infinity if none exist nearby.
double Trying::derivative_noise(const Answer& t, const Slopes& truth, const Direction& along, bool of_a) {
  if (trial.blurs.empty()) trial.blur();
  const Column& right = of_a ? truth.a : truth.f;
  double noise = 0;
  for (auto& b : trial.blurs) {
    if (!b->at(t.rank).regular) return std::numeric_limits<double>::infinity();
    const Slopes other = b->along(t.rank, along);
    const Column& moved = of_a ? other.a : other.f;
    for (std::size_t k = 0; k < right.size(); ++k) noise = most(static_cast<double>(fabsq(moved[k] - right[k])), noise);
  }
  return noise;
}

// Judges each island relative to its own matrices. Returns whether all of a and of f are within finite bounds.
std::array<bool, 2> Trying::judge_derivative_bounds(const Answer& t, const std::vector<DerivativeBounds>& stated,
                                                    const Blocks& blocks, const Probe& p, const Slopes& truth,
                                                    double floor_a, double floor_f) {
  const std::vector<Places> places = places_of(file.scene, data);
  if (stated.size() != places.size()) return {false, false};  // one system of the whole scene
  std::array<bool, 2> within{true, true};
  const auto part = [&](std::size_t island, int which, const Eigen::MatrixXd& block, const Column& right,
                        double floor) {
    const Eigen::VectorXd x = block * p.x;
    double off = 0, size = 0;
    for (std::size_t row : which == 0 ? places[island].a : places[island].f) {
      off = most(static_cast<double>(fabsq(Quad(x[row]) - right[row])), off);
      size = most(largest(block.row(row)), size);
    }
    const double bound = numbers(stated[island])[which][p.kind] * p.x.lpNorm<1>();
    within[which] = within[which] && bound < 1 && off <= bound * size;
    if (off > bound * size + kVanishing * floor + kQuadRounding * t.condition * std::max(floor, 1.0))
      find(Fault::kBound, text("%s of island %zu off by %.2e of %.2e, bound %.2e, condition %.1e",
                               kNames[which][p.kind], island, off, size, bound, t.condition));
    if (!std::isfinite(bound) && size > 0 && t.condition < 1e10)
      find(Fault::kBound,
           text("%s of island %zu has none, condition %.1e", kNames[which][p.kind], island, t.condition));
  };
  for (std::size_t i = 0; i < stated.size(); ++i) {
    part(i, 0, *blocks.a[p.kind], truth.a, floor_a);
    part(i, 1, *blocks.f[p.kind], truth.f, floor_f);
  }
  return within;
}

void Trying::judge_derivatives(const Answer& t) {
  const Scene& scene = file.scene;
  DerivativeRequest request;
  request.wrenches = true;
  differentiate(scene, data, request);
  const SceneDerivatives d = dense_derivatives(scene, data);
  const Blocks blocks{{&d.da_dq, &d.da_dv, &d.da_du, &d.da_dw},
                      {&d.dforces_dq, &d.dforces_dv, &d.dforces_du, &d.dforces_dw}};
  for (int k = 0; k < kKinds; ++k)
    if (!blocks.a[k]->allFinite() || !blocks.f[k]->allFinite()) {
      if (t.condition < 1e10) find(Fault::kNotFinite, text("derivatives, condition %.1e", t.condition));
      return;
    }
  // A vanishing derivative is judged relative to the terms that cancel in it.
  const double motion = std::max({size_of(t.a, 0, t.a.size()), trial.truth.free_size(), t.terms});
  double speed = 1, free = 0;
  const double J = trial.truth.largest_J();
  for (const Tree& tree : trial.c.trees)
    for (double v : tree.v) speed = std::max(speed, std::abs(v));
  for (int k = 0; k < trial.truth.nv(); ++k) free = std::max(free, 1 / static_cast<double>(trial.truth.M()(k, k)));
  const double force = std::max(size_of(t.f, 0, t.f.size()), 1e-6 * trial.truth.load() / J);
  const double floor_a[kKinds] = {motion, motion / speed, 1e-4 * free, 1e-4 * free},
               floor_f[kKinds] = {force, force / speed, 1e-4 / J, 1e-4};
  const std::vector<DerivativeBounds> stated = estimate_derivative_errors(scene, data);
  const Bounds bounds = numbers(stated.front());
  bool good = true;
  int number = 0;
  for (const Probe& p : probes({scene.nv, scene.nv, scene.nu, trial.c.wrench_entries()})) {
    const Direction along = direction_of(trial.c, {p});
    const Slopes& truth = trial.along(t.rank, ++number, along);
    const std::array<bool, 2> within =
        judge_derivative_bounds(t, stated, blocks, p, truth, floor_a[p.kind], floor_f[p.kind]);
    const auto part = [&](int which, const Eigen::MatrixXd& block, const Column& right, double floor) {
      const Eigen::VectorXd x = block * p.x;
      const double off = distance(span(x), right, 0, right.size()), size = std::max(floor, largest(block));
      const double bound = bounds[which][p.kind] * p.x.lpNorm<1>();
      if (off <= 10 * allowed(t) * size || within[which]) return;
      if (stated.size() == 1 && bound < 1 && off <= bound * largest(block)) return;
      const double noise = std::max(kEps * (which == 0 && p.kind >= 2 ? std::max(size, free) : size),
                                    derivative_noise(t, truth, along, which == 0));
      if (off <= 10 * kNoise * noise) return;
      good = false;
      find(Fault::kDerivative,
           text("%s off by %.1e of %.1e, allowed %.1e, noise %.1e, %s, condition %.1e", kNames[which][p.kind], off,
                size, 10 * allowed(t), noise, to_string(data.report.status).c_str(), t.condition));
    };
    part(0, *blocks.a[p.kind], truth.a, floor_a[p.kind]);
    part(1, *blocks.f[p.kind], truth.f, floor_f[p.kind]);
    if (!good) return;
  }
  // Products are judged with the matrices' stated bounds. A missing bound permits no error unless K is ill-conditioned.
  double bound = 0;
  for (const DerivativeBounds& b : stated)
    for (const auto& of : numbers(b))
      for (double x : of)
        if (std::isfinite(x) || t.condition >= 1e10) bound = std::max(bound, x);
  judge_products(t, blocks, floor_a, floor_f, bound);
}

void Trying::judge_products(const Answer& t, const Blocks& blocks, const double* floor_a, const double* floor_f,
                            double bound) {
  const Scene& scene = file.scene;
  std::mt19937 rng(3);
  const auto signs = [&](Eigen::Index n) {
    Eigen::VectorXd x(n);
    for (double& e : x) e = rng() % 2 ? 1 : -1;
    return x;
  };
  // Each kind has the same weight: a product is one number for all of them.
  std::vector<Probe> x = {{0, signs(scene.nv)}, {1, signs(scene.nv)}, {2, signs(scene.nu)}};
  Eigen::VectorXd da(scene.nv), df(data.f.size()), none(trial.c.wrench_entries());
  x.push_back({3, signs(none.size())});
  jvp(scene, data, x[0].x, x[1].x, x[2].x, x[3].x, da, df);
  Eigen::VectorXd right_a = Eigen::VectorXd::Zero(da.size()), right_f = Eigen::VectorXd::Zero(df.size());
  double size_a = 0, size_f = 0;
  for (int k = 0; k < kKinds; ++k) {
    right_a += *blocks.a[k] * x[k].x, right_f += *blocks.f[k] * x[k].x;
    size_a = std::max({size_a, floor_a[k], largest(*blocks.a[k])});
    size_f = std::max({size_f, floor_f[k], largest(*blocks.f[k])});
  }
  const double tolerance = std::max(20 * allowed(t), bound);
  const auto near = [&](const char* name, const Eigen::VectorXd& got, const Eigen::VectorXd& right, double size) {
    if (right.size() > 0 && !(largest(got - right) <= tolerance * size))
      find(Fault::kProduct, text("%s off by %.1e of %.1e, allowed %.1e, condition %.1e", name, largest(got - right),
                                 size, tolerance, t.condition));
  };
  near("jvp a", da, right_a, size_a), near("jvp f", df, right_f, size_f);
  const Direction along = direction_of(trial.c, x);
  const Slopes& truth = trial.along(t.rank, 0, along);
  const auto near_truth = [&](const char* name, const Eigen::VectorXd& got, const Column& right, double size,
                              bool of_a) {
    const double off = distance(span(got), right, 0, right.size());
    if (off <= tolerance * size || off <= 10 * kNoise * derivative_noise(t, truth, along, of_a)) return;
    find(Fault::kProduct, text("%s off the truth by %.1e of %.1e, allowed %.1e, condition %.1e", name, off, size,
                               tolerance, t.condition));
  };
  near_truth("jvp a", da, truth.a, size_a, true), near_truth("jvp f", df, truth.f, size_f, false);
  const Eigen::VectorXd wa = signs(scene.nv) / size_a, wf = size_f > 0 ? signs(df.size()) / size_f : signs(df.size());
  Eigen::VectorXd w[kKinds] = {Eigen::VectorXd(scene.nv), Eigen::VectorXd(scene.nv), Eigen::VectorXd(scene.nu), none};
  vjp(scene, data, wa, wf, w[0], w[1], w[2], w[3]);
  for (int k = 0; k < kKinds; ++k)
    near("vjp", w[k], blocks.a[k]->transpose() * wa + blocks.f[k]->transpose() * wf, scene.nv + df.size());
  double got = 0, sizes = 0;  // <w, x>, in the truth <[wa; wf], [da; df]>
  for (int k = 0; k < kKinds; ++k) got += w[k].dot(x[k].x), sizes += static_cast<double>(x[k].x.size());
  Quad right = 0;
  for (int k = 0; k < scene.nv; ++k) right += Quad(wa[k]) * truth.a[k];
  for (Eigen::Index k = 0; k < df.size(); ++k) right += Quad(wf[k]) * truth.f[k];
  const double off = static_cast<double>(fabsq(right - Quad(got))),
               size = sizes * static_cast<double>(scene.nv + df.size());
  if (off <= tolerance * size) return;
  const double noise = derivative_noise(t, truth, along, true) * wa.lpNorm<1>() +
                       (df.size() > 0 ? derivative_noise(t, truth, along, false) * wf.lpNorm<1>() : 0);
  if (!(off <= 10 * kNoise * noise))
    find(Fault::kProduct,
         text("vjp off the truth by %.1e of %.1e, allowed %.1e, condition %.1e", off, size, tolerance, t.condition));
}

bool Trying::values() {
  const Scene& scene = file.scene;
  const Report& r = solve(scene, file.q, file.v, file.u, data);
  if (r.status == Status::kRegularised) return false;
  const std::vector<int>& ranks = trial.truth.ranks();
  if (r.status == Status::kFailed) {
    const Answer& t = trial.truth.at(ranks.back());
    if (options.method != Method::kDenseSchur && t.regular && t.condition < 1e10)
      find(Fault::kNoAnswer, text("%s, condition %.1e, rank %d of %d", to_string(r.islands.front().reason).c_str(),
                                  t.condition, t.rank, trial.truth.rows()));
    return false;
  }
  const Answer* best = nullptr;
  double least = 0;
  bool any_regular = false;
  for (int rank : ranks) {
    const Answer& t = trial.truth.at(rank);
    if (!t.regular) continue;
    any_regular = true;
    const double e = excess(t);
    if (rank == r.rank && (!best || best->rank != r.rank || e < least)) best = &t, least = e;
    if (!best) best = &t, least = e;
  }
  if (!any_regular) {
    find(Fault::kSingular, text("%s, largest a %.1e", to_string(r.status).c_str(), largest(data.a)));
    return false;
  }
  if (best->rank != r.rank) {
    find(Fault::kRank, text("rank %d, right is %d of %d", r.rank, best->rank, trial.truth.rows()));
    return false;
  }
  const std::size_t before = out.findings.size();
  judge_status(*best);  // effects on bounds are judged below
  estimate_condition(scene, data);
  estimate_errors(scene, data);
  judge_values(*best);
  judge_condition(*best);
  judge_bounds(*best);
  if (in(Precision::kSingle)) return true;  // derivatives are as accurate as a and f, which are judged
  const bool exact = trial.truth.ranks().size() == 1 && best->condition < 1e13;
  if (exact && out.findings.size() == before && trial.rank_is_constant()) judge_derivatives(*best);
  return true;
}

// Returns the size of the terms of wrenches and springs, which may cancel.
double applied_size(const Case& c) {
  double size = 0;
  for (const ExternalWrench& p : c.wrenches)
    for (const Numbers* x : {&p.force, &p.torque})
      for (double e : *x) size = std::max(size, std::abs(e));
  for (const Spring& s : c.springs) {
    double place = s.length;
    for (const Numbers* x : {&s.offset, &s.place})
      for (double e : *x) place = std::max(place, std::abs(e));
    for (const Tree& t : c.trees)
      for (const Link& l : t.links)
        for (double e : l.xyz) place = std::max(place, std::abs(e));
    size = std::max(size, s.stiffness * place);
  }
  for (const Tree& t : c.trees)
    for (const Link& l : t.links)
      if (l.moves() && l.stiffness != 0) size = std::max(size, l.stiffness * (std::abs(l.rest) + std::abs(t.q[l.iq])));
  return size;
}

void judge_quasi_static(Trial& trial, const SceneFile& file, Judgement& out) {
  double spread = 1;
  const auto right = trial.truth.quasi_static(spread);
  if (!right) return;
  const Eigen::VectorXd u = quasi_static(file.scene, file.q);
  double off = 0, size = 0, weight = 0;
  for (std::size_t k = 0; k < right->size(); ++k) {
    off = most(std::abs(u[k] - (*right)[k]), off);
    size = most(std::abs((*right)[k]), size);
  }
  for (const Tree& t : trial.c.trees)
    for (const Link& l : t.links)
      for (double g : trial.c.gravity) weight = std::max(weight, l.mass * std::abs(g));
  const double tolerance = std::max(1e-12, 1000 * kEps * spread * spread);
  if (tolerance < 1 && !(off <= tolerance * std::max({size, 1e-3 * weight, applied_size(trial.c)})))
    out.findings.push_back({Fault::kQuasiStatic, "", text("off by %.1e of %.1e, allowed %.1e", off, size, tolerance)});
}

bool load(const Case& c, const std::string& folder, SceneFile& file, Judgement& out) {
  try {
    file = read_scene(write_case(c, folder));
    return true;
  } catch (const std::exception& e) {
    out.findings.push_back({Fault::kLoad, "", e.what()});
    return false;
  }
}

}  // namespace

std::string to_string(Fault fault) {
  constexpr const char* kNames[] = {"load",       "exception", "no answer",  "singular",     "value",
                                    "rank",       "status",    "condition",  "bound",        "silent",
                                    "derivative", "product",   "not finite", "quasi-static", "impact"};
  return kNames[static_cast<int>(fault)];
}

Judgement judge(const Case& c, const std::string& folder, const std::vector<Method>& methods) {
  return judge_as(c, c, folder, methods);
}

Judgement judge_as(const Case& c, const Case& given, const std::string& folder, const std::vector<Method>& methods) {
  Judgement out;
  SceneFile file;
  if (!load(given, folder, file, out)) return out;
  Trial trial(c);
  const auto judge_by = [&](Method method, Precision precision) {
    try {
      Trying trying(trial, file, method, precision, out);
      out.judged = trying.values() || out.judged;
    } catch (const std::exception& e) {
      out.findings.push_back({Fault::kException, to_string(method), e.what()});
    }
  };
  for (Method method : methods) judge_by(method, Precision::kDouble);
  for (Precision precision : {Precision::kSingle, Precision::kExtended}) judge_by(Method::kAuto, precision);
  judge_quasi_static(trial, file, out);
  return out;
}

Judgement judge_impact(const Case& c, const std::string& folder, const std::vector<Method>& methods) {
  Judgement out;
  SceneFile file;
  if (!load(c, folder, file, out)) return out;
  Trial trial(c);
  const std::vector<char> open(file.scene.contacts.size(), 0), closed(file.scene.contacts.size(), 1);
  for (Method method : methods) {
    const auto find = [&](std::string words) {
      out.findings.push_back({Fault::kImpact, to_string(method), std::move(words)});
    };
    SimulationData data(file.scene, file.q, file.v, Integrator::kSemiImplicitEuler, 1e-3, {method, {}});
    data.dynamics.active = open;
    const VelocityJump jump = switch_contacts(file.scene, closed, data);
    if (jump.status == Status::kFailed || jump.status == Status::kRegularised) continue;
    if (jump.status == Status::kInconsistent) find("inconsistent: contacts at rest cannot contradict each other");
    const int rank = data.dynamics.report.rank;
    const auto& ranks = trial.truth.ranks();
    if (std::find(ranks.begin(), ranks.end(), rank) == ranks.end()) {
      find(text("rank %d, right is %d of %d", rank, ranks.front(), trial.truth.rows()));
      continue;
    }
    Column v, impulse;
    if (!trial.truth.impact(rank, v, impulse)) continue;
    out.judged = true;
    const double tolerance = allowed(trial.truth.at(rank)) * (ranks.size() > 1 ? 100 : 1);
    const auto part = [&](const char* name, const Eigen::VectorXd& x, const Column& right, double size) {
      const double off = distance(span(x), right, 0, right.size());
      if (!(off <= tolerance * size)) find(text("%s off by %.1e of %.1e, allowed %.1e", name, off, size, tolerance));
    };
    part("v", data.v, v, std::max(largest(file.v), size_of(v, 0, v.size())));
    part("impulse", jump.impulse, impulse, size_of(impulse, 0, impulse.size()));
  }
  return out;
}

}  // namespace manycontact::attack
