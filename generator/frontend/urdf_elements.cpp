#include "frontend/urdf_elements.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <vector>

#include "frontend/numbers.hpp"

namespace dalembert::frontend {

namespace {

Frame frame(ElementReader& read, const TiXmlElement& owner) {
  Frame frame;
  const TiXmlElement* origin = owner.FirstChildElement("origin");
  if (!origin || !read.data_in_attributes(*origin, "write <origin xyz=\"...\" rpy=\"...\"/>")) return frame;
  if (origin->Attribute("quat_xyzw")) read.error(*origin, "<origin quat_xyzw> is not supported", "write the rotation as rpy");
  else read.only_attributes(*origin, {"xyz", "rpy"});
  frame.xyz = read.vector(*origin, "xyz").value_or(frame.xyz);
  frame.rpy = read.vector(*origin, "rpy").value_or(frame.rpy);
  return frame;
}

double mass(ElementReader& read, const TiXmlElement& inertial) {
  const TiXmlElement* mass = inertial.FirstChildElement("mass");
  if (!mass) {
    read.warning(inertial, "<inertial> has no <mass>: zero is taken", "write <mass value=\"...\"/> in kg");
    return 0;
  }
  const std::string remedy = "write <mass value=\"...\"/> in kg";
  if (!read.data_in_attributes(*mass, remedy)) return 0;
  read.only_attributes(*mass, {"value"});
  if (mass->Attribute("value")) return read.number(*mass, "value").value_or(0);
  read.warning(*mass, "<mass> has no value: zero is taken", remedy);
  return 0;
}

bool is_blank(const char* text) { return !text || trimmed(text).empty(); }

// A product of inertia that is written on both sides of the diagonal. In some public files (DART's WAM) the lower half is all
// zeros. URDF knows the upper one alone, and so do its other readers. Differences below `rounding` are none.
void check_mirrored(ElementReader& read, const TiXmlElement& inertia, const char* name, const char* mirrored, double rounding) {
  if (is_blank(inertia.Attribute(name)) || is_blank(inertia.Attribute(mirrored))) return;
  const std::optional<double> upper = parse_number(inertia.Attribute(name)), lower = read.number(inertia, mirrored);
  if (!upper || !lower || std::abs(*upper - *lower) <= rounding) return;
  read.warning(inertia,
               fmt::format("<inertia> has {}=\"{}\" and {}=\"{}\": {} is taken", name, inertia.Attribute(name), mirrored,
                           inertia.Attribute(mirrored), name),
               "leave out the wrong one", "mirrored product of inertia");
}

Eigen::Matrix3d inertia(ElementReader& read, const TiXmlElement& inertial) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  const TiXmlElement* inertia = inertial.FirstChildElement("inertia");
  if (!inertia) {
    read.warning(inertial, "<inertial> has no <inertia>: zeros are taken",
                 "add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²");
    return moments;
  }
  if (!read.data_in_attributes(*inertia, "write <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²"))
    return moments;
  read.only_attributes(*inertia, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz", "iyx", "izx", "izy"});
  struct Component {
    const char *name, *mirrored;
    int row, column;
  };
  std::vector<std::string_view> missing, blank;  // blank: a product of inertia; a moment must be a number
  for (const Component& c : {Component{"ixx", "ixx", 0, 0}, Component{"ixy", "iyx", 0, 1}, Component{"ixz", "izx", 0, 2},
                             Component{"iyy", "iyy", 1, 1}, Component{"iyz", "izy", 1, 2}, Component{"izz", "izz", 2, 2}}) {
    const bool is_product = c.row != c.column;
    const char* name = inertia->Attribute(c.name) ? c.name : c.mirrored;
    if (is_product && is_blank(inertia->Attribute(name))) name = c.mirrored;
    const char* text = inertia->Attribute(name);
    if (text && !(is_product && is_blank(text)))
      moments(c.row, c.column) = moments(c.column, c.row) = read.number(*inertia, name).value_or(0);
    else if (text || inertia->Attribute(c.name)) blank.push_back(c.name);
    else missing.push_back(c.name);
  }
  const double rounding = 1e-5 * moments.cwiseAbs().maxCoeff();
  check_mirrored(read, *inertia, "ixy", "iyx", rounding);
  check_mirrored(read, *inertia, "ixz", "izx", rounding);
  check_mirrored(read, *inertia, "iyz", "izy", rounding);
  if (!blank.empty())
    read.warning(*inertia, fmt::format("<inertia> has a blank {}: zero is taken", fmt::join(blank, ", ")),
                 "write the number, 0 if it is none", "blank product of inertia");
  if (!missing.empty())
    read.warning(*inertia, fmt::format("<inertia> has no {}: zero is taken", fmt::join(missing, ", ")),
                 "give all of ixx, ixy, ixz, iyy, iyz, izz in kg m²");
  return moments;
}

ir::JointType joint_type(ElementReader& read, const TiXmlElement& element) {
  const ir::JointWords words = ir::urdf_joint_words(), of_scenes = ir::joint_words();
  std::vector<std::string> all;
  for (const auto& [word, type] : words) all.push_back(word);
  const std::string last = all.back();
  all.pop_back();
  const std::string name =
      read.required(element, "type",
                    fmt::format("write type=\"{}\", {} or {}", all.front(), fmt::join(all.begin() + 1, all.end(), ", "), last))
          .value_or("");
  const auto among = [&](const ir::JointWords& these) {
    return std::find_if(these.begin(), these.end(), [&](const auto& row) { return row.first == name; });
  };
  if (const auto found = among(words); found != words.end()) return found->second;
  if (name == "spherical" || name == "ball") {  // as Bullet has it
    const char* const joint = element.Attribute("name");
    read.warning(
        element, fmt::format("URDF has no joints of type '{}': a ball is taken", name),
        fmt::format("where others are to read the file, write type=\"continuous\", and in the scene joints: {{{}: spherical}}",
                    joint ? joint : "joint"),
        "ball in a URDF");
    return ir::JointType::spherical;
  }
  if (!name.empty())
    read.error(element, fmt::format("joints of type '{}' are not supported", name),
               among(of_scenes) != of_scenes.end() || name == "screw"
                   ? "write a type of URDF's, and what the joint is in the scene: joints: {joint: ...}"
                   : fmt::format("use {} or {}", fmt::join(all, ", "), last));
  return ir::JointType::fixed;
}

// <parent link> or <child link>
std::string end(ElementReader& read, const TiXmlElement& element, const char* tag) {
  const std::string remedy = fmt::format("add <{} link=\"...\"/>", tag);
  if (const TiXmlElement* found = element.FirstChildElement(tag)) {
    read.only_attributes(*found, {"link"});
    read.only_children(*found, {}, {});
    return read.required(*found, "link", remedy).value_or("");
  }
  read.error(element, fmt::format("the joint has no <{}>", tag), remedy);
  return "";
}

Eigen::Vector3d axis(ElementReader& read, const TiXmlElement& element) {
  const Eigen::Vector3d otherwise = Eigen::Vector3d::UnitX();
  const TiXmlElement* axis = element.FirstChildElement("axis");
  if (!axis) {
    read.warning(element, "the joint has no <axis>; 1 0 0 is taken", "write <axis xyz=\"1 0 0\"/>");
    return otherwise;
  }
  if (!read.data_in_attributes(*axis, "write <axis xyz=\"...\"/>")) return otherwise;
  read.only_attributes(*axis, {"xyz"});
  if (!read.required(*axis, "xyz", "write <axis xyz=\"0 0 1\"/> or another direction")) return otherwise;
  const std::optional<Eigen::Vector3d> direction = read.vector(*axis, "xyz");
  if (direction && direction->stableNorm() < 1e-9)
    read.error(*axis, "the axis has zero length", "give the direction the joint turns about or slides along");
  return direction.value_or(otherwise);
}

// Of a joint that has none as it stands in the file: one that the scene makes another kind of may need it.
std::optional<Eigen::Vector3d> axis_of_another_kind(const TiXmlElement& element) {
  const TiXmlElement* const axis = element.FirstChildElement("axis");
  const char* const text = axis ? axis->Attribute("xyz") : nullptr;
  const std::optional<std::vector<double>> values = text ? parse_numbers(text) : std::nullopt;
  if (!values || values->size() != 3) return std::nullopt;
  const Eigen::Vector3d direction((*values)[0], (*values)[1], (*values)[2]);
  if (!direction.allFinite() || direction.stableNorm() < 1e-9) return std::nullopt;
  return direction;
}

// Numbers that the dynamics does not use: what is odd about them is at most worth a warning.
void read_unused(ElementReader& read, const TiXmlElement& element, std::initializer_list<std::string_view> attributes) {
  read.only_attributes(element, attributes);
  read.only_children(element, {}, {});
  for (std::string_view literal : attributes) read.optional_number(element, literal.data());
}

// What is no number limits nothing, and a joint that turns without end has no range.
ir::Limits limits(ElementReader& read, const TiXmlElement& element, bool endless) {
  constexpr const char* attributes[] = {"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"};
  read.only_attributes(element, {"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"});
  read.only_children(element, {}, {});
  ir::Limits limits;
  // Of lower and upper, the one that is left out is zero (URDF's specification).
  if (!endless && (element.Attribute("lower") || element.Attribute("upper"))) limits.lower = limits.upper = 0;
  double* const places[] = {&limits.lower, &limits.upper, &limits.effort, &limits.velocity, nullptr, nullptr, nullptr};
  for (size_t i = 0; i < std::size(attributes); ++i) {
    const std::optional<double> value = read.optional_number(element, attributes[i]);
    if (!value || !places[i] || (endless && i < 2)) continue;
    *places[i] = !std::isnan(*value) ? *value
                 : i == 0            ? -std::numeric_limits<double>::infinity()
                                     : std::numeric_limits<double>::infinity();
  }
  if (limits.lower > limits.upper)
    read.warning(element, fmt::format("lower {} is above upper {}", limits.lower, limits.upper),
                 "exchange them, or correct a sign: no position is within");
  for (const auto& [name, value] : {std::pair{"effort", limits.effort}, std::pair{"velocity", limits.velocity}})
    if (value < 0) read.warning(element, fmt::format("{} {} is negative", name, value), "give the largest size allowed");
  return limits;
}

}  // namespace

LinkOutline read_link(ElementReader& read, const TiXmlElement& element, const std::string& name) {
  LinkOutline outline{name, element.Row(), std::nullopt};
  read.only_attributes(element, {"name", "type"});  // `type` is of URDF's early days
  read.only_children(element, {"inertial"}, {"visual", "collision", "self_collision_checking", "contact", "sensor", "gazebo"});
  const TiXmlElement* inertial = element.FirstChildElement("inertial");
  if (!inertial) return outline;
  read.only_attributes(*inertial, {});
  read.only_children(*inertial, {"origin", "mass", "inertia"}, {});
  outline.inertial = InertialOutline{frame(read, *inertial), mass(read, *inertial), inertia(read, *inertial)};
  return outline;
}

JointOutline read_joint(ElementReader& read, const TiXmlElement& element, const std::string& name) {
  JointOutline outline;
  outline.name = name;
  outline.line = element.Row();
  read.only_attributes(element, {"name", "type"});
  read.only_children(element,
                     {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"},
                     {"gazebo", "sensor", "hardwareInterface"});
  outline.type = joint_type(read, element);
  outline.parent = end(read, element, "parent");
  outline.child = end(read, element, "child");
  outline.origin = frame(read, element);
  if (ir::row_of(outline.type).has_axis) outline.axis = axis(read, element);
  else if (outline.type == ir::JointType::floating || outline.type == ir::JointType::spherical) {
    const std::optional<Eigen::Vector3d> direction = axis_of_another_kind(element);
    outline.axis_is_known = direction.has_value();
    outline.axis = direction.value_or(outline.axis);
  }
  if (const TiXmlElement* dynamics = element.FirstChildElement("dynamics")) {
    read.data_in_attributes(*dynamics, "write <dynamics damping=\"...\" friction=\"...\"/>");
    read.only_attributes(*dynamics, {"damping", "friction"});
    outline.damping = read.optional_number(*dynamics, "damping").value_or(0);
    outline.friction = read.optional_number(*dynamics, "friction").value_or(0);
  }
  if (const TiXmlElement* mimic = element.FirstChildElement("mimic")) {
    read.data_in_attributes(*mimic, "write <mimic joint=\"...\" multiplier=\"...\" offset=\"...\"/>");
    read.only_attributes(*mimic, {"joint", "multiplier", "offset"});
    const char* of = mimic->Attribute("joint");
    outline.mimic = ir::Mimic{std::string(trimmed(of ? of : "")), read.optional_number(*mimic, "multiplier").value_or(1),
                              read.optional_number(*mimic, "offset").value_or(0)};
  }
  if (const TiXmlElement* limit = element.FirstChildElement("limit"))
    outline.limits = limits(read, *limit, outline.type == ir::JointType::continuous);
  if (const TiXmlElement* calibration = element.FirstChildElement("calibration"))
    read_unused(read, *calibration, {"rising", "falling", "reference_position"});
  if (const TiXmlElement* safety = element.FirstChildElement("safety_controller"))
    read_unused(read, *safety, {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"});
  return outline;
}

}  // namespace dalembert::frontend
