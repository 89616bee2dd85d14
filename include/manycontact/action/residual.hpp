#pragma once
// r(x, u), the base of all residuals. Interface of Crocoddyl's ResidualModelAbstract, except that action models keep
// Jacobians as blocks of the rows and columns they touch. Whole matrices Rx, Ru are there too where a residual is
// evaluated by hand (collector.hpp), and of a user's own that is written for Crocoddyl.

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
  /// The whole matrices, nr x ndx and nr x nu, by calcDiff. Without a size in the data of an action model.
  Eigen::MatrixXd Rx, Ru;
  /// The same from the blocks: for looking at, made anew at each call.
  Eigen::MatrixXd whole_Rx() const;
  Eigen::MatrixXd whole_Ru() const;

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
  ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, std::size_t nu, Dependence on);
  /// Crocoddyl's, for a residual of one's own whose calcDiff writes data->Rx and data->Ru. nu: default nv.
  ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, std::size_t nu, bool q_dependent = true,
                        bool v_dependent = true, bool u_dependent = true);
  ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, bool q_dependent = true,
                        bool v_dependent = true, bool u_dependent = true);
  virtual ~ResidualModelAbstract() = default;

  /// data->r.
  virtual void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                    const ConstVectorRef& u) = 0;
  /// Of a terminal node. By default r(x) where r depends on x alone, else zero: there are no accelerations, forces or
  /// controls there.
  virtual void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x);
  /// Rx and Ru of data->blocks, by differentiate, and where data have them the whole matrices; after calc.
  virtual void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                        const ConstVectorRef& u);
  virtual void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x);
  virtual std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared);

  /// Lays out data.blocks; called by createData and again when the islands change (a contact was switched). By default
  /// one block of everything.
  virtual void lay_out(ResidualDataAbstract& data) const;
  /// False when the data must be laid out again: they are of another frame, say.
  virtual bool fits(const ResidualDataAbstract&) const { return true; }
  /// Fills the blocks of the data with the whole matrices, where calcDiff wrote those alone: of Crocoddyl's
  /// constructor.
  void take_whole(ResidualDataAbstract& data) const;

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }
  std::size_t get_nr() const { return nr_; }
  std::size_t get_nu() const { return nu_; }
  bool get_q_dependent() const { return on_.q || on_.acceleration || on_.forces; }
  bool get_v_dependent() const { return on_.v || on_.acceleration || on_.forces; }
  bool get_u_dependent() const { return on_.u || on_.acceleration || on_.forces; }
  const Dependence& depends_on() const { return on_; }
  virtual void print(std::ostream& os) const;

 protected:
  /// Rx and Ru of data->blocks. Throws std::logic_error unless a residual has it, or a calcDiff of its own.
  virtual void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                             const ConstVectorRef& u);
  /// Of a terminal node.
  virtual void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x);
  std::shared_ptr<StateAbstract> state_;
  std::size_t nr_, nu_;
  Dependence on_;
  Eigen::VectorXd unone_;  // nu zeros

 private:
  friend struct ResidualDataAbstract;
  bool whole_ = false;  // by Crocoddyl's constructor
};
std::ostream& operator<<(std::ostream& os, const ResidualModelAbstract& model);

}  // namespace manycontact
