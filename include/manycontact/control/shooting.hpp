#pragma once
// The optimal control problem with T running nodes and a terminal node,
//
//     minimise  sum_t l_t(x_t, u_t) + l_T(x_T)    with  x_0 given,  x_(t+1) = f_t(x_t, u_t).
//
// The interface is that of Crocoddyl's ShootingProblem. Several threads evaluate the nodes. Results do not depend on
// the number of threads.

#include <iosfwd>
#include <limits>
#include <utility>
#include <vector>

#include "manycontact/control/action_model.hpp"

namespace manycontact {

namespace internal {

/// The time of the last loop over nodes, summed over all threads.
struct LoopTime {
  double seconds = std::numeric_limits<double>::infinity();
};

}  // namespace internal

/// An initial state, running nodes and a terminal node. Not thread-safe: its data belong to one solve at a time.
class ShootingProblem {
 public:
  using ActionModelAbstract = manycontact::ActionModelAbstract;
  using ActionDataAbstract = manycontact::ActionDataAbstract;
  using VectorXs = Eigen::VectorXd;
  using Vectors = std::vector<Eigen::VectorXd>;
  using ModelPtr = std::shared_ptr<ActionModelAbstract>;
  using DataPtr = std::shared_ptr<ActionDataAbstract>;
  using Models = std::vector<ModelPtr>;
  using Datas = std::vector<DataPtr>;

  /// Throw std::invalid_argument without running models, for models of different nx or ndx, and an x0 of another size.
  ShootingProblem(const Eigen::VectorXd& x0, const Models& running_models, ModelPtr terminal_model);
  ShootingProblem(const Eigen::VectorXd& x0, const Models& running_models, ModelPtr terminal_model,
                  const Datas& running_datas, DataPtr terminal_data);

  /// Evaluates every node at xs (T + 1), us (T); returns the total cost. Throws std::invalid_argument for wrong sizes.
  double calc(const Vectors& xs, const Vectors& us);
  /// Computes the derivatives of every node at the last calc; returns the total cost.
  double calcDiff(const Vectors& xs, const Vectors& us);
  /// Evaluate node t alone, as calc and calcDiff do, at xs[t], us[t].
  void calc_node(std::size_t t, const Vectors& xs, const Vectors& us);
  void calcDiff_node(std::size_t t, const Vectors& xs, const Vectors& us);
  double total_cost() const;  // the total cost of the last calc, added in the order of the nodes
  /// Simulates the controls us (T) from x0; xs receives T + 1 states.
  void rollout(const Vectors& us, Vectors& xs);
  Vectors rollout_us(const Vectors& us);
  /// Computes controls that keep each of the T states xs at rest.
  void quasiStatic(Vectors& us, const Vectors& xs);
  Vectors quasiStatic_xs(const Vectors& xs);

  /// Shifts the horizon by one node (receding horizon): removes the first running node and appends `model` at the end.
  /// Other nodes keep their data. The caller must shift the initial guess. Without `data`, new data are created.
  void circularAppend(ModelPtr model, DataPtr data);
  void circularAppend(ModelPtr model);
  /// Replace node i; i = T is the terminal node.
  void updateNode(std::size_t i, ModelPtr model, DataPtr data);
  void updateModel(std::size_t i, ModelPtr model);

  std::size_t get_T() const { return running_models_.size(); }           // number of running nodes
  const Eigen::VectorXd& get_x0() const { return x0_; }                  // the initial state
  const Models& get_runningModels() const { return running_models_; }    // the running nodes
  const ModelPtr& get_terminalModel() const { return terminal_model_; }  // the terminal node
  const Datas& get_runningDatas() const { return running_datas_; }       // data of the running nodes
  /// Returns the data of the terminal node.
  const DataPtr& get_terminalData() const { return terminal_data_; }
  /// Returns the model of node t <= T, where T is the terminal node.
  const ModelPtr& model(std::size_t t) const { return t < get_T() ? running_models_[t] : terminal_model_; }
  /// Returns the data of node t.
  const DataPtr& data(std::size_t t) const { return t < get_T() ? running_datas_[t] : terminal_data_; }
  /// Returns whether node t is the terminal node, whose calc has no u. (Running nodes without controls have an empty
  /// u.)
  bool by_state_alone(std::size_t t) const { return t == get_T(); }
  std::size_t get_nx() const { return nx_; }              // size of a state
  std::size_t get_ndx() const { return ndx_; }            // size of a tangent vector
  std::size_t get_nu_max() const;                         // largest number of controls of a node
  std::size_t get_nthreads() const { return nthreads_; }  // number of threads
  void set_x0(const Eigen::VectorXd& x0);  // sets the initial state; throws std::invalid_argument for a wrong size
  /// Replaces all running nodes and creates new data. The number of nodes may change.
  void set_runningModels(const Models& models);
  void set_terminalModel(ModelPtr model) { updateModel(get_T(), model); }  // replaces the node and creates new data
  /// Sets the number of threads. Initially, and for nthreads < 1, it is OpenMP's number, or 1 without OpenMP. If the
  /// nodes together take less than about 50 us per thread, one thread evaluates all nodes.
  void set_nthreads(int nthreads);
  /// Returns whether nodes were replaced since the last call of this function.
  bool is_updated() { return std::exchange(is_updated_, false); }

 private:
  void check_node(const char* where, const ModelPtr& model) const;
  void check_data(const char* where, const ModelPtr& model, const DataPtr& data) const;
  void check_sizes(const char* where, std::size_t xs, std::size_t expected_xs, std::size_t us) const;
  Eigen::VectorXd x0_;
  ModelPtr terminal_model_;
  DataPtr terminal_data_;
  Models running_models_;
  Datas running_datas_;
  std::size_t nx_, ndx_, nthreads_;
  bool is_updated_ = false;
  internal::LoopTime calc_time_, calcDiff_time_;
};
std::ostream& operator<<(std::ostream& os, const ShootingProblem& problem);  // prints the problem

}  // namespace manycontact
