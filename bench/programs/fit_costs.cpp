// `./run bench --fit`: measures islands of many kinds and fits the coefficients of predicted costs (kkt/costs.hpp).
//
// A predicted time is linear in the coefficients, t = sum_j c_j n_j, with an island's counts n_j (rows, entries,
// multiply-adds). The fit minimises sum_i (sum_j c_j n_ij / t_i - 1)^2 + w sum_j (c_j / c0_j - 1)^2 over the measured
// islands i. Coefficients that these do not distinguish keep the ratio of the current ones, c0; negative ones become 0.

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "../scenes.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/kkt/costs.hpp"
#include "manycontact/kkt/shape.hpp"

namespace manycontact::bench {

namespace {

constexpr double kWeight = 1e-2;  // w divided by the number of islands

struct Coefficient {
  const char* name;
  double now;
};

// The cost model of one method: the coefficients, and an island's count for each.
struct CostModel {
  const char* what;
  Options options;
  std::vector<Coefficient> coefficients;
  std::function<std::vector<double>(IslandShape&)> counts;
};

double contacts_of(const IslandShape& shape) { return static_cast<double>(shape.scene().contacts.size()); }

CostModel ldl(Order order) {
  using namespace costs;
  const bool early = order == Order::kContactsEarly;
  Options options;
  options.method = Method::kSparseLdl, options.order = order, options.simd_level = SimdLevel::kOff;
  return {early ? "sparse-ldl, contacts-early" : "sparse-ldl, leaf-to-root",
          options,
          {{"kTermsRow + kLdlRow", kTermsRow + kLdlRow},
           {"kTermsContact", kTermsContact},
           {"kLdlEntry", kLdlEntry},
           {"kLdlFlop", kLdlFlop},
           {"kLdlBlock", kLdlBlock},
           {early ? "kLdlShortRange" : "kLdlRange", early ? kLdlShortRange : kLdlRange}},
          [order](IslandShape& shape) {
            const sparse::LdlCounts& L = shape.counts(order);
            return std::vector<double>{static_cast<double>(shape.island().size()),
                                       contacts_of(shape),
                                       static_cast<double>(L.nonzeros),
                                       static_cast<double>(L.flops),
                                       static_cast<double>(L.blocks),
                                       static_cast<double>(L.scattered)};
          }};
}

CostModel cholmod() {
  using namespace costs;
  Options options;
  options.method = Method::kSparseCholmod, options.order = Order::kLeafToRoot;
  return {"sparse-cholmod, leaf-to-root",
          options,
          {{"kCholmodCall", kCholmodCall},
           {"kTermsRow + kCholmodRow", kTermsRow + kCholmodRow},
           {"kTermsContact", kTermsContact},
           {"kCholmodEntry", kCholmodEntry},
           {"kCholmodFlop", kCholmodFlop}},
          [](IslandShape& shape) {
            const sparse::LdlCounts& L = shape.counts(Order::kLeafToRoot);
            return std::vector<double>{1, static_cast<double>(shape.island().size()), contacts_of(shape),
                                       static_cast<double>(L.nonzeros), static_cast<double>(L.flops)};
          }};
}

CostModel bodies() {
  using namespace costs;
  Options options;
  options.method = Method::kSparseBodies, options.simd_level = SimdLevel::kOff;
  return {"sparse-bodies",
          options,
          {{"kBody", kBody},
           {"kBodyJoint", kBodyJoint},
           {"kBodyRow", kBodyRow},
           {"kBodyOpen", kBodyOpen},
           {"kBodyUpdate", kBodyUpdate}},
          [](IslandShape& shape) {
            const BodyPattern& p = *shape.bodies();
            const auto wide = std::count_if(p.ndof.begin(), p.ndof.end(), [](int n) { return n > 1; });
            return std::vector<double>{static_cast<double>(p.nodes), static_cast<double>(wide),
                                       static_cast<double>(p.nc), p.open_squared, p.open_updates};
          }};
}

// Returns the seconds of a repeated solve: the median of as many as fit in a fifth of a second.
double seconds_of(const Posed& s, SceneData& data) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  std::vector<double> times;
  const Clock::time_point begin = Clock::now();
  while (times.size() < 5 || since(begin) < 0.2) {
    const Clock::time_point start = Clock::now();
    (void)solve(s.scene, s.q, s.v, s.u, data);
    times.push_back(since(start));
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

struct Sample {
  std::string scene;
  std::vector<double> counts;
  double cost;  // measured, in units of predicted cost
};

void measure(const CostModel& model, const std::string& name, const Posed& s, std::vector<Sample>& samples) {
  Options options = model.options;
  options.reduce_pairs = false;  // the island's own rows are counted
  SceneData data(s.scene, options);
  const Report& report = solve(s.scene, s.q, s.v, s.u, data);
  if (report.status != Status::kOk || report.islands.size() != 1) return;
  IslandShape shape(s.scene, solved_island(data, 0));
  samples.push_back({name, model.counts(shape), seconds_of(s, data) / costs::kPredictedSecond});
}

Eigen::VectorXd fit(const CostModel& model, const std::vector<Sample>& samples) {
  const auto n = static_cast<Eigen::Index>(model.coefficients.size()), m = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m + n, n);  // equations for x = c / c0
  Eigen::VectorXd b = Eigen::VectorXd::Ones(m + n);
  const double weight = std::sqrt(kWeight * static_cast<double>(m));
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index j = 0; j < n; ++j) A(i, j) = samples[i].counts[j] * model.coefficients[j].now / samples[i].cost;
  A.bottomRows(n).diagonal().setConstant(weight);
  b.tail(n).setConstant(weight);
  Eigen::VectorXd x = A.colPivHouseholderQr().solve(b).cwiseMax(0);
  for (Eigen::Index j = 0; j < n; ++j) x[j] *= model.coefficients[j].now;
  return x;
}

void print(const CostModel& model, const std::vector<Sample>& samples, const Eigen::VectorXd& fitted) {
  std::printf("%s, %zu islands\n", model.what, samples.size());
  for (std::size_t j = 0; j < model.coefficients.size(); ++j)
    std::printf("  %-26s %10.4g, now %g\n", model.coefficients[j].name, fitted[static_cast<Eigen::Index>(j)],
                model.coefficients[j].now);
  const auto ratio = [&](const Sample& sample, auto&& coefficient) {
    double cost = 0;
    for (std::size_t j = 0; j < sample.counts.size(); ++j) cost += sample.counts[j] * coefficient(j);
    return cost / sample.cost;
  };
  std::printf("  predicted over measured     fitted        now\n");
  for (const Sample& sample : samples)
    std::printf("  %-26s %7.2f    %7.2f\n", sample.scene.c_str(),
                ratio(sample, [&](std::size_t j) { return fitted[static_cast<Eigen::Index>(j)]; }),
                ratio(sample, [&](std::size_t j) { return model.coefficients[j].now; }));
}

}  // namespace

}  // namespace manycontact::bench

int main() {
  using namespace manycontact;
  using namespace manycontact::bench;
  std::vector<std::pair<std::string, Posed>> scenes;
  const auto damped = [](Posed s) {
    s.scene.damping = 1e-8;
    return s;
  };
  for (int n : {1, 4, 16, 64}) scenes.emplace_back("ring " + std::to_string(n), robots(n, n > 2));
  for (int n : {16, 48, 64}) scenes.emplace_back("feet " + std::to_string(n), herd_on_feet(n));
  for (int n : {10, 40, 160}) scenes.emplace_back("tower " + std::to_string(n), damped(tower(n)));
  for (int n : {16, 64, 256}) scenes.emplace_back("table " + std::to_string(n), damped(table(n)));
  for (int n : {16, 100, 225}) scenes.emplace_back("wall " + std::to_string(n), damped(wall(n)));
  for (int n : {10, 30, 100, 300}) scenes.emplace_back("chain " + std::to_string(n), chain(n));
  for (const CostModel& model : {ldl(Order::kLeafToRoot), ldl(Order::kContactsEarly), cholmod(), bench::bodies()}) {
    std::vector<Sample> samples;
    for (const auto& [name, scene] : scenes) measure(model, name, scene, samples);
    if (samples.size() >= model.coefficients.size()) print(model, samples, fit(model, samples));
    std::fflush(stdout);
  }
}
