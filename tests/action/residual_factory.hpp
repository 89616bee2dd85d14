#pragma once
// Every residual with every option, for tests that compare derivatives with differences.

#include <map>

#include "manycontact/action/contact.hpp"
#include "manycontact/action/residuals/centroidal_residuals.hpp"
#include "manycontact/action/residuals/contact_residuals.hpp"
#include "manycontact/action/residuals/frame_residuals.hpp"
#include "manycontact/action/residuals/gravity_residuals.hpp"
#include "manycontact/action/residuals/state_residuals.hpp"
#include "support/random.hpp"

namespace manycontact::test {

struct NamedResidual {
  std::string name;  // "FrameVelocity_world_1"
  std::shared_ptr<ResidualModelAbstract> residual;
};

namespace factory {

struct Builder {
  std::shared_ptr<StateMultibody> state;
  std::shared_ptr<ActuationModelAbstract> actuation;
  std::size_t nu;
  std::mt19937 rng;
  std::vector<NamedResidual> all;

  Eigen::VectorXd numbers(std::size_t n) { return random_vector(static_cast<int>(n), rng); }
  template <class Residual, class... Arguments>
  void add(const std::string& name, Arguments&&... arguments) {
    all.push_back({name, std::make_shared<Residual>(state, std::forward<Arguments>(arguments)...)});
  }

  void states() {
    add<ResidualModelState>("State", state->rand(), nu);
    add<ResidualModelState>("State_zero", nu);
    add<ResidualModelControl>("Control", numbers(nu));
    add<ResidualModelControl>("Control_zero", nu);
    add<ResidualModelJointEffort>("JointEffort", actuation, numbers(nu), nu);
    add<ResidualModelJointEffort>("JointEffort_zero", actuation);
    add<ResidualModelJointAcceleration>("JointAcceleration", numbers(state->get_nv()), nu);
    add<ResidualModelJointAcceleration>("JointAcceleration_zero", nu);
    add<ResidualModelControlGrav>("ControlGrav", nu);
    add<ResidualModelContactControlGrav>("ContactControlGrav", nu);
  }

  void frame(FrameIndex id, const std::string& suffix) {
    add<ResidualModelFramePlacement>("FramePlacement" + suffix, id, random_placement(rng), nu);
    add<ResidualModelFrameTranslation>("FrameTranslation" + suffix, id, Eigen::Vector3d(numbers(3)), nu);
    add<ResidualModelFrameRotation>("FrameRotation" + suffix, id, random_rotation(rng), nu);
    add<ResidualModelFrameVelocity>("FrameVelocity_local" + suffix, id, Vec6<double>(numbers(6)), LOCAL, nu);
    add<ResidualModelFrameVelocity>("FrameVelocity_world" + suffix, id, Vec6<double>(numbers(6)), WORLD, nu);
    add<ResidualModelFrameVelocity>("FrameVelocity_aligned" + suffix, id, Vec6<double>(numbers(6)), LOCAL_WORLD_ALIGNED,
                                    nu);
  }

  // Selects for each robot the frame that most coordinates move, and a random one.
  void frames() {
    const Multibody& model = *state->get_model();
    for (int r = 0; r < model.scene().nrobots(); ++r) {
      std::vector<FrameIndex> of_robot;
      FrameIndex deepest = model.frames.size();
      std::size_t longest = 0;
      for (FrameIndex id = 0; id < model.frames.size(); ++id) {
        if (model.frames[id].robot != r) continue;
        of_robot.push_back(id);
        const std::size_t n = dof_chain(*model.scene().robots[r].model, model.frames[id].joint).size();
        if (n > longest) longest = n, deepest = id;
      }
      if (longest > 0) frame(deepest, "_" + std::to_string(r));
      if (!of_robot.empty())
        frame(of_robot[std::uniform_int_distribution<std::size_t>(0, of_robot.size() - 1)(rng)],
              "_any_" + std::to_string(r));
    }
  }

  void centroidal() {
    add<ResidualModelCoMPosition>("CoMPosition", Eigen::Vector3d(numbers(3)), nu);
    add<ResidualModelCentroidalMomentum>("CentroidalMomentum", Vec6<double>(numbers(6)), nu);
    const std::vector<Robot>& robots = state->get_model()->scene().robots;
    for (int r = 0; r < static_cast<int>(robots.size()); ++r) {
      double mass = 0;
      for (const Joint& joint : robots[r].model->joints) mass += joint.inertia.m;
      if (mass <= 0) continue;
      const std::string suffix = "_" + std::to_string(r);
      add<ResidualModelCoMPosition>("CoMPosition" + suffix, Eigen::Vector3d(numbers(3)), nu, r);
      add<ResidualModelCentroidalMomentum>("CentroidalMomentum" + suffix, Vec6<double>(numbers(6)), nu, r);
    }
  }

  void contact(const std::string& name, const ContactModelAbstract& model) {
    const FrameIndex id = model.get_id();
    const double mu = uniform(rng, 0.2, 1);
    const Eigen::Vector2d box(uniform(rng, 0.05, 0.3), uniform(rng, 0.05, 0.3));
    add<ResidualModelContactForce>("ContactForce_" + name, id, Vec6<double>(numbers(6)), model.get_nc(), nu);
    add<ResidualModelContactFrictionCone>("ContactFrictionCone_" + name, id, FrictionCone(random_rotation(rng), mu),
                                          nu);
    add<ResidualModelContactFrictionCone>("ContactFrictionCone_outer_" + name, id,
                                          FrictionCone(random_rotation(rng), mu, 6, false, 1, 100), nu);
    const auto in_axes = [&](ConeAxes axes) {
      std::dynamic_pointer_cast<ContactResidual>(all.back().residual)->set_axes(axes);
    };
    for (const auto& [axes, of] : {std::pair(ConeAxes::kFoot, "foot_"), std::pair(ConeAxes::kWorld, "world_"),
                                   std::pair(ConeAxes::kOther, "other_")}) {
      add<ResidualModelContactFrictionCone>("ContactFrictionCone_" + std::string(of) + name, id,
                                            FrictionCone(random_rotation(rng), mu), nu);
      in_axes(axes);
    }
    if (model.get_contact().type != ContactType::k6D) return;
    add<ResidualModelContactWrenchCone>("ContactWrenchCone_" + name, id, WrenchCone(random_rotation(rng), mu, box), nu);
    add<ResidualModelContactWrenchCone>("ContactWrenchCone_outer_" + name, id,
                                        WrenchCone(random_rotation(rng), mu, box, 8, false), nu);
    add<ResidualModelContactWrenchCone>("ContactWrenchCone_world_" + name, id,
                                        WrenchCone(random_rotation(rng), mu, box), nu);
    in_axes(ConeAxes::kWorld);
    add<ResidualModelContactCoPPosition>("ContactCoPPosition_" + name, id, CoPSupport(random_rotation(rng), box), nu);
  }

  void contact_stack(const ContactModelMultiple& contacts) {
    std::map<FrameIndex, int> count;  // a residual finds its contact by the frame
    for (const auto& [name, item] : contacts.get_contacts()) ++count[item->contact->get_id()];
    for (const auto& [name, item] : contacts.get_contacts())
      if (count[item->contact->get_id()] == 1) contact(name, *item->contact);
  }
};

}  // namespace factory

/// Returns all residuals for a state, an actuation of nu controls and an action's contacts; the seed determines them.
inline std::vector<NamedResidual> all_residuals(const std::shared_ptr<StateMultibody>& state,
                                                const std::shared_ptr<ActuationModelAbstract>& actuation,
                                                const ContactModelMultiple& contacts, unsigned seed) {
  factory::Builder builder{state, actuation, actuation->get_nu(), std::mt19937(seed), {}};
  builder.states();
  builder.frames();
  builder.centroidal();
  builder.contact_stack(contacts);
  return std::move(builder.all);
}

}  // namespace manycontact::test
