#include "manycontact/analysis/names.hpp"

#include <stdexcept>

#include "manycontact/analysis/text.hpp"

namespace manycontact {

namespace {

constexpr std::size_t kMostNames = 4, kMostNeighbours = 3;

const Frame* nearest_frame(const Model& model, int joint, const Vec3<double>& point) {
  const Frame* nearest = nullptr;
  const auto distance = [&point](const Frame& frame) { return (frame.placement.p - point).norm(); };
  for (const Frame& frame : model.frames)
    if (frame.joint == joint && (!nearest || distance(frame) < distance(*nearest) - 1e-9)) nearest = &frame;
  return nearest;
}

// Returns names of the numbered items. Runs of more than kMostNeighbours consecutive numbers for which together(...) is
// true are abbreviated as "first .. last".
template <class Name, class Together>
std::vector<std::string> in_runs(const std::vector<int>& numbers, Name&& name, Together&& together) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1 && together(numbers[i], numbers[end])) ++end;
    if (end - i > kMostNeighbours) {
      names.push_back(name(numbers[i]) + " .. " + name(numbers[end - 1]));
      i = end;
    }
    for (; i < end; ++i) names.push_back(name(numbers[i]));
  }
  return names;
}

// Returns "robot/frame" of the frame that an attachment was made from; "" if the frame is unknown.
std::string frame_name(const Scene& scene, const Attachment& at) {
  return at.frame.empty() || at.robot < 0 ? at.frame : scene.robots[at.robot].name + "/" + at.frame;
}

}  // namespace

Body body_of(const Attachment& a) { return a.joint < 0 ? Body{} : Body{a.robot, a.joint}; }

std::string place_name(const Scene& scene, const std::vector<const Attachment*>& on_body) {
  if (on_body.empty())
    throw std::invalid_argument("place_name: there are no attachments, at least one attachment is expected");
  const Attachment& first = *on_body.front();
  const std::string name = frame_name(scene, first);
  bool same = !name.empty();
  Vec3<double> mean = Vec3<double>::Zero();
  for (const Attachment* a : on_body) {
    same = same && frame_name(scene, *a) == name;
    mean += a->placement.p / static_cast<double>(on_body.size());
  }
  if (same) return name;
  if (first.joint < 0) return "world";
  const Robot& robot = scene.robots[first.robot];
  const Frame* nearest = nearest_frame(*robot.model, first.joint, mean);
  return robot.name + "/" + (nearest ? nearest->name : robot.model->joints[first.joint].name);
}

std::string robot_names(const Scene& scene, const std::vector<int>& robots) {
  const auto names = in_runs(
      robots, [&](int r) { return scene.robots[r].name; },
      [&](int r, int s) { return scene.robots[r].model == scene.robots[s].model; });
  return text::join(names, kMostNames);
}

std::string contact_names(const Scene& scene, const std::vector<int>& contacts) {
  const auto names = in_runs(
      contacts, [&](int c) { return scene.contacts[c].name; }, [](int, int) { return true; });
  return text::join(names, kMostNames);
}

std::string row_name(const Contact& contact, int row) { return contact.name + "[" + std::to_string(row) + "]"; }

}  // namespace manycontact
