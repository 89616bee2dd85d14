#pragma once
// Implements InterfaceContacts with packs S = Pack<W>, for W contacts at a time.

#include <array>

#include "arrays.hpp"
#include "lanes.hpp"
#include "manycontact/detail/contact/derivatives.hpp"

namespace manycontact::lanes {

template <class S>
class InterfaceContactsOf final : public InterfaceContacts {
 public:
  InterfaceContactsOf(const Scene& scene, const Contact& contact, const ContactSupport& support)
      : support_(support),
        A_(*scene.robots[contact.A.robot].model, support.a),
        B_(*scene.robots[contact.B.robot].model, support.b),
        rows_(contact, support),
        terms_(scene, contact, support),
        f_(contact.rows()),
        out_(JoinTerms::size(contact.rows(), support.cols())) {}

  void evaluate(const Vec3<double>& gravity, std::span<Rows> rows) override {
    const Contact& contact = *rows.front().contact;
    A_.load(rows, contact.A.joint, A_.joined(), [](const Rows& r) { return std::pair(&r.contact->A, r.A); });
    B_.load(rows, contact.B.joint, B_.joined(), [](const Rows& r) { return std::pair(&r.contact->B, r.B); });
    evaluate_between(gravity, rows);
    double* to[8];
    const int at_A = static_cast<int>(rows_.J.rows() * support_.a.size());
    store_arrays(rows_.J.data(), at_A, side_by_side(rows, to, [](const Rows& r) { return r.A; }));
    store_arrays(rows_.J.data() + at_A, static_cast<int>(rows_.J.size()) - at_A,
                 side_by_side(rows, to, [](const Rows& r) { return r.B; }));
    store_arrays(rows_.a0.data(), contact.rows(), side_by_side(rows, to, [](const Rows& r) { return r.a0; }));
    if (rows_.pair)
      store_arrays(rows_.left.data(), static_cast<int>(rows_.left.size()),
                   side_by_side(rows, to, [](const Rows& r) { return r.left; }));
    const S smallest = smallest_row(rows_), motion = motion_scale(contact, rows_);
    for (std::size_t l = 0; l < rows.size(); ++l) {
      const int lane = static_cast<int>(l);
      rows[l].smallest_row = smallest[lane];
      rows[l].motion = motion[lane];
    }
  }

  void differentiate(const Vec3<double>& gravity, std::span<const Derivatives> rows) override {
    using Rows = Derivatives;
    const Contact& contact = *rows.front().contact;
    A_.load(rows, contact.A.joint, A_.moving(), [](const Rows& r) { return std::pair(&r.contact->A, r.A); });
    B_.load(rows, contact.B.joint, B_.moving(), [](const Rows& r) { return std::pair(&r.contact->B, r.B); });
    evaluate_between(gravity, rows);
    const double* from[8];
    load_arrays(side_by_side(rows, from, [](const Rows& r) { return r.f; }), contact.rows(), f_.data());
    contact_derivatives<S>(contact, support_, A_.kin, &B_.kin, A_.rnea, &B_.rnea, f_, rows_, terms_);
    collect(contact.rows());
    double* to[8];
    store_arrays(out_.data(), static_cast<int>(out_.size()),
                 side_by_side(rows, to, [](const Rows& r) { return r.terms; }));
    const Vec6<S> F_A = rows_.aMA.act_force(terms_.F), F_B = -rows_.bMA.act_force(terms_.F);
    const int a = static_cast<int>(support_.a.size()), n = contact.rows(), cols = support_.cols();
    for (const bool B : {false, true}) {
      const auto end = side_by_side(rows, to, [B](const Rows& r) { return B ? r.B : r.A; });
      const int first = B ? a : 0, count = B ? cols - a : a, ld = JoinTerms::padded(cols);
      const auto put = [&](const S* numbers, int many) {
        store_arrays(numbers, many, end);
        for (std::size_t l = 0; l < rows.size(); ++l) to[l] += many;
      };
      put((B ? F_B : F_A).data(), 6);
      put(rows_.Jl.data() + 6 * first, 6 * count);
      for (int e = 0; e < 6; ++e) put(out_.data() + 3 * n * cols + 6 * n + ((B ? 6 : 0) + e) * ld + first, count);
    }
  }

 private:
  struct End {  // one of the coupled robots: terms for the contact's rows, and the contact's frame on its body
    Kinematics<S> kin;
    std::vector<std::pair<int, int>> stretches;  // ranges [begin, end) of coordinates that move the body
    SE3<S> on_body;
    RneaDerivativesOf<S> rnea;  // used for Psid, Psidd, Sv only

    End(const Model& model, const std::vector<int>& coordinates) : kin(model), rnea(model) {
      for (int i : coordinates) {
        if (stretches.empty() || stretches.back().second != i) stretches.emplace_back(i, i);
        stretches.back().second = i + 1;
      }
    }
    std::array<Mat6X<S>*, 1> joined() { return {&kin.J}; }
    std::array<Mat6X<S>*, 4> moving() { return {&kin.J, &rnea.Psid, &rnea.Psidd, &rnea.Sv}; }
    // Loads the ends of all contacts on this side. columns: copies of the columns of JoinedEnd or MovingEnd.
    template <class Row, class Of>
    void load(std::span<Row> rows, int joint, std::span<Mat6X<S>* const> columns, Of&& end) {
      const double* from[8];
      load_arrays(side_by_side(rows, from, [&](const auto& r) { return end(r).first->placement.R.data(); }), 12,
                  on_body.R.data());
      int next = 0;
      const auto load = [&](int count, S* to) {
        load_arrays(side_by_side(rows, from, [&](const auto& r) -> const double* { return end(r).second + next; }),
                    count, to);
        next += count;
      };
      load(6, origin_numbers(kin, joint));
      load(12, kin.oMi[joint].R.data());
      load(6, kin.v[joint].data());
      load(6, kin.a[joint].data());
      for (Mat6X<S>* of : columns)
        for (const auto& [first, past] : stretches) load(6 * (past - first), of->col(first).data());
    }
    PlacedEnd<S> placed(int joint) const { return {kin.oMi[joint] * on_body, origin_at<S>(kin, joint)}; }
  };

  template <class Row>
  void evaluate_between(const Vec3<double>& gravity, std::span<Row> all) {
    const Contact& contact = *all.front().contact;
    if (rows_.pair)
      load_pair<S>(
          all, [](const auto& r) -> const Contact& { return *r.contact; }, rows_, common_pair_);
    rows_between<S>(gravity, contact, support_, A_.kin, A_.placed(contact.A.joint), A_.on_body.p, B_.kin,
                    B_.placed(contact.B.joint), B_.on_body.p, rows_);
  }

  void collect(int n) {  // collects JoinTerms from rows_ and terms_ in out_
    const int a = static_cast<int>(support_.a.size()), cols = support_.cols();
    const int ld = JoinTerms::padded(cols);
    using Block = Eigen::Map<MatX<S>>;
    S* next = out_.data();
    const auto take = [&next](int rows, int columns) {
      S* at = next;
      next += rows * columns;
      return Block(at, rows, columns);
    };
    take(n, cols) = rows_.J;
    take(n, 6) = rows_.W;
    Block dq = take(n, cols), dv = take(n, cols), D_A = take(ld, 6), D_B = take(ld, 6);  // D_A, D_B transposed
    D_A.setZero(), D_B.setZero();
    for (int k = 0; k < cols; ++k) {
      dq.col(k) = -(rows_.W * terms_.dx_dq.col(k));
      dv.col(k) = -(rows_.W * terms_.dx_dv.col(k));
      D_B.row(k) = cross_force(Vec6<S>(rows_.Jl.col(k)), terms_.F).transpose();
    }
    for (int k = 0; terms_.turns && k < a; ++k) {
      const Vec3<S> turn = terms_.turn.col(k);
      dq.col(k) -= rows_.W * turned<S>(turn, terms_.x);
      D_A.row(k) = -turned<S>(turn, terms_.F).transpose();
      D_B.row(k) += D_A.row(k);
    }
  }

  ContactSupport support_;
  End A_, B_;
  ContactData<S> rows_;
  const PairNumbers<double>* common_pair_ = nullptr;  // terms that all elements share, or nullptr (load_pair)
  ContactDerivativesOf<S> terms_;
  VecX<S> f_;
  std::vector<S> out_;
};

}  // namespace manycontact::lanes
