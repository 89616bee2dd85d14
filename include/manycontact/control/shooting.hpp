#pragma once
// The optimal control problem over T running nodes and a terminal one,
//
//     minimise  sum_t l_t(x_t, u_t) + l_T(x_T)    with  x_0 given,  x_(t+1) = f_t(x_t, u_t).
//
// Interface of Crocoddyl's ShootingProblem. Nodes are evaluated in parallel over `get_nthreads()` threads; every number
// is the same for any number of threads.

#include <iosfwd>
#include <limits>
#include <vector>

#include "manycontact/control/action_model.hpp"

namespace manycontact {

namespace internal {

/// The time that a loop over nodes took the last time, of all threads together.
struct LoopTime {
  double seconds = std::numeric_limits<double>::infinity();
};

}  // namespace internal

class ShootingProblem {  // x0, running nodes, a terminal one
 public:
  using ActionModelAbstract = manycontact::ActionModelAbstract;
  using ActionDataAbstract = manycontact::ActionDataAbstract;
  using VectorXs = Eigen::VectorXd;
  using Models = std::vector<std::shared_ptr<ActionModelAbstract>>;
  using Datas = std::vector<std::shared_ptr<ActionDataAbstract>>;

  /// Throw std::invalid_argument when there is no running model, or states differ in nx, ndx or from x0's size.
  ShootingProblem(const Eigen::VectorXd& x0, const Models& running_models,
                  std::shared_ptr<ActionModelAbstract> terminal_model);
  ShootingProblem(const Eigen::VectorXd& x0, const Models& running_models,
                  std::shared_ptr<ActionModelAbstract> terminal_model, const Datas& running_datas,
                  std::shared_ptr<ActionDataAbstract> terminal_data);

  /// Every node at xs (T + 1), us (T); returns the total cost.
  double calc(const std::vector<Eigen::VectorXd>& xs, const std::vector<Eigen::VectorXd>& us);
  /// Every node's derivatives at the last calc; returns the total cost.
  double calcDiff(const std::vector<Eigen::VectorXd>& xs, const std::vector<Eigen::VectorXd>& us);
  /// Node t alone, as calc and calcDiff evaluate it at xs[t], us[t].
  void calc_node(std::size_t t, const std::vector<Eigen::VectorXd>& xs, const std::vector<Eigen::VectorXd>& us);
  void calcDiff_node(std::size_t t, const std::vector<Eigen::VectorXd>& xs, const std::vector<Eigen::VectorXd>& us);
  /// Of the last calc, in the nodes' order.
  double total_cost() const;
  /// xs (T + 1) from x0 on.
  void rollout(const std::vector<Eigen::VectorXd>& us, std::vector<Eigen::VectorXd>& xs);
  std::vector<Eigen::VectorXd> rollout_us(const std::vector<Eigen::VectorXd>& us);
  /// Controls that keep each of the T states xs still.
  void quasiStatic(std::vector<Eigen::VectorXd>& us, const std::vector<Eigen::VectorXd>& xs);
  std::vector<Eigen::VectorXd> quasiStatic_xs(const std::vector<Eigen::VectorXd>& xs);

  /// Drops the first running node and appends one at the end.
  void circularAppend(std::shared_ptr<ActionModelAbstract> model, std::shared_ptr<ActionDataAbstract> data);
  void circularAppend(std::shared_ptr<ActionModelAbstract> model);
  /// Replaces node i; i = T: the terminal one.
  void updateNode(std::size_t i, std::shared_ptr<ActionModelAbstract> model, std::shared_ptr<ActionDataAbstract> data);
  void updateModel(std::size_t i, std::shared_ptr<ActionModelAbstract> model);

  std::size_t get_T() const { return running_models_.size(); }
  const Eigen::VectorXd& get_x0() const { return x0_; }
  const Models& get_runningModels() const { return running_models_; }
  const std::shared_ptr<ActionModelAbstract>& get_terminalModel() const { return terminal_model_; }
  const Datas& get_runningDatas() const { return running_datas_; }
  const std::shared_ptr<ActionDataAbstract>& get_terminalData() const { return terminal_data_; }
  /// Node t <= T, T the terminal one.
  const std::shared_ptr<ActionModelAbstract>& model(std::size_t t) const {
    return t < get_T() ? running_models_[t] : terminal_model_;
  }
  const std::shared_ptr<ActionDataAbstract>& data(std::size_t t) const {
    return t < get_T() ? running_datas_[t] : terminal_data_;
  }
  /// Whether node t is evaluated by x alone: the terminal one. Running nodes without controls are evaluated at (x, u)
  /// with an empty u: they move.
  bool by_state_alone(std::size_t t) const { return t == get_T(); }
  std::size_t get_nx() const { return nx_; }
  std::size_t get_ndx() const { return ndx_; }
  std::size_t get_nu_max() const;
  std::size_t get_nthreads() const { return nthreads_; }
  void set_x0(const Eigen::VectorXd& x0);
  /// With new data; there may be more or fewer than before.
  void set_runningModels(const Models& models);
  void set_terminalModel(std::shared_ptr<ActionModelAbstract> model);
  /// At first, and for a number < 1, OpenMP's; 1 where the library was built without. Where all nodes together take
  /// less than some 50 us for each thread, one does them.
  void set_nthreads(int nthreads);
  /// Whether nodes were replaced since the last time it was asked.
  bool is_updated();

 private:
  void check_node(const char* where, const std::shared_ptr<ActionModelAbstract>& model) const;
  void check_data(const char* where, const std::shared_ptr<ActionModelAbstract>& model,
                  const std::shared_ptr<ActionDataAbstract>& data) const;
  void check_sizes(const char* where, std::size_t xs, std::size_t expected_xs, std::size_t us) const;
  Eigen::VectorXd x0_;
  std::shared_ptr<ActionModelAbstract> terminal_model_;
  std::shared_ptr<ActionDataAbstract> terminal_data_;
  Models running_models_;
  Datas running_datas_;
  std::size_t nx_, ndx_, nthreads_;
  bool is_updated_ = false;
  internal::LoopTime calc_time_, calcDiff_time_;
};
std::ostream& operator<<(std::ostream& os, const ShootingProblem& problem);

}  // namespace manycontact
