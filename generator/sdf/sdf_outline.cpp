// The SDF as an outline, by libsdformat: a library of its own, which the generator opens when it is given an SDF. libsdformat
// takes longer to load than everything else that a command of the cache does.
#include "frontend/sdf_outline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <sdf/sdf.hh>
#include <set>

#include "frontend/urdf_outline.hpp"

namespace dalembert::frontend {

namespace {

using ignition::math::Pose3d;

constexpr double same_place = 1e-12;  // m, rad: rounding of resolved poses

Eigen::Vector3d vector(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

Eigen::Quaterniond quaternion(const ignition::math::Quaterniond& q) {
  return Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized();
}

bool is_identity(const Pose3d& pose) {
  return pose.Pos().Length() < same_place && 2 * quaternion(pose.Rot()).vec().norm() < same_place;
}

// What products of a few quaternions leave where a turn was meant to be square: more than the compiler takes for rounding.
Eigen::Matrix3d rotation(const ignition::math::Quaterniond& q) {
  constexpr double dust = 1e-15;
  Eigen::Matrix3d result = quaternion(q).toRotationMatrix();
  for (double& entry : result.reshaped())
    for (double exact : {0., 1., -1.})
      if (std::abs(entry - exact) < dust) entry = exact;
  return result;
}

Frame frame(const Pose3d& pose) { return {vector(pose.Pos()), Eigen::Vector3d::Zero(), rotation(pose.Rot())}; }

// The numbers of an element as they are written.
template <size_t count>
std::optional<std::array<double, count> > written_numbers(const sdf::ElementPtr& element) {
  if (!element->GetValue()) return std::nullopt;
  const std::string text = element->GetValue()->GetAsString();
  std::array<double, count> numbers;
  const char* at = text.c_str();
  for (double& number : numbers) {
    char* end = nullptr;
    number = std::strtod(at, &end);
    if (end == at) return std::nullopt;
    at = end;
  }
  return numbers;
}

// The six numbers of an element's <pose> as they are written; none where it has other units, another format, or no such
// element.
std::optional<Frame> written_pose(const sdf::ElementPtr& element) {
  if (!element || !element->HasElement("pose")) return std::nullopt;
  const sdf::ElementPtr pose = element->GetElement("pose");
  if ((pose->HasAttribute("degrees") && pose->Get<bool>("degrees")) ||
      (pose->HasAttribute("rotation_format") && pose->Get<std::string>("rotation_format") != "euler_rpy"))
    return std::nullopt;
  const auto n = written_numbers<6>(pose);
  if (!n) return std::nullopt;
  return Frame{{(*n)[0], (*n)[1], (*n)[2]}, {(*n)[3], (*n)[4], (*n)[5]}, {}};
}

int line_of(const sdf::ElementPtr& element) { return element ? element->LineNumber().value_or(0) : 0; }

class SdfReader {
 public:
  SdfReader(const std::string& file, Diagnostics& warnings) : file_(file), warnings_(warnings) {}

  UrdfOutline read() {
    sdf::Console::Instance()->SetQuiet(true);
    sdf::Root root;
    take(root.Load(file_));
    stop_on_errors();
    const sdf::Model& model = only_model(root);
    outline_.robot = model.Name();
    if (!is_identity(model.RawPose()) && model.PoseRelativeTo().empty())
      ignore("model", model.Name(), "its pose in the world",
             "a fixed base's frame is the model's; a floating base's pose is in q");
    add_model(model, "", Pose3d());
    stop_on_errors();
    place_root();
    return std::move(outline_);
  }

 private:
  void take(const sdf::Errors& errors) {
    for (const sdf::Error& error : errors)
      add_error(errors_,
                {Severity::error, file_, error.LineNumber() ? fmt::format("line {}", *error.LineNumber()) : std::string("SDF"),
                 "libsdformat says: " + error.Message(), "correct the element it names"});
  }
  void stop_on_errors() const {
    if (!errors_.empty()) throw InputError(errors_);
  }
  void ignore(const char* kind, const std::string& name, const std::string& what, const char* remedy) {
    warnings_.push_back({Severity::warning, file_, fmt::format("{} '{}'", kind, name), what + " is ignored", remedy});
  }

  const sdf::Model& only_model(const sdf::Root& root) {
    std::vector<const sdf::Model*> models;
    if (root.Model()) models.push_back(root.Model());
    for (uint64_t w = 0; w < root.WorldCount(); ++w) {
      const sdf::World& world = *root.WorldByIndex(w);
      for (uint64_t m = 0; m < world.ModelCount(); ++m) models.push_back(world.ModelByIndex(m));
      if (vector(world.Gravity()) != Eigen::Vector3d(0, 0, -9.8))  // what libsdformat has where nothing is said
        ignore("world", world.Name(), "its gravity", "say it in the scene: gravity");
    }
    if (models.size() == 1) return *models.front();
    std::vector<std::string> names;
    for (const sdf::Model* model : models) names.push_back("'" + model->Name() + "'");
    throw InputError(
        {Severity::error, file_, "SDF",
         models.empty() ? "there is no model" : fmt::format("there are {} models: {}", models.size(), fmt::join(names, ", ")),
         "leave one, the robot, in the file"});
  }

  // in_whole: the model's pose in the whole one.
  void add_model(const sdf::Model& model, const std::string& prefix, const Pose3d& in_whole) {
    if (model.Static()) ignore("model", prefix + model.Name(), "that it is static", "say it in the scene: base: fixed");
    if (model.Element() && model.Element()->HasElement("plugin"))
      ignore("model", prefix + model.Name(), "what its plugins do", "the dynamics is of links and joints alone");
    for (uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      add_link(link, prefix);
      const auto written = prefix.empty() && link.PoseRelativeTo().empty() ? written_pose(link.Element()) : std::nullopt;
      poses_.emplace(prefix + link.Name(), written ? *written : frame(in_whole * resolved(link.SemanticPose(), "")));
    }
    for (uint64_t i = 0; i < model.ModelCount(); ++i) {
      const sdf::Model& nested = *model.ModelByIndex(i);
      add_model(nested, prefix + nested.Name() + "::", in_whole * resolved(nested.SemanticPose(), ""));
    }
    for (uint64_t i = 0; i < model.JointCount(); ++i)
      if (const sdf::Joint& joint = *model.JointByIndex(i); joint.Type() != sdf::JointType::GEARBOX)
        add_joint(model, joint, prefix);
    for (uint64_t i = 0; i < model.JointCount(); ++i)
      if (const sdf::Joint& joint = *model.JointByIndex(i); joint.Type() == sdf::JointType::GEARBOX) add_gearbox(joint, prefix);
    for (uint64_t i = 0; i < model.FrameCount(); ++i) add_frame(*model.FrameByIndex(i), prefix);
  }

  // The root link hangs on no joint whose frame would say where it stands.
  void place_root() {
    std::set<std::string> below;
    for (const JointOutline& joint : outline_.joints) below.insert(joint.child);
    for (const LinkOutline& link : outline_.links)
      if (const auto pose = poses_.find(link.name); pose != poses_.end() && !below.count(link.name))
        outline_.root_pose = pose->second;  // of several roots the reader of robots complains
  }

  void add_link(const sdf::Link& link, const std::string& prefix) {
    LinkOutline out{prefix + link.Name(), line_of(link.Element()), {}};
    const sdf::ElementPtr element = link.Element();
    const bool has_inertial = element && element->HasElement("inertial");
    const auto& inertial = link.Inertial();
    const auto& m = inertial.MassMatrix();
    InertialOutline is;
    is.mass = m.Mass();
    is.origin = frame(inertial.Pose());
    if (has_inertial)
      if (const auto written = written_pose(element->GetElement("inertial"))) is.origin = *written;
    is.inertia << m.Ixx(), m.Ixy(), m.Ixz(), m.Ixy(), m.Iyy(), m.Iyz(), m.Ixz(), m.Iyz(), m.Izz();
    if (!has_inertial)
      warnings_.push_back({Severity::warning, file_, place(out), "it has no <inertial>: SDF gives it 1 kg and 1 kg m²",
                           "write its inertial, of mass 0 where it is a frame"});
    out.inertial = is;
    if (element && element->HasElement("gravity") && !element->Get<bool>("gravity"))
      ignore("link", out.name, "that gravity does not act on it", "there is no such thing here");
    if (element && element->HasElement("velocity_decay"))
      ignore("link", out.name, "its velocity_decay", "damping of joints can be said in the scene");
    outline_.links.push_back(std::move(out));
  }

  Pose3d resolved(const sdf::SemanticPose& pose, const std::string& to) {
    Pose3d result;
    take(pose.Resolve(result, to));
    return result;
  }

  void add_joint(const sdf::Model& model, const sdf::Joint& joint, const std::string& prefix) {
    JointOutline out;
    out.name = prefix + joint.Name();
    out.line = line_of(joint.Element());
    const auto refuse = [&](const std::string& what, const char* remedy) {
      add_error(errors_, {Severity::error, file_, place(out), what, remedy});
    };
    switch (joint.Type()) {
      case sdf::JointType::REVOLUTE: out.type = ir::JointType::revolute; break;
      case sdf::JointType::CONTINUOUS: out.type = ir::JointType::continuous; break;
      case sdf::JointType::PRISMATIC: out.type = ir::JointType::prismatic; break;
      case sdf::JointType::FIXED: out.type = ir::JointType::fixed; break;
      case sdf::JointType::SCREW: out.type = ir::JointType::helical; break;
      case sdf::JointType::BALL: out.type = ir::JointType::spherical; break;
      // Two axes in series, the first of them the parent's, the second the child's: in revolute2 at any angle to each other.
      case sdf::JointType::UNIVERSAL:
      case sdf::JointType::REVOLUTE2: out.type = ir::JointType::universal; break;
      default:
        return refuse(fmt::format("joints of type '{}' are not known here", joint.Element()->Get<std::string>("type")),
                      "there are revolute, continuous, prismatic, screw, ball, universal, revolute2 and fixed ones");
    }
    // SDF has a default only for those of an <axis> that is there.
    const sdf::JointAxis *const axis = joint.Axis(0), *const second = joint.Axis(1);
    const bool turns_two_ways = out.type == ir::JointType::universal;
    if (out.type != ir::JointType::fixed && out.type != ir::JointType::spherical && (!axis || (turns_two_ways && !second)))
      return refuse(axis ? "it has no second axis" : "it has no axis",
                    turns_two_ways ? "write its <axis> and <axis2>" : "write its <axis>, with the direction as <xyz>");
    std::string parent, child;
    const size_t before = errors_.size();
    take(joint.ResolveParentLink(parent));
    take(joint.ResolveChildLink(child));
    if (errors_.size() > before) return;
    const bool in_world = parent == "world";
    const Pose3d in_parent = resolved(joint.SemanticPose(), in_world ? "__model__" : parent),
                 in_child = resolved(joint.SemanticPose(), child);
    if (in_world && !has_world_) {
      has_world_ = true;
      outline_.links.push_back({"world", 0, {}});
    }
    out.parent = in_world ? "world" : prefix + parent;
    out.child = prefix + child;
    if (!children_.insert(out.child).second) return add_loop(joint, out, in_parent, in_child);
    // As it is written, where it is written in the parent's frame: rounding has no part in it then.
    out.origin = frame(in_parent);
    const sdf::Link* const child_link = model.LinkByName(child);
    if (joint.PoseRelativeTo() == joint.ParentLinkName() && !in_world) {
      if (const auto written = written_pose(joint.Element())) out.origin = *written;
    } else if (joint.PoseRelativeTo().empty() && is_identity(in_child) && child_link &&
               child_link->PoseRelativeTo() == (in_world ? "" : joint.ParentLinkName())) {
      if (const auto written = written_pose(child_link->Element())) out.origin = *written;
    }
    if (out.type != ir::JointType::fixed && out.type != ir::JointType::spherical) read_axis(*axis, out);
    if (out.type == ir::JointType::helical) {
      out.pitch = pitch(joint, out);
      if (!std::isfinite(out.pitch)) return refuse("its thread_pitch is 0: no turn moves it", "make it a prismatic joint");
    }
    if (turns_two_ways) {
      JointOutline of_second = out;
      read_axis(*second, of_second);
      out.second = of_second.axis;
      if (out.axis.cross(out.second).norm() < 1e-9 * out.axis.norm() * out.second.norm())
        return refuse("its second axis is its first: together they turn one way",
                      "correct <axis2>, or make it a revolute joint");
      if (of_second.damping != out.damping || of_second.friction != out.friction)
        ignore("joint", out.name, "the damping and friction of its second axis",
               "those of the first are each coordinate's: say them in the scene, damping and friction");
    }
    if (!is_identity(in_child)) {  // the child keeps its frame
      const LinkOutline between{out.name + "_frame", out.line, {}};
      JointOutline weld;
      weld.name = out.name + "_to_" + child;
      weld.line = out.line;
      weld.type = ir::JointType::fixed;
      weld.parent = between.name;
      weld.child = out.child;
      weld.origin = frame(in_child.Inverse());
      out.child = between.name;
      outline_.links.push_back(between);
      outline_.joints.push_back(std::move(weld));
    }
    if (out.type == ir::JointType::revolute || out.type == ir::JointType::continuous) {
      ignition::math::Vector3d in_link;
      take(axis->ResolveXyz(in_link, child));
      hinges_.push_back({out.name, out.parent, prefix + child, vector(in_link).normalized()});
    }
    outline_.joints.push_back(std::move(out));
  }

  // A joint to a link that hangs on another one already holds the two together.
  void add_loop(const sdf::Joint& joint, JointOutline& out, const Pose3d& in_parent, const Pose3d& in_child) {
    const auto isometry = [](const Pose3d& pose) {
      Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
      result.translation() = vector(pose.Pos());
      result.linear() = rotation(pose.Rot());
      return result;
    };
    ir::Loop loop;
    loop.name = out.name;
    loop.links = {out.parent, out.child};
    loop.at = {isometry(in_parent), isometry(in_child)};
    if (out.type == ir::JointType::revolute || out.type == ir::JointType::continuous) {
      loop.type = ir::LoopType::hinge;
      read_axis(*joint.Axis(0), out);
      for (Eigen::Isometry3d& at : loop.at)
        at.rotate(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out.axis.normalized()));
      if (out.damping != 0 || out.friction != 0)
        ignore("joint", out.name, "its damping and friction",
               "it closes a loop, and loops have none: say them of another joint");
    } else if (out.type == ir::JointType::spherical) {
      loop.type = ir::LoopType::point;
    } else if (out.type == ir::JointType::fixed) {
      loop.type = ir::LoopType::weld;
    } else {
      add_error(errors_, {Severity::error, file_, place(out),
                          fmt::format("link '{}' hangs on another joint already, and a loop is closed by no {} joint",
                                      out.child, joint.Element()->Get<std::string>("type")),
                          "write it before the other one, so that a revolute, ball or fixed joint closes the loop"});
      return;
    }
    outline_.loops.push_back(std::move(loop));
  }

  // A turning joint by which a gearbox may measure angles; its axis in its child's frame.
  struct Hinge {
    std::string joint, parent, child;
    Eigen::Vector3d axis;
  };

  // theta_2 = -ratio theta_1, angles of the child and of the parent against the reference body: the child's joint follows the
  // parent's.
  void add_gearbox(const sdf::Joint& joint, const std::string& prefix) {
    JointOutline out;
    out.name = prefix + joint.Name();
    out.line = line_of(joint.Element());
    const auto refuse = [&](const std::string& what, const char* remedy) {
      add_error(errors_, {Severity::error, file_, place(out), what, remedy});
    };
    std::string parent, child;
    const size_t before = errors_.size();
    take(joint.ResolveParentLink(parent));
    take(joint.ResolveChildLink(child));
    if (errors_.size() > before) return;
    const sdf::ElementPtr element = joint.Element();
    double ratio = 1;
    if (element->HasElement("gearbox_ratio")) {
      const auto written = written_numbers<1>(element->GetElement("gearbox_ratio"));
      ratio = written ? (*written)[0] : std::numeric_limits<double>::quiet_NaN();
    }
    if (!std::isfinite(ratio) || ratio == 0) return refuse("its gearbox_ratio is no ratio", "write a number other than 0");
    if (!element->HasElement("gearbox_reference_body"))
      return refuse("it has no gearbox_reference_body", "write the link against which both angles are measured");
    const std::string written = element->Get<std::string>("gearbox_reference_body"),
                      reference = written == "world" ? written : prefix + written;
    // The joint between the reference body and a link, and the sense in which its coordinate is that angle.
    const auto angle = [&](const std::string& link, unsigned which) -> std::optional<std::pair<std::string, double> > {
      const sdf::JointAxis* const axis = joint.Axis(which) ? joint.Axis(which) : joint.Axis(0);
      if (!axis) {
        refuse("it has no axis", "write its <axis>, that of the joint whose angle it is to measure");
        return std::nullopt;
      }
      for (const Hinge& hinge : hinges_) {
        const bool behind = hinge.parent == reference && hinge.child == link;
        if (!behind && !(hinge.child == reference && hinge.parent == link)) continue;
        ignition::math::Vector3d in_link;
        take(axis->ResolveXyz(in_link, hinge.child.substr(prefix.size())));
        const double sense = vector(in_link).normalized().dot(hinge.axis) * (behind ? 1 : -1);
        if (std::abs(sense) > 1 - 1e-9) return std::pair(hinge.joint, sense < 0 ? -1. : 1.);
        refuse(fmt::format("its {} is not that of joint '{}', whose angle it is to measure", which == 0 ? "<axis>" : "<axis2>",
                           hinge.joint),
               "correct it: a gearbox couples the angles of two revolute joints");
        return std::nullopt;
      }
      refuse(fmt::format("no revolute joint is between its gearbox_reference_body '{}' and link '{}'", reference, link),
             "write the body that both links turn against: a gearbox couples the angles of two revolute joints");
      return std::nullopt;
    };
    const auto first = angle(prefix + parent, 0), second = angle(prefix + child, 1);
    if (!first || !second) return;
    const auto joint_of = [&](const std::string& name) {
      return std::find_if(outline_.joints.begin(), outline_.joints.end(),
                          [&](const JointOutline& j) { return j.name == name; });
    };
    JointOutline& follower = *joint_of(second->first);
    if (follower.mimic)
      return refuse(fmt::format("joint '{}' follows '{}' already", follower.name, follower.mimic->of),
                    "exchange its parent and child, or remove it");
    double multiplier = -ratio * first->second * second->second;
    std::string of = first->first;
    while (const auto& relation = joint_of(of)->mimic) multiplier *= relation->multiplier, of = relation->of;
    if (of == follower.name) return refuse("gearboxes couple joint '" + of + "' to itself", "remove one of them");
    follower.mimic = ir::Mimic{of, multiplier, 0};
    warnings_.push_back({Severity::notice, file_, place(out),
                         fmt::format("it is a gearbox: joint '{}' follows '{}' times {:.6g}", follower.name, of, multiplier),
                         "what it couples is one coordinate where the scene says mimic: urdf"});
    for (JointOutline& other : outline_.joints)
      if (other.mimic && other.mimic->of == follower.name) other.mimic = ir::Mimic{of, other.mimic->multiplier * multiplier, 0};
  }

  // m per turn of a right-handed thread. What SDF 1.10 calls screw_thread_pitch is this; the older thread_pitch is what Gazebo
  // takes it for, rad per m of a left-handed one.
  double pitch(const sdf::Joint& joint, const JointOutline& out) {
    const sdf::ElementPtr element = joint.Element();
    if (element->HasElement("screw_thread_pitch"))
      if (const auto written = written_numbers<1>(element->GetElement("screw_thread_pitch"))) return (*written)[0];
    constexpr double turn = 2 * 3.14159265358979323846;
    const double result = -turn / joint.ThreadPitch();
    if (std::isfinite(result))
      warnings_.push_back({Severity::notice, file_, place(out),
                           fmt::format("its thread_pitch is taken as Gazebo takes it, {} rad per m of a left-handed thread: "
                                       "{:.6g} m per turn",
                                       joint.ThreadPitch(), result),
                           "where that is not meant, say it in the scene: joints"});
    return result;
  }

  void read_axis(const sdf::JointAxis& axis, JointOutline& out) {
    ignition::math::Vector3d xyz;
    take(axis.ResolveXyz(xyz));
    out.axis = vector(xyz);
    if (axis.XyzExpressedIn().empty() && axis.Element() && axis.Element()->HasElement("xyz"))
      if (const auto written = written_numbers<3>(axis.Element()->GetElement("xyz")))
        out.axis = {(*written)[0], (*written)[1], (*written)[2]};
    out.damping = axis.Damping();
    out.friction = axis.Friction();
    constexpr double unlimited = 1e16;  // SDF's own
    const auto limit = [](double value, double otherwise) { return std::abs(value) < unlimited ? value : otherwise; };
    constexpr double infinite = std::numeric_limits<double>::infinity();
    out.limits = {limit(axis.Lower(), -infinite), limit(axis.Upper(), infinite),
                  axis.MaxVelocity() >= 0 ? limit(axis.MaxVelocity(), infinite) : infinite,
                  axis.Effort() >= 0 ? limit(axis.Effort(), infinite) : infinite};
    if (axis.SpringStiffness() != 0)
      ignore("joint", out.name, fmt::format("its spring of {} about {}", axis.SpringStiffness(), axis.SpringReference()),
             "say it in the scene: stiffness");
  }

  void add_frame(const sdf::Frame& from, const std::string& prefix) {
    std::string body;
    const size_t before = errors_.size();
    take(from.ResolveAttachedToBody(body));
    if (errors_.size() > before || body == "__model__") return;
    JointOutline weld;
    weld.name = prefix + from.Name() + "_weld";
    weld.line = line_of(from.Element());
    weld.type = ir::JointType::fixed;
    weld.parent = prefix + body;
    weld.child = prefix + from.Name();
    weld.origin = frame(resolved(from.SemanticPose(), body));
    outline_.links.push_back({weld.child, weld.line, {}});
    outline_.joints.push_back(std::move(weld));
  }

  const std::string& file_;
  Diagnostics& warnings_;
  Diagnostics errors_;
  UrdfOutline outline_;
  std::vector<Hinge> hinges_;
  std::set<std::string> children_;      // links that hang on a joint
  std::map<std::string, Frame> poses_;  // of links in the whole model
  bool has_world_ = false;
};

}  // namespace

}  // namespace dalembert::frontend

void dalembert_sdf_outline(const std::string& path, dalembert::Diagnostics& warnings,
                           dalembert::frontend::UrdfOutline& outline) {
  outline = dalembert::frontend::SdfReader(path, warnings).read();
}
