#pragma once
// A residual r(x, u), the base of all residuals. The interface is that of Crocoddyl's ResidualModelAbstract. Action
// models store Jacobians as dense blocks of nonzero rows and columns. Whole matrices Rx, Ru exist in standalone
// evaluation (detail/action/collector.hpp), and for user-defined residuals with Crocoddyl's constructors.

#include "manycontact/detail/action/collector.hpp"

namespace manycontact {

class ResidualModelAbstract;

/// Rows of a residual, and all coordinates that these rows depend on. The blocks of a residual have disjoint rows.
struct ResidualBlock {
  ResidualBlock(std::vector<int> rows, std::vector<int> xcols, std::vector<int> ucols);  // allocates Rx and Ru
  std::vector<int> rows;                                                                 // indices in nr
  std::vector<int> xcols;                                                                // indices in ndx
  std::vector<int> ucols;                                                                // indices in nu
  RowMajorMatrix Rx, Ru;                                                                 // rows x xcols, rows x ucols
  bool constant = false;                                                                 // Rx, Ru: set by lay_out only
};

struct ResidualDataAbstract {  // The value r and its Jacobians as blocks.
  ResidualDataAbstract(const ResidualModelAbstract* model, DataCollector* shared);  // allocates the data of the model
  virtual ~ResidualDataAbstract() = default;

  DataCollector* shared;
  Eigen::VectorXd r;                  // nr: set by calc
  std::vector<ResidualBlock> blocks;  // Jacobians: set by calcDiff; lay_out sets the indices of rows and columns
  /// The whole matrices, nr x ndx and nr x nu, set by calcDiff. Empty in the data of an action model.
  Eigen::MatrixXd Rx, Ru;
  /// Assembles the whole Rx from the blocks, for inspection; allocates at each call.
  Eigen::MatrixXd whole_Rx() const;
  Eigen::MatrixXd whole_Ru() const;  // assembles the whole Ru from the blocks

 private:
  std::size_t ndx_, nu_;
};

/// The variables that a residual depends on. Derivatives with respect to other variables are not computed.
struct Dependence {
  bool q = false, v = false, u = false;
  bool acceleration = false;  // depends on xout, and therefore on all of q, v, u
  bool forces = false;        // depends on contact forces and their derivatives, and therefore on all of q, v, u
};

class ResidualModelAbstract : public Printable {  // A function r(x, u).
 public:
  using DataPtr = std::shared_ptr<ResidualDataAbstract>;

  /// nu: number of controls, or kDefaultNu: nv. Throws std::invalid_argument for a null pointer.
  ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, std::size_t nu, Dependence on);
  /// Crocoddyl's constructor, for a user-defined residual whose calcDiff writes data->Rx and data->Ru.
  ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, std::size_t nu, bool q_dependent = true,
                        bool v_dependent = true, bool u_dependent = true);
  /// Crocoddyl's constructor, with nu = nv.
  ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, bool q_dependent = true,
                        bool v_dependent = true, bool u_dependent = true)
      : ResidualModelAbstract(state, nr, state ? state->get_nv() : 0, q_dependent, v_dependent, u_dependent) {}

  virtual void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) = 0;  // computes data->r
  /// Computes the residual of a terminal node: by default r(x) if r depends on x alone, otherwise zero.
  virtual void calc(const DataPtr& data, const ConstVectorRef& x);

  /// Computes Rx, Ru of data->blocks with `differentiate`, and the whole matrices if the data have them. Call it after
  /// calc.
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u);
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& x);
  virtual std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared);

  /// Sets up data.blocks, by default one dense block. It is called by createData, and when the contact islands change.
  virtual void lay_out(ResidualDataAbstract& data) const;
  /// Returns false if lay_out must set up the blocks again, for example because the residual's frame has changed.
  virtual bool fits(const ResidualDataAbstract&) const { return true; }
  /// Copies the whole Rx, Ru to the blocks, for user-defined residuals whose calcDiff writes whole matrices.
  void take_whole(ResidualDataAbstract& data) const;

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }        // state given to the constructor
  std::size_t get_nr() const { return nr_; }                                        // number of rows of the residual
  std::size_t get_nu() const { return nu_; }                                        // number of controls
  bool get_q_dependent() const { return on_.q || on_.acceleration || on_.forces; }  // whether r depends on q
  bool get_v_dependent() const { return on_.v || on_.acceleration || on_.forces; }  // whether r depends on v
  bool get_u_dependent() const { return on_.u || on_.acceleration || on_.forces; }  // whether r depends on u
  const Dependence& depends_on() const { return on_; }                              // the variables that r depends on
  void print(std::ostream& os) const override { os << "ResidualModel {nr=" << nr_ << "}"; }

 protected:
  /// Computes Rx and Ru of data->blocks. The default throws std::logic_error: override this function, or calcDiff.
  virtual void differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u);
  /// Computes Rx for a terminal node.
  virtual void differentiate(const DataPtr& data, const ConstVectorRef& x);
  std::shared_ptr<StateAbstract> state_;
  std::size_t nr_, nu_;
  Dependence on_;
  Eigen::VectorXd unone_;  // nu zeros

 private:
  friend struct ResidualDataAbstract;
  bool whole_ = false;  // calcDiff writes whole Rx, Ru: the residual was made by Crocoddyl's constructor
};

/// The common base of the residuals of this library, with a name. Derived classes compute r and the blocks of Rx, Ru.
class NamedResidual : public ResidualModelAbstract {
 public:
  using ResidualModelAbstract::calc;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override { evaluate(*data, x, u); }
  using ResidualModelAbstract::differentiate;
  void differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    if (!data->blocks.empty()) fill_blocks(*data, x, u);
  }
  void print(std::ostream& os) const override { os << name_; }

 protected:
  /// name: name of the class. nu: number of controls, or kDefaultNu.
  NamedResidual(const char* name, std::shared_ptr<StateAbstract> state, std::size_t nr, std::size_t nu, Dependence on)
      : ResidualModelAbstract(std::move(state), nr, nu, on), name_(name) {}
  /// Computes data.r.
  virtual void evaluate(ResidualDataAbstract&, const ConstVectorRef&, const ConstVectorRef&) const {}
  /// Computes Rx and Ru of the blocks that are not constant.
  virtual void fill_blocks(ResidualDataAbstract&, const ConstVectorRef&, const ConstVectorRef&) const {}
  const char* name_;
};

namespace internal {

/// Throws std::invalid_argument unless `next` has the size, or the number of facets, of the present reference `now`.
template <class Reference>
void check_reference(const char* who, const Reference& now, const Reference& next) {
  if constexpr (std::is_same_v<Reference, Eigen::VectorXd>)
    check_size(who, "the reference", next.size(), static_cast<std::size_t>(now.size()));
  else if constexpr (requires { now.get_nf(); })
    require(next.get_nf() == now.get_nf(), who,
            "the reference has nf = " + std::to_string(next.get_nf()) + ", nf = " + std::to_string(now.get_nf()) +
                " as before is expected");
}

}  // namespace internal

/// A residual with a reference.
template <class Base, class Reference>
class ResidualWithReference : public Base {
 public:
  const Reference& get_reference() const { return reference_; }  // the reference of the residual
  /// Sets the reference. Throws std::invalid_argument if its size, or a cone's number of facets, changes.
  void set_reference(const Reference& reference) {
    internal::check_reference(this->name_, reference_, reference);
    reference_ = reference;
  }

 protected:
  /// of_base: the arguments of the base class.
  template <class... Arguments>
  explicit ResidualWithReference(const Reference& reference, Arguments&&... of_base)
      : Base(std::forward<Arguments>(of_base)...), reference_(reference) {}
  Reference reference_;
};

}  // namespace manycontact
