#pragma once
// The names with template arguments that code for Crocoddyl may use, such as StateMultibodyTpl<double>.

#include <concepts>

#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/action/impulse.hpp"
#include "manycontact/action/num_diff.hpp"
#include "manycontact/action/num_diff_parts.hpp"
#include "manycontact/action/residuals/centroidal_residuals.hpp"
#include "manycontact/action/residuals/contact_residuals.hpp"
#include "manycontact/action/residuals/frame_residuals.hpp"
#include "manycontact/action/residuals/gravity_residuals.hpp"
#include "manycontact/action/residuals/impulse_residuals.hpp"
#include "manycontact/action/residuals/state_residuals.hpp"
#include "manycontact/action/squashing.hpp"
#include "manycontact/action/thrusters.hpp"

namespace manycontact {
// clang-format off

template <std::same_as<double> Scalar> using ActivationDataAbstractTpl = ActivationDataAbstract;
template <std::same_as<double> Scalar> using ActivationModelAbstractTpl = ActivationModelAbstract;
template <std::same_as<double> Scalar> using ActivationModelQuadTpl = ActivationModelQuad;
template <std::same_as<double> Scalar> using ActivationModelWeightedQuadTpl = ActivationModelWeightedQuad;
template <std::same_as<double> Scalar> using ActivationBoundsTpl = ActivationBounds;
template <std::same_as<double> Scalar> using ActivationModelQuadraticBarrierTpl = ActivationModelQuadraticBarrier;
template <std::same_as<double> Scalar> using ActivationModelWeightedQuadraticBarrierTpl = ActivationModelWeightedQuadraticBarrier;
template <std::same_as<double> Scalar> using ActivationModelSmooth1NormTpl = ActivationModelSmooth1Norm;
template <std::same_as<double> Scalar> using ActivationModelSmoothAbsTpl = ActivationModelSmoothAbs;
template <std::same_as<double> Scalar> using ActivationModelSmooth2NormTpl = ActivationModelSmooth2Norm;
template <std::same_as<double> Scalar> using ActivationModel2NormBarrierTpl = ActivationModel2NormBarrier;
template <std::same_as<double> Scalar> using ActivationModelQuadFlatExpTpl = ActivationModelQuadFlatExp;
template <std::same_as<double> Scalar> using ActivationModelQuadFlatLogTpl = ActivationModelQuadFlatLog;

template <std::same_as<double> Scalar> using ActuationDataAbstractTpl = ActuationDataAbstract;
template <std::same_as<double> Scalar> using ActuationModelAbstractTpl = ActuationModelAbstract;
template <std::same_as<double> Scalar> using ActuationModelSelectionTpl = ActuationModelSelection;
template <std::same_as<double> Scalar> using ActuationModelFullTpl = ActuationModelFull;
template <std::same_as<double> Scalar> using ActuationModelFloatingBaseTpl = ActuationModelFloatingBase;

template <std::same_as<double> Scalar> using DataCollectorTpl = DataCollector;
template <std::same_as<double> Scalar> using DataCollectorAbstractTpl = DataCollectorAbstract;

template <std::same_as<double> Scalar> using FrictionConeTpl = FrictionCone;
template <std::same_as<double> Scalar> using WrenchConeTpl = WrenchCone;
template <std::same_as<double> Scalar> using CoPSupportTpl = CoPSupport;

template <std::same_as<double> Scalar> using DataCollectorMultibodyInImpulseTpl = DataCollectorMultibodyInImpulse;
template <std::same_as<double> Scalar> using ImpulseDataAbstractTpl = ImpulseDataAbstract;
template <std::same_as<double> Scalar> using ImpulseDataMultipleTpl = ImpulseDataMultiple;
template <std::same_as<double> Scalar> using ImpulseItemTpl = ImpulseItem;
template <std::same_as<double> Scalar> using ImpulseModelAbstractTpl = ImpulseModelAbstract;
template <std::same_as<double> Scalar> using ImpulseModel3DTpl = ImpulseModel3D;
template <std::same_as<double> Scalar> using ImpulseModel6DTpl = ImpulseModel6D;
template <std::same_as<double> Scalar> using ImpulseModelOfSceneTpl = ImpulseModelOfScene;
template <std::same_as<double> Scalar> using ImpulseModelMultipleTpl = ImpulseModelMultiple;
template <std::same_as<double> Scalar> using ResidualModelImpulseCoMTpl = ResidualModelImpulseCoM;
template <std::same_as<double> Scalar> using ConstraintModelResidualTpl = ConstraintModelResidual;
template <std::same_as<double> Scalar> using ConstraintModelAbstractTpl = ConstraintModelAbstract;
template <std::same_as<double> Scalar> using ConstraintItemTpl = ConstraintItem;
template <std::same_as<double> Scalar> using ConstraintDataManagerTpl = ConstraintDataManager;
template <std::same_as<double> Scalar> using ConstraintModelManagerTpl = ConstraintModelManager;

template <std::same_as<double> Scalar> using ForceDataAbstractTpl = ForceDataAbstract;
template <std::same_as<double> Scalar> using ContactDataAbstractTpl = ContactDataAbstract;
template <std::same_as<double> Scalar> using ContactModelAbstractTpl = ContactModelAbstract;
template <std::same_as<double> Scalar> using ContactModel1DTpl = ContactModel1D;
template <std::same_as<double> Scalar> using ContactModel2DTpl = ContactModel2D;
template <std::same_as<double> Scalar> using ContactModel3DTpl = ContactModel3D;
template <std::same_as<double> Scalar> using ContactModel5DTpl = ContactModel5D;
template <std::same_as<double> Scalar> using ContactModel6DTpl = ContactModel6D;
template <std::same_as<double> Scalar> using ContactModelBetweenBodiesTpl = ContactModelBetweenBodies;
template <std::same_as<double> Scalar> using ContactModelOfSceneTpl = ContactModelOfScene;
template <std::same_as<double> Scalar> using ContactItemTpl = ContactItem;
template <std::same_as<double> Scalar> using ContactDataMultipleTpl = ContactDataMultiple;
template <std::same_as<double> Scalar> using ContactModelMultipleTpl = ContactModelMultiple;

template <std::same_as<double> Scalar> using CostDataResidualTpl = CostDataResidual;
template <std::same_as<double> Scalar> using CostModelResidualTpl = CostModelResidual;
template <std::same_as<double> Scalar> using CostDataAbstractTpl = CostDataAbstract;
template <std::same_as<double> Scalar> using CostModelAbstractTpl = CostModelAbstract;
template <std::same_as<double> Scalar> using CostItemTpl = CostItem;
template <std::same_as<double> Scalar> using CostDataSumTpl = CostDataSum;
template <std::same_as<double> Scalar> using CostModelSumTpl = CostModelSum;

template <std::same_as<double> Scalar> using DifferentialActionDataAbstractTpl = DifferentialActionDataAbstract;
template <std::same_as<double> Scalar> using DifferentialActionModelAbstractTpl = DifferentialActionModelAbstract;
template <std::same_as<double> Scalar> using DifferentialActionDataContactFwdDynamicsTpl = DifferentialActionDataContactFwdDynamics;
template <std::same_as<double> Scalar> using DifferentialActionModelContactFwdDynamicsTpl = DifferentialActionModelContactFwdDynamics;
template <std::same_as<double> Scalar> using DifferentialActionDataNumDiffTpl = DifferentialActionDataNumDiff;
template <std::same_as<double> Scalar> using DifferentialActionModelNumDiffTpl = DifferentialActionModelNumDiff;

template <std::same_as<double> Scalar> using SE3Tpl = SE3<Scalar>;
template <std::same_as<double> Scalar> using MotionTpl = Motion;
template <std::same_as<double> Scalar> using ForceTpl = Force;

template <std::same_as<double> Scalar> using MathBaseTpl = MathBase;
template <std::same_as<double> Scalar> using MultibodyTpl = Multibody;
template <std::same_as<double> Scalar> using StateAbstractTpl = StateAbstract;
template <std::same_as<double> Scalar> using StateMultibodyTpl = StateMultibody;

template <std::same_as<double> Scalar> using ResidualDataAbstractTpl = ResidualDataAbstract;
template <std::same_as<double> Scalar> using ResidualModelAbstractTpl = ResidualModelAbstract;
template <std::same_as<double> Scalar> using ResidualModelCoMPositionTpl = ResidualModelCoMPosition;
template <std::same_as<double> Scalar> using ResidualModelCentroidalMomentumTpl = ResidualModelCentroidalMomentum;
template <std::same_as<double> Scalar> using ResidualModelContactForceTpl = ResidualModelContactForce;
template <std::same_as<double> Scalar> using ResidualModelContactFrictionConeTpl = ResidualModelContactFrictionCone;
template <std::same_as<double> Scalar> using ResidualModelContactWrenchConeTpl = ResidualModelContactWrenchCone;
template <std::same_as<double> Scalar> using ResidualModelContactCoPPositionTpl = ResidualModelContactCoPPosition;
template <std::same_as<double> Scalar> using ResidualModelFramePlacementTpl = ResidualModelFramePlacement;
template <std::same_as<double> Scalar> using ResidualModelFrameTranslationTpl = ResidualModelFrameTranslation;
template <std::same_as<double> Scalar> using ResidualModelFrameRotationTpl = ResidualModelFrameRotation;
template <std::same_as<double> Scalar> using ResidualModelFrameVelocityTpl = ResidualModelFrameVelocity;
template <std::same_as<double> Scalar> using ResidualModelControlGravTpl = ResidualModelControlGrav;
template <std::same_as<double> Scalar> using ResidualModelContactControlGravTpl = ResidualModelContactControlGrav;
template <std::same_as<double> Scalar> using ResidualModelStateTpl = ResidualModelState;
template <std::same_as<double> Scalar> using ResidualModelControlTpl = ResidualModelControl;
template <std::same_as<double> Scalar> using ResidualModelJointEffortTpl = ResidualModelJointEffort;
template <std::same_as<double> Scalar> using ResidualModelJointAccelerationTpl = ResidualModelJointAcceleration;


template <std::same_as<double> Scalar> using ConstraintDataResidualTpl = ConstraintDataResidual;
template <std::same_as<double> Scalar> using SquashingDataAbstractTpl = SquashingDataAbstract;
template <std::same_as<double> Scalar> using SquashingModelAbstractTpl = SquashingModelAbstract;
template <std::same_as<double> Scalar> using SquashingModelSmoothSatTpl = SquashingModelSmoothSat;
template <std::same_as<double> Scalar> using ActuationSquashingModelTpl = ActuationSquashingModel;
template <std::same_as<double> Scalar> using ActuationSquashingDataTpl = ActuationSquashingData;
template <std::same_as<double> Scalar> using ThrusterTpl = Thruster;
template <std::same_as<double> Scalar> using ActuationModelFloatingBaseThrustersTpl = ActuationModelFloatingBaseThrusters;
template <std::same_as<double> Scalar> using StateNumDiffTpl = StateNumDiff;
template <std::same_as<double> Scalar> using ActivationModelNumDiffTpl = ActivationModelNumDiff;
template <std::same_as<double> Scalar> using ActivationDataNumDiffTpl = ActivationDataNumDiff;
template <std::same_as<double> Scalar> using ActuationModelNumDiffTpl = ActuationModelNumDiff;
template <std::same_as<double> Scalar> using ActuationDataNumDiffTpl = ActuationDataNumDiff;
template <std::same_as<double> Scalar> using ResidualModelNumDiffTpl = ResidualModelNumDiff;
template <std::same_as<double> Scalar> using ResidualDataNumDiffTpl = ResidualDataNumDiff;
template <std::same_as<double> Scalar> using CostModelNumDiffTpl = CostModelNumDiff;
template <std::same_as<double> Scalar> using ConstraintModelNumDiffTpl = ConstraintModelNumDiff;
template <std::same_as<double> Scalar> using ContactModelNumDiffTpl = ContactModelNumDiff;
template <std::same_as<double> Scalar> using ConstraintDataAbstractTpl = ConstraintDataAbstract;
template <std::same_as<double> Scalar> using DataCollectorContactTpl = DataCollectorContact;
template <std::same_as<double> Scalar> using DataCollectorImpulseTpl = DataCollectorImpulse;
template <std::same_as<double> Scalar> using DataCollectorMultibodyTpl = DataCollectorMultibody;
template <std::same_as<double> Scalar> using DataCollectorActMultibodyTpl = DataCollectorActMultibody;
template <std::same_as<double> Scalar> using DataCollectorMultibodyInContactTpl = DataCollectorMultibodyInContact;
template <std::same_as<double> Scalar> using DataCollectorActMultibodyInContactTpl = DataCollectorActMultibodyInContact;

// clang-format on
}  // namespace manycontact
