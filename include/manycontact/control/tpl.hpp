#pragma once
// The names with template arguments that code for Crocoddyl may use, such as ShootingProblemTpl<double>. The only
// scalar is double.

#include <concepts>

#include "manycontact/action/tpl.hpp"
#include "manycontact/control/diff_lqr.hpp"
#include "manycontact/control/euler.hpp"
#include "manycontact/control/free_fwddyn.hpp"
#include "manycontact/control/impulse_fwddyn.hpp"
#include "manycontact/control/lqr.hpp"
#include "manycontact/control/num_diff.hpp"
#include "manycontact/control/rk.hpp"
#include "manycontact/control/shooting.hpp"
#include "manycontact/control/unicycle.hpp"

namespace manycontact {
// clang-format off

template <std::same_as<double> Scalar> using ActionDataAbstractTpl = ActionDataAbstract;
template <std::same_as<double> Scalar> using ActionModelAbstractTpl = ActionModelAbstract;
template <std::same_as<double> Scalar> using ActionDataImpulseFwdDynamicsTpl = ActionDataImpulseFwdDynamics;
template <std::same_as<double> Scalar> using ActionModelImpulseFwdDynamicsTpl = ActionModelImpulseFwdDynamics;
template <std::same_as<double> Scalar> using ActionModelLQRTpl = ActionModelLQR;
template <std::same_as<double> Scalar> using ActionDataNumDiffTpl = ActionDataNumDiff;
template <std::same_as<double> Scalar> using ActionModelNumDiffTpl = ActionModelNumDiff;
template <std::same_as<double> Scalar> using ActionModelUnicycleTpl = ActionModelUnicycle;
template <std::same_as<double> Scalar> using ControlParametrizationDataAbstractTpl = ControlParametrizationDataAbstract;
template <std::same_as<double> Scalar> using ControlParametrizationModelAbstractTpl = ControlParametrizationModelAbstract;
template <std::same_as<double> Scalar> using ControlParametrizationModelPolyOneTpl = ControlParametrizationModelPolyOne;
template <std::same_as<double> Scalar> using ControlParametrizationModelPolyTwoRKTpl = ControlParametrizationModelPolyTwoRK;
template <std::same_as<double> Scalar> using ControlParametrizationModelPolyZeroTpl = ControlParametrizationModelPolyZero;
template <std::same_as<double> Scalar> using DifferentialActionDataFreeFwdDynamicsTpl = DifferentialActionDataFreeFwdDynamics;
template <std::same_as<double> Scalar> using DifferentialActionModelFreeFwdDynamicsTpl = DifferentialActionModelFreeFwdDynamics;
template <std::same_as<double> Scalar> using DifferentialActionModelLQRTpl = DifferentialActionModelLQR;
template <std::same_as<double> Scalar> using ControlParametrizationModelNumDiffTpl = ControlParametrizationModelNumDiff;
template <std::same_as<double> Scalar> using ControlParametrizationDataNumDiffTpl = ControlParametrizationDataNumDiff;
template <std::same_as<double> Scalar> using IntegratedActionDataEulerTpl = IntegratedActionDataEuler;
template <std::same_as<double> Scalar> using IntegratedActionDataRKTpl = IntegratedActionDataRK;
template <std::same_as<double> Scalar> using IntegratedActionModelAbstractTpl = IntegratedActionModelAbstract;
template <std::same_as<double> Scalar> using IntegratedActionModelEulerTpl = IntegratedActionModelEuler;
template <std::same_as<double> Scalar> using IntegratedActionModelRKTpl = IntegratedActionModelRK;
template <std::same_as<double> Scalar> using ShootingProblemTpl = ShootingProblem;
template <std::same_as<double> Scalar> using StateVectorTpl = StateVector;

// clang-format on
}  // namespace manycontact
