# Writes manycontact/action/tpl.hpp and manycontact/control/tpl.hpp into the build: names with template arguments that code
# for Crocoddyl may use, such as StateMultibodyTpl<double>. The only scalar is double.
function(write_tpl module includes names)
  set(text "#pragma once\n// The names with template arguments that code for Crocoddyl may use, such as StateMultibodyTpl<double>.\n")
  string(APPEND text "// The only scalar is double. The build has written this header.\n\n#include <concepts>\n\n")
  foreach(header IN LISTS includes)
    string(APPEND text "#include \"manycontact/${header}.hpp\"\n")
  endforeach()
  string(APPEND text "\nnamespace manycontact {\n\n")
  foreach(name IN LISTS names)
    set(meant ${name})
    if(name STREQUAL "SE3")
      set(meant "SE3<Scalar>")
    endif()
    string(APPEND text "template <std::same_as<double> Scalar> using ${name}Tpl = ${meant};\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/manycontact/${module}/tpl.hpp
       CONTENT "${text}\n}  // namespace manycontact\n" @ONLY)
endfunction()

set(includes
    action/contact_fwddyn action/impulse action/num_diff detail/action/num_diff_parts action/residuals/centroidal_residuals
    action/residuals/contact_residuals action/residuals/frame_residuals action/residuals/gravity_residuals
    action/residuals/impulse_residuals action/residuals/state_residuals action/squashing action/thrusters)
set(names
    ActivationDataAbstract ActivationModelAbstract ActivationModelQuad ActivationModelWeightedQuad ActivationBounds
    ActivationModelQuadraticBarrier ActivationModelWeightedQuadraticBarrier ActivationModelSmooth1Norm
    ActivationModelSmoothAbs ActivationModelSmooth2Norm ActivationModel2NormBarrier ActivationModelQuadFlatExp
    ActivationModelQuadFlatLog ActuationDataAbstract ActuationModelAbstract ActuationModelSelection ActuationModelFull
    ActuationModelFloatingBase DataCollector DataCollectorAbstract FrictionCone WrenchCone CoPSupport
    DataCollectorMultibodyInImpulse ImpulseDataAbstract ImpulseDataMultiple ImpulseItem ImpulseModelAbstract
    ImpulseModel3D ImpulseModel6D ImpulseModelOfScene ImpulseModelMultiple ResidualModelImpulseCoM
    ConstraintModelResidual ConstraintModelAbstract ConstraintItem ConstraintDataManager ConstraintModelManager
    ForceDataAbstract ContactDataAbstract ContactModelAbstract ContactModel1D ContactModel2D ContactModel3D
    ContactModel5D ContactModel6D ContactModelBetweenBodies ContactModelOfScene ContactItem ContactDataMultiple
    ContactModelMultiple CostDataResidual CostModelResidual CostDataAbstract CostModelAbstract CostItem CostDataSum
    CostModelSum DifferentialActionDataAbstract DifferentialActionModelAbstract
    DifferentialActionDataContactFwdDynamics DifferentialActionModelContactFwdDynamics DifferentialActionDataNumDiff
    DifferentialActionModelNumDiff SE3 Motion Force MathBase Multibody StateAbstract StateMultibody
    ResidualDataAbstract ResidualModelAbstract ResidualModelCoMPosition ResidualModelCentroidalMomentum
    ResidualModelContactForce ResidualModelContactFrictionCone ResidualModelContactWrenchCone
    ResidualModelContactCoPPosition ResidualModelFramePlacement ResidualModelFrameTranslation
    ResidualModelFrameRotation ResidualModelFrameVelocity ResidualModelControlGrav ResidualModelContactControlGrav
    ResidualModelState ResidualModelControl ResidualModelJointEffort ResidualModelJointAcceleration
    ConstraintDataResidual SquashingDataAbstract SquashingModelAbstract SquashingModelSmoothSat
    ActuationSquashingModel ActuationSquashingData Thruster ActuationModelFloatingBaseThrusters StateNumDiff
    ActivationModelNumDiff ActivationDataNumDiff ActuationModelNumDiff ActuationDataNumDiff ResidualModelNumDiff
    ResidualDataNumDiff CostModelNumDiff ConstraintModelNumDiff ContactModelNumDiff ConstraintDataAbstract
    DataCollectorContact DataCollectorImpulse DataCollectorMultibody DataCollectorActMultibody
    DataCollectorMultibodyInContact DataCollectorActMultibodyInContact)
write_tpl(action "${includes}" "${names}")

set(includes
    action/tpl control/diff_lqr control/euler control/free_fwddyn control/impulse_fwddyn control/lqr control/num_diff
    control/rk control/shooting control/unicycle)
set(names
    ActionDataAbstract ActionModelAbstract ActionDataImpulseFwdDynamics ActionModelImpulseFwdDynamics ActionModelLQR
    ActionDataNumDiff ActionModelNumDiff ActionModelUnicycle ControlParametrizationDataAbstract
    ControlParametrizationModelAbstract ControlParametrizationModelPolyOne ControlParametrizationModelPolyTwoRK
    ControlParametrizationModelPolyZero DifferentialActionDataFreeFwdDynamics DifferentialActionModelFreeFwdDynamics
    DifferentialActionModelLQR ControlParametrizationModelNumDiff ControlParametrizationDataNumDiff
    IntegratedActionDataEuler IntegratedActionDataRK IntegratedActionModelAbstract IntegratedActionModelEuler
    IntegratedActionModelRK ShootingProblem StateVector)
write_tpl(control "${includes}" "${names}")
