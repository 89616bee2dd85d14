#pragma once
// Action models that compute the derivatives of another model by central differences. They are meant for user-defined
// models and for tests. The step is absolute in x's tangent space, relative to max(1, |u_i|) in u.

#include <cmath>
#include <functional>
#include <limits>

#include "manycontact/action/diff_action.hpp"

namespace manycontact {

namespace internal {

/// The step of the differences.
class Step {
 public:
  double get_disturbance() const { return step_; }
  void set_disturbance(double disturbance);  // throws std::invalid_argument unless it is positive

 protected:
  explicit Step(const char* where = "set_disturbance") : where_(where) {}  // where: the beginning of messages
  double step_ = std::cbrt(std::numeric_limits<double>::epsilon());

 private:
  const char* where_;
};

/// A list of functions that are called before each standalone evaluation of a part (a cost, an actuation ...).
class Reevaluation {
 public:
  using ReevaluationFunction = std::function<void(const Eigen::VectorXd& x, const Eigen::VectorXd& u)>;
  void set_reevals(const std::vector<ReevaluationFunction>& reevals) { reevals_ = reevals; }

 protected:
  void reevaluate(const Eigen::VectorXd& x, const Eigen::VectorXd& u) const {
    for (const ReevaluationFunction& reevaluate : reevals_) reevaluate(x, u);
  }
  std::vector<ReevaluationFunction> reevals_;
};

}  // namespace internal

/// The model that is differentiated, and the step of the differences.
template <class Model>
class NumDiffOf : public internal::Step {
 public:
  const std::shared_ptr<Model>& get_model() const { return model_; }  // the model that is differentiated

 protected:
  /// Throws std::invalid_argument for a null pointer. who, where: the beginnings of messages.
  NumDiffOf(const char* who, std::shared_ptr<Model> model, const char* where = "set_disturbance")
      : Step(where), model_(internal::given(who, model)) {}
  std::shared_ptr<Model> model_;
};

/// Data of a node with derivatives by central differences.
template <class NodeData>
struct NodeDataNumDiff : NodeData {
  /// Allocates the data of the model.
  template <class NodeNumDiff>
  explicit NodeDataNumDiff(const NodeNumDiff* model)
      : NodeData(model), data_0(model->get_model()->createData()), data_step(model->get_model()->createData()) {}
  std::shared_ptr<NodeData> data_0, data_step;  // the model's data at x, u, and at the displaced x, u of a difference
  Eigen::MatrixXd Rx, Ru;                       // nr x ndx, nr x nu
};

/// The common base of nodes with derivatives by central differences, in continuous and in discrete time.
template <class Node, class NodeData>
class NodeNumDiff : public Node, public NumDiffOf<Node> {
 public:
  using Data = std::shared_ptr<NodeData>;
  void calc(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) override { evaluate(data, x, &u); }
  void calc(const Data& data, const ConstVectorRef& x) override { evaluate(data, x, nullptr); }
  /// Computes Fx, Fu, Lx, Lu, Gx, Gu, Hx, Hu and the Hessians, as dense matrices only.
  void calcDiff(const Data& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    differentiate(data, x, u, false);
  }
  void calcDiff(const Data& data, const ConstVectorRef& x) override { differentiate(data, x, this->unone_, true); }
  void quasiStatic(const Data& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;
  bool get_with_gauss_approx() const { return gauss_; }  // whether Hessians are Gauss-Newton's

  void print(std::ostream& os) const override;

 protected:
  /// name: name of the class. next: the member that calc computes, xout or xnext. where: prefix of messages of Step.
  NodeNumDiff(const char* name, std::shared_ptr<Node> model, bool with_gauss_approx, Eigen::VectorXd NodeData::*next,
              const char* where);
  using NumDiffOf<Node>::model_;

 private:
  using Own = NodeDataNumDiff<NodeData>;
  const NodeAbstract* sized_by() const override { return model_.get(); }
  /// Returns the acceleration in `moved`, or in discrete time the next state in `moved` (-) the next state in `at`.
  virtual Eigen::VectorXd coordinates(const NodeData& at, const NodeData& moved, bool terminal) const = 0;
  /// Returns the prefix of messages about data of another model.
  virtual std::string where(const char* function) const { return std::string(name_) + "::" + function; }
  Own& own(const char* function, const Data& data) const;
  void evaluate(const Data& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void differentiate(const Data& data, const Eigen::VectorXd& x, const Eigen::VectorXd& u, bool terminal) const;
  const char* name_;
  bool gauss_;
  Eigen::VectorXd NodeData::*next_;
};

/// A node in continuous time with derivatives by central differences.
class DifferentialActionModelNumDiff
    : public NodeNumDiff<DifferentialActionModelAbstract, DifferentialActionDataAbstract> {
 public:
  /// with_gauss_approx: whether Hessians are Rx^T Rx, ..., as suits costs 1/2 |r|^2 of weight 1, instead of second
  /// differences.
  explicit DifferentialActionModelNumDiff(std::shared_ptr<DifferentialActionModelAbstract> model,
                                          bool with_gauss_approx = false);
  std::shared_ptr<DifferentialActionDataAbstract> createData() override;
  /// Set the bounds of the model.
  void set_g_lb(const Eigen::VectorXd& g_lb) override { model_->set_g_lb(g_lb); }
  void set_g_ub(const Eigen::VectorXd& g_ub) override { model_->set_g_ub(g_ub); }

 private:
  Eigen::VectorXd coordinates(const DifferentialActionDataAbstract& at, const DifferentialActionDataAbstract& moved,
                              bool terminal) const override;
  std::string where(const char* function) const override;
};

/// Data of DifferentialActionModelNumDiff.
struct DifferentialActionDataNumDiff : NodeDataNumDiff<DifferentialActionDataAbstract> {
  /// Allocates the data of the model.
  explicit DifferentialActionDataNumDiff(DifferentialActionModelNumDiff* model) : NodeDataNumDiff(model) {}
};

}  // namespace manycontact
