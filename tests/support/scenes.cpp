#include "support/scenes.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "manycontact/algorithm/integrate.hpp"
#include "support/folder.hpp"
#include "support/random.hpp"

namespace manycontact::test {

namespace fs = std::filesystem;

std::vector<std::string> scene_files(const std::string& folder) {
  std::vector<std::string> paths;
  if (!fs::is_directory(folder)) return paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".xml") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<std::string> model_scenes() { return scene_files(MANYCONTACT_SOURCE_DIR "/models"); }
std::vector<std::string> golden_scenes() { return scene_files(MANYCONTACT_SHARED_DIR "/golden"); }

std::string scene_name(const std::string& path) { return fs::path(path).stem().string(); }

std::string readable(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}
std::string scene_title(const testing::TestParamInfo<std::string>& info) { return readable(scene_name(info.param)); }

namespace {

std::string read(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument("load_edited: '" + from + "' is not in the scene");
  for (; at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
}

// Reads `xml` as a file in `folder`.
SceneFile load_at(std::string xml, const std::string& folder) {
  replace_all(xml, "urdf=\"", "urdf=\"" + folder + "/");
  const TemporaryFolder own;
  return load_scene(own.write("scene.xml", xml));
}

}  // namespace

SceneFile load_edited(const std::string& path, const std::vector<Edit>& edits) {
  std::string xml = read(path);
  for (const Edit& edit : edits) replace_all(xml, edit.from, edit.to);
  return load_at(std::move(xml), fs::path(path).parent_path().string());
}

SceneFile load_text(const std::string& xml) { return load_at(xml, MANYCONTACT_SOURCE_DIR "/models"); }

SceneFile load_small(const std::string& path) {
  std::smatch copies;
  const std::string xml = read(path);
  if (!std::regex_search(xml, copies, std::regex("copies=\"([0-9]+)\""))) return load_scene(path);
  return load_edited(path, {{copies[0], "copies=\"" + std::to_string(std::min(4, std::stoi(copies[1]))) + "\""}});
}

void disturb(SceneFile& file, std::mt19937& rng, double size) {
  for (const Robot& r : file.scene.robots) {
    Eigen::VectorXd q(r.model->nq);
    integrate<double>(*r.model, file.q.segment(r.idx_q, r.model->nq), random_vector(r.model->nv, rng, size), q);
    file.q.segment(r.idx_q, r.model->nq) = q;
  }
  file.v += random_vector(file.scene.nv, rng, 0.3);
  for (double& u : file.u) u += uniform(rng, -5, 5);
}

void scale_lengths(SceneFile& file, double unit) {
  for (Robot& robot : file.scene.robots) {
    Model model = *robot.model;
    for (Joint& joint : model.joints) {
      joint.placement.p *= unit;
      joint.inertia.h *= unit;
      joint.inertia.I *= unit * unit;
    }
    finalize(model);
    robot.model = std::make_shared<const Model>(std::move(model));
    robot.base.p *= unit;
  }
  for (Contact& contact : file.scene.contacts)
    for (Attachment* at : {&contact.A, &contact.B}) at->placement.p *= unit;
  file.scene.gravity *= unit;
  file.u *= unit * unit;
}

SceneFile tilted_four_bar(double tilt, const std::string& type) {
  TemporaryFolder folder;
  const auto bar = [](const char* name) {
    return "<link name=\"" + std::string(name) +
           "\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" "
           "iyy=\"0.02\" "
           "iyz=\"0\" izz=\"0.03\"/></inertial></link>";
  };
  std::ostringstream digits;
  digits.precision(17);
  digits << tilt;
  const auto joint = [&](const char* name, const char* from, const char* to, const char* x, bool tilts) {
    return "<joint name=\"" + std::string(name) + "\" type=\"continuous\"><origin xyz=\"" + x + " 0 0\" rpy=\"" +
           (tilts ? digits.str() : "0") + " 0 0\"/><parent link=\"" + from + "\"/><child link=\"" + to +
           "\"/><axis xyz=\"0 0 1\"/></joint>";
  };
  (void)folder.write("bars.urdf", "<robot name=\"b\"><link name=\"base\"/>" + bar("a") + bar("b") + bar("c") +
                                      joint("j1", "base", "a", "0", false) + joint("j2", "a", "b", "0.5", true) +
                                      joint("j3", "b", "c", "0.8", false) + "</robot>");
  return load_scene(folder.write(
      "scene.xml",
      "<scene gravity=\"0 -9.81 0\"><robot name=\"r\" urdf=\"bars.urdf\"><joint name=\"j1\" q=\"1.2\" "
      "u=\"1\"/><joint name=\"j2\" q=\"-1\"/><joint name=\"j3\" q=\"-1.4\"/></robot><contact name=\"pin\" type=\"" +
          type + "\" frame=\"r/c\" offset=\"0.6 0 0\" reference_frame=\"" + (type == "5d" ? "local" : "world") +
          "\"/></scene>"));
}

}  // namespace manycontact::test
