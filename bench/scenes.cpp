#include "scenes.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "manycontact/algorithm/integrate.hpp"

namespace manycontact::bench {

namespace {

constexpr char kModels[] = MANYCONTACT_SOURCE_DIR "/models/";
constexpr char kTalos[] = MANYCONTACT_SOURCE_DIR "/../shared/robots/talos_reduced.urdf";

// Reads a scene given as text, and moves it off its symmetric posture.
SceneFile load(const std::string& xml) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("manycontact_bench_" + std::to_string(getpid()) + ".xml");
  std::ofstream(path) << xml;
  SceneFile s = load_scene(path);
  std::filesystem::remove(path);
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  const auto random = [&](Eigen::Index n) {
    return Eigen::VectorXd::NullaryExpr(n, [&] { return noise(rng); }).eval();
  };
  for (const Robot& r : s.scene.robots) {
    Eigen::VectorXd q(r.model->nq);
    integrate<double>(*r.model, s.q.segment(r.idx_q, r.model->nq), random(r.model->nv), q);
    s.q.segment(r.idx_q, r.model->nq) = q;
  }
  s.v = random(s.scene.nv);
  s.u = 50 * random(s.scene.nu);
  return s;
}

std::string copies(int count) { return " copies=\"" + std::to_string(count) + "\" arrange=\"circle\" spacing=\"1\""; }

}  // namespace

bool talos_available() { return std::filesystem::exists(kTalos); }

SceneFile humanoids(int count, bool hand_in_hand) {
  std::string xml = "<scene><robot name=\"r\" urdf=\"" + std::string(kModels) + "humanoid.urdf\" base=\"floating\"" +
                    copies(count) +
                    "><joint name=\"left_knee\" q=\"0.5\"/><joint name=\"right_knee\" q=\"0.5\"/></robot>"
                    "<contact name=\"left\" type=\"6d\" frame=\"r/left_sole\"/>"
                    "<contact name=\"right\" type=\"6d\" frame=\"r/right_sole\"/>";
  if (hand_in_hand && count > 1)
    xml += "<contact name=\"hold\" type=\"6d\" frame=\"r/left_hand\" to=\"r+1/right_hand\" wrap=\"true\"/>";
  return load(xml + "</scene>");
}

SceneFile talos(int count) {
  return load("<scene><robot name=\"r\" urdf=\"" + std::string(kTalos) + "\" base=\"floating\"" + copies(count) +
              "/><contact name=\"left\" type=\"6d\" frame=\"r/left_sole_link\"/>"
              "<contact name=\"right\" type=\"6d\" frame=\"r/right_sole_link\"/></scene>");
}

SceneFile herd(int count) {
  std::string xml = "<scene><robot name=\"r\" urdf=\"" + std::string(kModels) + "quadruped.urdf\" base=\"floating\"" +
                    copies(count) + ">";
  std::string contacts;
  for (const std::string leg : {"LF", "RF", "LH", "RH"}) {
    xml += "<joint name=\"" + leg + "_hip\" q=\"0.7\"/><joint name=\"" + leg + "_knee\" q=\"-1.4\"/>";
    contacts += "<contact name=\"" + leg + "\" type=\"3d\" frame=\"r/" + leg + "_foot\"/>";
  }
  return load(xml + "</robot>" + contacts + "</scene>");
}

}  // namespace manycontact::bench
