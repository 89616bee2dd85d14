#pragma once
// r(x, u), the base of all residuals. Interface of Crocoddyl's ResidualModelAbstract, except that Jacobians are kept as
// blocks of the rows and columns they touch.

#include "manycontact/action/collector.hpp"

namespace manycontact {

class ResidualModelAbstract;

/// Rows of a residual and everything they depend on. The blocks of a residual have disjoint rows.
struct ResidualBlock {
  ResidualBlock(std::vector<int> rows, std::vector<int> xcols, std::vector<int> ucols);
  std::vector<int> rows;   // in nr
  std::vector<int> xcols;  // in ndx
  std::vector<int> ucols;  // in nu
  RowMajorMatrix Rx, Ru;   // rows x xcols, rows x ucols
  bool constant = false;   // set by lay_out, and by nobody else
};

struct ResidualDataAbstract {  // r and its Jacobians as blocks
  ResidualDataAbstract(const ResidualModelAbstract* model, DataCollector* shared);
  virtual ~ResidualDataAbstract() = default;

  DataCollector* shared;
  Eigen::VectorXd r;                  // nr: by calc
  std::vector<ResidualBlock> blocks;  // by calcDiff; laid out by lay_out
  /// The whole matrices, nr x ndx and nr x nu: for looking at, made anew at each call.
  Eigen::MatrixXd Rx() const;
  Eigen::MatrixXd Ru() const;

 private:
  std::size_t ndx_, nu_;
};

/// What a residual depends on; what is not said costs nothing.
struct Dependence {
  bool q = false, v = false, u = false;
  bool acceleration = false;  // on xout, and so on all of q, v, u
  bool forces = false;        // on contact forces, and so on all of q, v, u: their derivatives are computed
};

class ResidualModelAbstract {  // r(x, u)
 public:
  ResidualModelAbstract(std::shared_ptr<StateMultibody> state, std::size_t nr, std::size_t nu, Dependence on);
  virtual ~ResidualModelAbstract() = default;

  /// data->r.
  virtual void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                    const ConstVectorRef& u) = 0;
  /// Of a terminal node. By default r(x) where r depends on x alone, else zero: there are no accelerations, forces or
  /// controls there.
  virtual void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x);
  /// Rx and Ru of data->blocks, after calc.
  virtual void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                        const ConstVectorRef& u) = 0;
  virtual void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x);
  virtual std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared);

  /// Lays out data.blocks; called by createData and again when the islands change (a contact was switched). By default
  /// one block of everything.
  virtual void lay_out(ResidualDataAbstract& data) const;
  /// False when the data must be laid out again: they are of another frame, say.
  virtual bool fits(const ResidualDataAbstract&) const { return true; }

  const std::shared_ptr<StateMultibody>& get_state() const { return state_; }
  std::size_t get_nr() const { return nr_; }
  std::size_t get_nu() const { return nu_; }
  bool get_q_dependent() const { return on_.q || on_.acceleration || on_.forces; }
  bool get_v_dependent() const { return on_.v || on_.acceleration || on_.forces; }
  bool get_u_dependent() const { return on_.u || on_.acceleration || on_.forces; }
  const Dependence& depends_on() const { return on_; }
  virtual void print(std::ostream& os) const;

 protected:
  std::shared_ptr<StateMultibody> state_;
  std::size_t nr_, nu_;
  Dependence on_;
  Eigen::VectorXd unone_;  // nu zeros
};
std::ostream& operator<<(std::ostream& os, const ResidualModelAbstract& model);

}  // namespace manycontact
