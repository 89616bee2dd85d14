#include "manycontact/action/constraint.hpp"

#include <ostream>

#include "../by_node.hpp"
#include "../named.hpp"

namespace manycontact {

ConstraintModelResidual::ConstraintModelResidual(std::shared_ptr<StateAbstract> state,
                                                 std::shared_ptr<ResidualModelAbstract> residual,
                                                 const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, bool T_act)
    : state_(std::move(state)), residual_(std::move(residual)), lb_(lower), ub_(upper) {
  constexpr const char* kWho = "ConstraintModelResidual";
  require(state_ && residual_, kWho, "a null pointer was given, a state and a residual are expected");
  require(same_space(*residual_->get_state(), *state_), kWho,
          "the residual belongs to another state, the constraint's state is expected");
  check_size(kWho, "the lower bound", lower.size(), residual_->get_nr());
  check_size(kWho, "the upper bound", upper.size(), residual_->get_nr());
  for (int i = 0; i < lower.size(); ++i) {
    require(lower[i] <= upper[i], kWho,
            "bound " + std::to_string(i) + " has lower " + std::to_string(lower[i]) + ", upper " +
                std::to_string(upper[i]) + "; lower <= upper is expected");
    (lower[i] == upper[i] ? equalities_ : inequalities_).push_back(i);
  }
  T_ = T_act && !residual_->get_u_dependent();
}

ConstraintDataResidual::ConstraintDataResidual(ConstraintModelResidual* model, DataCollector* s)
    : shared(s), residual(model->get_residual()->createData(s)) {
  const auto ng = static_cast<Eigen::Index>(model->get_ng()), nh = static_cast<Eigen::Index>(model->get_nh());
  const auto ndx = static_cast<Eigen::Index>(model->get_state()->get_ndx());
  const auto nu = static_cast<Eigen::Index>(model->get_nu());
  g.setZero(ng), h.setZero(nh);
  Gx.setZero(ng, ndx), Gu.setZero(ng, nu);
  Hx.setZero(nh, ndx), Hu.setZero(nh, nu);
}

// Computes g = r of the inequality rows and h = r - lb of the equality rows of the residual.
void ConstraintModelResidual::evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  internal::calc(*residual_, check_data("ConstraintModelResidual::calc", data).residual, x, u);
  data->g = data->residual->r(inequalities_);
  data->h = data->residual->r(equalities_) - lb_(equalities_);
}

void ConstraintModelResidual::differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  internal::calc_diff(*residual_, check_data("ConstraintModelResidual::calcDiff", data).residual, x, u);
  residual_->take_whole(*data->residual);
  const Eigen::MatrixXd Rx = data->residual->whole_Rx(), Ru = data->residual->whole_Ru();
  data->Gx = Rx(inequalities_, Eigen::all);
  data->Gu = Ru(inequalities_, Eigen::all);
  data->Hx = Rx(equalities_, Eigen::all);
  data->Hu = Ru(equalities_, Eigen::all);
}

void ConstraintModelResidual::print(std::ostream& os) const {
  os << "ConstraintModelResidual {" << *residual_ << ", ng=" << get_ng() << ", nh=" << get_nh() << "}";
}

// ---- stack of constraints

constexpr const char* kConstraintModelManager = "ConstraintModelManager";
using Part = ConstraintDataManager::Part;

static std::ostream& operator<<(std::ostream& os, const ConstraintItem& item) { return os << *item.constraint; }

template class NamedParts<StateAbstract, ConstraintItem>;

ConstraintModelManager::ConstraintModelManager(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : NamedParts(kConstraintModelManager, "constraint", std::move(state), nu) {}

void ConstraintModelManager::addConstraint(const std::string& name, std::shared_ptr<ConstraintModelAbstract> constraint,
                                           bool active) {
  internal::check_part(name_, name, constraint, state_, nu_);
  add({name, constraint, active});
}

void ConstraintModelManager::count() {
  ++status_;
  ng_ = nh_ = ng_T_ = nh_T_ = 0;
  std::vector<double> lower, upper, lower_T, upper_T;
  for (const auto& [name, item] : parts_) {
    if (!item->active) continue;
    const ConstraintModelAbstract& c = *item->constraint;
    ng_ += c.get_ng();
    nh_ += c.get_nh();
    if (c.get_T_constraint()) ng_T_ += c.get_ng(), nh_T_ += c.get_nh();
    for (int i : c.get_inequalities()) {
      lower.push_back(c.get_lb()[i]), upper.push_back(c.get_ub()[i]);
      if (c.get_T_constraint()) lower_T.push_back(c.get_lb()[i]), upper_T.push_back(c.get_ub()[i]);
    }
  }
  const auto vector = [](const std::vector<double>& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), x.size());
  };
  lb_ = vector(lower), ub_ = vector(upper);
  lb_T_ = vector(lower_T), ub_T_ = vector(upper_T);
}

namespace {

// Returns a predicate that is true for constraints that are active in running nodes (terminal: in terminal nodes).
auto holding(bool terminal) {
  return [terminal](const ConstraintItem& item) {
    return item.active && (!terminal || item.constraint->get_T_constraint());
  };
}

// Returns for each block of a residual which of its rows are in `kept`. The rows `kept` of the residual become the rows
// first, first + 1, ... of the stacked constraints g or h.
std::vector<Part> split(const ResidualDataAbstract& residual, const std::vector<int>& kept, int first, bool sparse,
                        BlockSparse& X, BlockSparse& U) {
  std::vector<int> place(residual.r.size(), -1);
  for (std::size_t i = 0; i < kept.size(); ++i) place[kept[i]] = first + static_cast<int>(i);
  std::vector<Part> parts;
  for (std::size_t k = 0; k < residual.blocks.size(); ++k) {
    const ResidualBlock& b = residual.blocks[k];
    Part part;
    part.block = k;
    for (std::size_t i = 0; i < b.rows.size(); ++i) {
      if (place[b.rows[i]] < 0) continue;
      part.from.push_back(static_cast<int>(i));
      part.to.push_back(place[b.rows[i]]);
    }
    if (part.from.empty()) continue;
    if (sparse) part.xplan = X.plan(part.to, b.xcols), part.uplan = U.plan(part.to, b.ucols);
    parts.push_back(std::move(part));
  }
  return parts;
}

// Copies stacked constraints or their Jacobian to the memory given to shareMemory, unless they are in this memory.
template <class From, class To>
void hand_on(const From& from, To& to) {
  if (from.data() == to.data()) return;
  require(from.rows() == to.rows() && from.cols() == to.cols(), kConstraintModelManager,
          "the shared data were made for other constraints, call `resize` first");
  to = from;
}

void stack_parts(const ResidualDataAbstract& residual, const std::vector<Part>& parts, bool terminal, bool dense,
                 bool sparse, Eigen::MatrixXd& X, Eigen::MatrixXd& U, BlockSparse& Xs, BlockSparse& Us) {
  for (const Part& part : parts) {
    const ResidualBlock& b = residual.blocks[part.block];
    const auto write = [&](const RowMajorMatrix& J, const std::vector<int>& cols, Eigen::MatrixXd& out) {
      for (std::size_t j = 0; j < cols.size(); ++j)
        for (std::size_t i = 0; i < part.from.size(); ++i) out(part.to[i], cols[j]) = J(part.from[i], j);
    };
    if (dense) write(b.Rx, b.xcols, X);
    if (dense && !terminal) write(b.Ru, b.ucols, U);
    if (sparse) Xs.add(part.xplan, 1, b.Rx, part.from);
    if (sparse && !terminal) Us.add(part.uplan, 1, b.Ru, part.from);
  }
}

}  // namespace

void ConstraintModelManager::check_residuals(const char* where, const ConstraintDataManager& data) const {
  auto of = data.of.begin();
  for (const auto& [name, item] : parts_)
    if (*of++ != item->constraint->get_residual())
      require(false, where, "the data of \"" + name + "\" belong to another constraint, new data are expected");
}

void ConstraintModelManager::lay_out(ConstraintDataManager& data, bool terminal) const {
  check_residuals("ConstraintModelManager::lay_out", data);
  DifferentialActionDataAbstract& out = *data.out;
  const bool dense = has_dense(out.storage), sparse = has_blocks(out.storage);
  const Eigen::Index ng = terminal ? ng_T_ : ng_, nh = terminal ? nh_T_ : nh_;
  const Eigen::Index ndx = state_->get_ndx(), nu = nu_;
  out.g.setZero(ng);
  out.h.setZero(nh);
  out.Gx.setZero(dense ? ng : 0, dense ? ndx : 0);
  out.Gu.setZero(dense ? ng : 0, dense ? nu : 0);
  out.Hx.setZero(dense ? nh : 0, dense ? ndx : 0);
  out.Hu.setZero(dense ? nh : 0, dense ? nu : 0);
  for (BlockSparse* m : {&out.Gx_blocks, &out.Gu_blocks, &out.Hx_blocks, &out.Hu_blocks}) m->clear();
  data.g_parts.clear();
  data.h_parts.clear();
  int g = 0, h = 0;
  for (const auto& [name, item] : parts_) {
    ResidualDataAbstract& residual = *data.constraints.at(name);
    const ConstraintModelAbstract& c = *item->constraint;
    c.get_residual()->lay_out(residual);
    if (!holding(terminal)(*item)) continue;
    data.g_parts[name] = split(residual, c.get_inequalities(), g, sparse, out.Gx_blocks, out.Gu_blocks);
    data.h_parts[name] = split(residual, c.get_equalities(), h, sparse, out.Hx_blocks, out.Hu_blocks);
    g += static_cast<int>(c.get_ng());
    h += static_cast<int>(c.get_nh());
  }
  out.Gx_blocks.finish(static_cast<int>(ng), static_cast<int>(ndx));
  out.Gu_blocks.finish(static_cast<int>(ng), static_cast<int>(nu));
  out.Hx_blocks.finish(static_cast<int>(nh), static_cast<int>(ndx));
  out.Hu_blocks.finish(static_cast<int>(nh), static_cast<int>(nu));
  data.terminal = terminal;
  data.status = status_;
  data.shareMemory(&out);
}

std::shared_ptr<ConstraintDataManager> ConstraintModelManager::createData(DataCollector* shared,
                                                                          DifferentialActionDataAbstract* out) {
  auto data = std::make_shared<ConstraintDataManager>();
  data->shared = shared;
  data->out = out;
  data->version = version_;
  for (const auto& [name, item] : parts_) {
    data->constraints[name] = item->constraint->get_residual()->createData(shared);
    data->of.push_back(item->constraint->get_residual());
  }
  lay_out(*data, false);
  return data;
}

std::shared_ptr<ConstraintDataManager> ConstraintModelManager::createData(DataCollector* shared) {
  auto own = std::make_unique<DifferentialActionDataAbstract>();
  own->storage = MatrixStorage::kDense;
  auto data = createData(shared, own.get());
  data->own = std::move(own);
  return data;
}

void ConstraintModelManager::prepare(const char* where, const DataPtr& data, const ConstVectorRef& x,
                                     const ConstVectorRef* u) const {
  ConstraintDataManager& d = check_data(where, data);
  check_size(where, "x", x.size(), state_->get_nx());
  require(d.version == version_ && d.constraints.size() == parts_.size(), where,
          "constraints were added or removed since the data were created, new data are expected");
  check_residuals(where, d);
  if (d.terminal != !u || d.status != status_) lay_out(d, !u);
  if (u) check_size(where, "u", u->size(), nu_);
}

void ConstraintModelManager::stack_values(ConstraintDataManager& data, bool terminal) const {
  DifferentialActionDataAbstract& out = *data.out;
  int g = 0, h = 0;
  internal::for_each_part(parts_, data.constraints, holding(terminal),
                          [&](const ConstraintItem& item, const auto& residual) {
                            const ConstraintModelAbstract& c = *item.constraint;
                            for (int i : c.get_inequalities()) out.g[g++] = residual->r[i];
                            for (int i : c.get_equalities()) out.h[h++] = residual->r[i] - c.get_lb()[i];
                          });
  if (!data.own) return;
  hand_on(out.g, data.g);
  hand_on(out.h, data.h);
}

void ConstraintModelManager::stack_jacobians(ConstraintDataManager& data, bool terminal) const {
  DifferentialActionDataAbstract& out = *data.out;
  for (BlockSparse* m : {&out.Gx_blocks, &out.Gu_blocks, &out.Hx_blocks, &out.Hu_blocks}) m->set_zero();
  const bool dense = has_dense(out.storage), sparse = has_blocks(out.storage);
  for (const auto& [name, parts] : data.g_parts)
    stack_parts(*data.constraints.at(name), parts, terminal, dense, sparse, out.Gx, out.Gu, out.Gx_blocks,
                out.Gu_blocks);
  for (const auto& [name, parts] : data.h_parts)
    stack_parts(*data.constraints.at(name), parts, terminal, dense, sparse, out.Hx, out.Hu, out.Hx_blocks,
                out.Hu_blocks);
  if (!data.own) return;
  hand_on(out.Gx, data.Gx);
  hand_on(out.Gu, data.Gu);
  hand_on(out.Hx, data.Hx);
  hand_on(out.Hu, data.Hu);
}

void ConstraintModelManager::evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  prepare("ConstraintModelManager::calc", data, x, u);
  internal::for_each_part(parts_, data->constraints, holding(!u),
                          [&](const ConstraintItem& item, const auto& residual) {
                            internal::calc(*item.constraint->get_residual(), residual, x, u);
                          });
  stack_values(*data, !u);
}

void ConstraintModelManager::differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  prepare("ConstraintModelManager::calcDiff", data, x, u);
  internal::for_each_part(parts_, data->constraints, holding(!u),
                          [&](const ConstraintItem& item, const auto& residual) {
                            internal::calc_diff(*item.constraint->get_residual(), residual, x, u);
                            item.constraint->get_residual()->take_whole(*residual);
                          });
  stack_jacobians(*data, !u);
}

}  // namespace manycontact
