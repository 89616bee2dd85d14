#include <algorithm>
#include <map>
#include <stdexcept>

#include "manycontact/analysis/advice.hpp"
#include "manycontact/analysis/text.hpp"

namespace manycontact {

using text::count;
using text::join;

namespace {

constexpr double kNegligible = 1e-9;  // smaller accelerations, relative to the scene's largest or gravity, are zero

struct State {
  std::vector<std::vector<char>> touched;  // one flag per robot and joint: whether a contact or spring acts on its body
  std::vector<char> robot_touched;
  double negligible = 0;  // accelerations up to this count as zero
};

State read_state(const Scene& scene, const SceneData& data) {
  State s;
  for (const Robot& robot : scene.robots) s.touched.emplace_back(robot.model->joints.size(), 0);
  s.robot_touched.assign(scene.robots.size(), 0);
  const auto touch = [&s](const Attachment& a) {
    if (a.robot < 0) return;
    s.robot_touched[a.robot] = 1;
    if (a.joint >= 0) s.touched[a.robot][a.joint] = 1;
  };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (data.f_offset[c] >= 0) touch(scene.contacts[c].A), touch(scene.contacts[c].B);
  for (const Spring& spring : scene.springs) touch(spring.A), touch(spring.B);
  double largest = scene.gravity.norm();
  for (double a : data.a) largest = std::isnan(a) ? largest : std::max(largest, std::abs(a));
  s.negligible = kNegligible * largest;
  return s;
}

// Returns the roots of the largest subtrees in which `is` is true for all joints. Each root has the number of the other
// joints in its subtree.
template <class Test>
std::vector<std::pair<int, int>> whole_subtrees(const Model& model, Test&& is) {
  std::vector<char> whole(model.joints.size());
  for (int j = model.njoints() - 1; j >= 0; --j) {
    whole[j] = is(j);
    for (int k = j + 1; k < model.subtree_end[j]; ++k) whole[j] = whole[j] && whole[k];
  }
  std::vector<std::pair<int, int>> top;
  for (int j = 0; j < model.njoints(); ++j)
    if (whole[j] && (model.joints[j].parent < 0 || !whole[model.joints[j].parent]))
      top.emplace_back(j, model.subtree_end[j] - j - 1);
  return top;
}

std::vector<std::string> joint_names(const Model& model, const std::vector<std::pair<int, int>>& subtrees) {
  std::vector<std::string> names;
  for (const auto& [joint, beyond] : subtrees)
    names.push_back(model.joints[joint].name + (beyond > 0 ? " (and " + count(beyond, "joint") + " beyond it)" : ""));
  return names;
}

// Returns whether a joint could be locked: it has no contact, no velocity, no significant acceleration, and is no base.
bool idle(const Scene& scene, const SceneData& data, const State& s, int r, int j) {
  const Robot& robot = scene.robots[r];
  const Joint& joint = robot.model->joints[j];
  if (joint.type == JointType::kFloating || s.touched[r][j]) return false;
  const int first = robot.idx_v + joint.idx_v;
  return data.v.segment(first, joint.nv()).isZero(0) &&
         (data.a.segment(first, joint.nv()).array().abs() <= s.negligible).all();  // false for NaN
}

// Collects texts about robots: `items` contains each distinct text once, with the robots to which it applies.
struct Said {
  std::map<std::string, std::size_t> at;
  std::vector<std::pair<std::string, std::vector<int>>> items;
  void add(const std::string& text, int robot) {
    const auto [found, fresh] = at.emplace(text, items.size());
    if (fresh) items.push_back({text, {}});
    items[found->second].second.push_back(robot);
  }
};

void advise_idle(const Scene& scene, const SceneData& data, const State& s, int r, Said& said) {
  const Robot& robot = scene.robots[r];
  const Model& model = *robot.model;
  const auto subtrees = whole_subtrees(model, [&](int j) { return idle(scene, data, s, r, j); });
  int joints = 0;
  for (const auto& subtree : subtrees) joints += 1 + subtree.second;
  if (!s.robot_touched[r] && !model.floating_base && joints == model.njoints()) {
    said.add("the robot is fixed to the world, at rest and without contact: without the robot the solution is the same",
             r);
    return;
  }
  if (!s.robot_touched[r] && model.floating_base) said.add("the robot floats freely, without contact", r);
  const std::vector<std::string> names = joint_names(model, subtrees);
  if (!names.empty())
    said.add(count(joints, "joint") +
                 " could be locked (`<lock>`) without a change of the solution at this state, since these joints have "
                 "no velocity and no acceleration, and no contact beyond them: " +
                 join(names, 20),
             r);
}

void advise_massless(const Scene& scene, int r, Said& said) {
  const Model& model = *scene.robots[r].model;
  const auto massless = [&](int j) {
    const Inertia<double>& Y = model.joints[j].inertia;
    return Y.m == 0 && Y.h.isZero(0) && Y.I.isZero(0);
  };
  const std::vector<std::string> names = joint_names(model, whole_subtrees(model, massless));
  if (!names.empty())
    said.add("there is no mass beyond " + join(names, 20) +
                 ": the inertia matrix is singular there except for armature, unless contacts constrain these joints",
             r);
}

}  // namespace

std::vector<std::string> advise_on_bodies(const Scene& scene, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error("advise_on_bodies: there is no solution, call solve first");
  const State state = read_state(scene, data);
  Said said;
  for (int r = 0; r < scene.nrobots(); ++r) {
    advise_massless(scene, r, said);
    advise_idle(scene, data, state, r, said);
  }
  std::vector<std::string> advice;
  for (const auto& [text, robots] : said.items) advice.push_back(robot_names(scene, robots) + ": " + text);
  return advice;
}

}  // namespace manycontact
