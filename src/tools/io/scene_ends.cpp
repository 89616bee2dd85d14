#include <charconv>

#include "scene_parts.hpp"

namespace manycontact::io {

EndReader::EndReader(const SceneFile& scene) : scene_(scene) {
  for (std::size_t g = 0; g < scene.robot_groups.size(); ++g)
    if (scene.robot_groups[g].copied) groups_.emplace(scene.robot_groups[g].name, static_cast<int>(g));
}

End EndReader::read(const Element& e, const char* attribute) {
  const std::string text = e.required(attribute);
  const Where here = e.where(attribute);
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) here.fail(e.label(attribute) + " is " + quote(text) + ", expected robot/link");
  const std::string name = text.substr(0, slash);
  const std::string frame = text.substr(slash + 1);
  End end = robot(e, attribute, name);
  const Model& model = *scene_.scene.robots[end.first].model;
  const auto& frames = frames_of(model);
  const auto found = frames.find(frame);
  if (found == frames.end()) here.fail(e.label(attribute) + ": " + no_frame(name, model, frame));
  end.frame = model.frames[found->second];
  return end;
}

End EndReader::read_first(const Element& e, const char* attribute) {
  const End end = read(e, attribute);
  if (end.shifted)
    e.refuse(attribute, " is " + quote(e.required(attribute)) + ", expected a name without +k or -k" +
                            (e.name() == "contact" || e.name() == "spring" ? ", which is for 'to' only" : ""));
  return end;
}

EndPair EndReader::read_pair(const Element& e) {
  EndPair out;
  out.A = read_first(e, "frame");
  out.to_robot = e.has("to");
  out.wrap = e.flag("wrap", false);
  if (!out.to_robot) return out;
  out.B = read(e, "to");
  const Where here = e.where("to");
  const std::string to = e.label("to") + " is " + quote(e.required("to"));
  if (e.has("wrap") && !out.B.shifted) e.refuse("wrap", " needs a next copy, expected 'to' like robot+1/link");
  if (out.B.copied && !out.A.copied)
    here.fail(to + ", which is on all copies of a robot, expected one copy, since 'frame' is on one robot");
  if (out.B.copied && out.B.count != out.A.count)
    here.fail(to + ", which is on " + std::to_string(out.B.count) + " copies, expected " + std::to_string(out.A.count) +
              " copies as in 'frame'");
  return out;
}

std::optional<int> EndPair::target(int i) const {
  if (!to_robot || !B.copied) return B.first;
  long long k = i + B.shift;
  if (wrap) k = (k % B.count + B.count) % B.count;
  if (k < 0 || k >= B.count) return std::nullopt;
  return static_cast<int>(B.first + k);
}

End EndReader::robot(const Element& e, const char* attribute, const std::string& name) const {
  End end;
  const Where here = e.where(attribute);
  if (find_robot(name, end) || find_shifted(here, name, end)) return end;
  std::vector<std::string> known;
  for (const RobotGroup& g : scene_.robot_groups) known.push_back(g.name);
  here.fail(e.label(attribute) + ": there is no robot " + quote(name) + ", " + suggestion(name, known));
}

bool EndReader::find_robot(const std::string& name, End& end) const {
  const auto& robots = scene_.scene.robot_index;
  if (const auto robot = robots.find(name); robot != robots.end()) {
    end.first = robot->second;
    return true;
  }
  const auto group = groups_.find(name);
  if (group == groups_.end()) return false;
  end.first = scene_.robot_groups[group->second].first;
  end.count = scene_.robot_groups[group->second].count;
  end.copied = true;
  return true;
}

bool EndReader::find_shifted(const Where& here, const std::string& text, End& end) const {
  const std::size_t sign = text.find_last_of("+-");
  if (sign == std::string::npos || sign + 1 == text.size()) return false;
  const char* last = text.data() + text.size();
  long long k = 0;
  const auto [stop, error] = std::from_chars(text.data() + sign + 1, last, k);
  if (stop != last || error != std::errc() || text[sign + 1] == '-') return false;
  const std::string name = text.substr(0, sign);
  if (!find_robot(name, end)) return false;
  if (!end.copied) here.fail("robot " + quote(name) + " is not copied, expected no +k or -k after the name");
  if (k > 1000000) here.fail(quote(text) + " is beyond all copies, expected +k or -k with k up to 1000000");
  end.shifted = true;
  end.shift = text[sign] == '-' ? -k : k;
  return true;
}

const std::unordered_map<std::string, int>& EndReader::frames_of(const Model& model) {
  auto& frames = frames_[&model];
  if (frames.empty())
    for (std::size_t i = 0; i < model.frames.size(); ++i) frames.emplace(model.frames[i].name, static_cast<int>(i));
  return frames;
}

}  // namespace manycontact::io
