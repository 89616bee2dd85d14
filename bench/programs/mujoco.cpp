// MuJoCo runs mj_forward. Contacts are equality constraints, welds and connects, as stiff as possible; they stay soft,
// so the solution differs a little. It omits dJ/dt v. Compiles against versions 2.2 to 3.12.

#include <mujoco/mujoco.h>

#include <sstream>
#include <stdexcept>

#include "bodies.hpp"
#include "program.hpp"

namespace manycontact::bench {

namespace {

std::string numbers(const Eigen::VectorXd& x) {
  std::ostringstream out;
  out.precision(17);
  for (Eigen::Index i = 0; i < x.size(); ++i) out << (i ? " " : "") << x[i];
  return out.str();
}

std::string place(const SE3<double>& M) {
  const Eigen::Vector4d q = quaternion_of_rotation<double>(M.R);
  return "pos=\"" + numbers(M.p) + "\" quat=\"" + numbers(Eigen::Vector4d(q[3], q[0], q[1], q[2])) + "\"";
}

std::string name(int body) { return "b" + std::to_string(body); }

void write_bodies(std::ostream& out, const std::vector<Body>& bodies) {
  std::vector<int> open;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Body& b = bodies[k];
    for (; !open.empty() && open.back() != b.parent; open.pop_back()) out << "</body>\n";
    open.push_back(static_cast<int>(k));
    const Mat3<double>& I = b.inertia;
    Eigen::VectorXd inertia(6);
    inertia << I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2);
    out << "<body name=\"" << name(static_cast<int>(k)) << "\" " << place(b.in_parent) << "><inertial pos=\""
        << numbers(b.com) << "\" mass=\"" << numbers(Eigen::VectorXd::Constant(1, b.mass)) << "\" fullinertia=\""
        << numbers(inertia) << "\"/>";
    if (b.type == JointType::kFloating)
      out << "<freejoint/>\n";
    else
      out << "<joint type=\"hinge\" axis=\"" << numbers(b.axis) << "\"/>\n";
  }
  for (std::size_t k = 0; k < open.size(); ++k) out << "</body>\n";
}

// Returns memory for constraints: their number before version 2.3, after which they share an arena of that size.
std::string sizes(const Scene& scene) {
#if mjVERSION_HEADER < 230
  return "<size nconmax=\"1\" njmax=\"" + std::to_string(6 * scene.contacts.size()) + "\"/>";
#else
  return "<size memory=\"" + std::to_string(16 + scene.nrobots()) + "M\"/>";
#endif
}

// "mj_forward:TOLERANCE:IMPEDANCE" sets the solver's tolerance and the constraints' impedance; 1 is rigid.
struct Dials {
  double tolerance = 1e-8, impedance = 0.9999;
};
Dials dials_of(const std::string& words) {
  const Task task = task_of(words);
  return task.dials.size() == 2 ? Dials{task.dials[0], task.dials[1]} : Dials{};
}

std::string mjcf(const Posed& s, const Dials& dials) {
  const std::vector<Body> bodies = bodies_of(s);
  std::ostringstream out;
  out.precision(17);
  out << "<mujoco><compiler angle=\"radian\"/><option tolerance=\"" << dials.tolerance << "\" gravity=\""
      << numbers(s.scene.gravity) << "\"><flag contact=\"disable\" warmstart=\"disable\"/></option>" << sizes(s.scene)
      << "\n<worldbody>";
  write_bodies(out, bodies);
  out << "</worldbody>\n<equality>\n";
  for (const Hold& h : holds_of(s, bodies)) {
    out << (h.point ? "<connect anchor=\"" + numbers(h.in_a.p) + "\"" : "<weld") << " body1=\"" << name(h.a) << "\"";
    if (h.b >= 0) out << " body2=\"" << name(h.b) << "\"";
    out << " solimp=\"" << dials.impedance << " " << dials.impedance << " 0.001\"/>\n";
  }
  out << "</equality></mujoco>\n";
  return out.str();
}

// Adds a file in memory; the function differs since version 3.1.3.
bool add_file(mjVFS& vfs, const char* name, const std::string& text) {
  const int size = static_cast<int>(text.size());
#if mjVERSION_HEADER < 313
  if (mj_makeEmptyFileVFS(&vfs, name, size) != 0) return false;
  text.copy(static_cast<char*>(vfs.filedata[vfs.nfile - 1]), text.size());
  return true;
#else
  return mj_addBufferVFS(&vfs, name, text.data(), size) == 0;
#endif
}

mjModel* compile(const std::string& xml) {
  mjVFS vfs;
  mj_defaultVFS(&vfs);
  if (!add_file(vfs, "scene.xml", xml)) throw std::runtime_error("MuJoCo takes no file of this size");
  char error[1000] = "";
  mjModel* model = mj_loadXML("scene.xml", &vfs, error, sizeof error);
  mj_deleteVFS(&vfs);
  mj_freeLastXML();
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

// Keeps warnings here instead of in a file MUJOCO_LOG.TXT.
std::string warned;
void keep_warning(const char* text) { warned = text; }

struct Forward : Loaded {
  Forward(const Posed& scene, const Dials& dials)
      : s(scene), bodies(bodies_of(scene)), model(compile(mjcf(scene, dials))) {
    data = mj_makeData(model);
    mju_copy(data->qvel, s.v.data(), model->nv);
    mju_zero(data->qfrc_applied, model->nv);
    for (const Body& b : bodies) {
      if (b.type == JointType::kFloating)  // linear velocity in the world's axes
        Eigen::Map<Eigen::Vector3d>(data->qvel + b.idx_v) = b.in_world.R * s.v.segment<3>(b.idx_v);
      else
        data->qfrc_applied[b.idx_v] = s.u[b.idx_u];
    }
    Forward::run();
    if (!warned.empty()) throw std::runtime_error("MuJoCo: " + warned);
  }
  ~Forward() override {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  void run() override { mj_forward(model, data); }
  Eigen::VectorXd accelerations() override {
    Eigen::VectorXd a = Eigen::Map<Eigen::VectorXd>(data->qacc, model->nv);
    for (const Body& b : bodies)
      if (b.type == JointType::kFloating) {
        const Eigen::Vector3d v = s.v.segment<3>(b.idx_v), w = s.v.segment<3>(b.idx_v + 3);
        a.segment<3>(b.idx_v) = b.in_world.R.transpose() * a.segment<3>(b.idx_v) - w.cross(v);
      }
    return a;
  }

  const Posed& s;
  std::vector<Body> bodies;
  mjModel* model;
  mjData* data;
};

std::string refuses(const Posed& s, const std::string&) {
  if (s.scene.nrobots() > 256) return "it takes minutes to set that up";
  if (s.scene.nrobots() == 1 && s.scene.nv > 90) return "its XML reader takes no trees as deep as that";
  return strange(s);
}

std::unique_ptr<Loaded> load(const Posed& s, const std::string& task) {
  mju_user_warning = keep_warning;
  return std::make_unique<Forward>(s, dials_of(task));
}

}  // namespace

const Program& program() {
  static const Program p{"MuJoCo", mj_versionString(), {"mj_forward"}, {}, refuses, load};
  return p;
}

}  // namespace manycontact::bench
