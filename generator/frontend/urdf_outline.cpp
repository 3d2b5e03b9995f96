#include "frontend/urdf_outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>

#include "frontend/element_reader.hpp"
#include "frontend/xml_document.hpp"

namespace dalembert::frontend {

namespace {

[[noreturn]] void refuse(const std::string& file, std::string element, std::string message, std::string remedy) {
  throw InputError({Severity::error, file, std::move(element), std::move(message), std::move(remedy)});
}

class OutlineReader {
 public:
  OutlineReader(const std::string& file, Diagnostics& warnings) : file_(file), read_(file, errors_, warnings) {}

  UrdfOutline outline(const std::string& text) {
    TiXmlDocument document;
    TiXmlElement& robot = root(document, text);
    UrdfOutline outline;
    if (const char* name = robot.Attribute("name")) outline.robot = name;
    read_.enter(fmt::format("robot '{}'", outline.robot));
    if (outline.robot.empty()) read_.error(robot, "<robot> has no name", "write <robot name=\"...\">");
    read_.only_children(robot, {}, {"link", "joint", "material", "transmission", "gazebo", "sensor", "mujoco", "plugin"});

    std::unordered_map<std::string, int> lines;
    for (TiXmlElement* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link"))
      if (named(*e, "link", lines)) outline.links.push_back(link(*e));
    lines.clear();
    for (TiXmlElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
      if (named(*e, "joint", lines)) outline.joints.push_back(joint(*e));
    if (!errors_.empty()) throw InputError(errors_);
    if (outline.links.empty())
      refuse(file_, fmt::format("robot '{}'", outline.robot), "there are no links", "add at least one <link>");
    outline.reduced = reduced(document, robot);
    return outline;
  }

 private:
  // The <robot> element of a document that is XML.
  TiXmlElement& root(TiXmlDocument& document, const std::string& text) {
    if (text.find_first_not_of(" \t\r\n") == text.npos) refuse(file_, "", "the file is empty", "name a URDF file");
    parse_xml(document, file_, text);
    if (document.Error() && !document.RootElement())
      refuse(file_, "", "this is not XML", "a URDF is an XML file whose root is <robot>");
    if (document.Error())
      refuse(file_, fmt::format("line {}, column {}", document.ErrorRow(), document.ErrorCol()),
             fmt::format("this is not well-formed XML: {}", document.ErrorDesc()), "close the tag or quote opened there");
    TiXmlElement* robot = document.FirstChildElement("robot");
    if (robot) return *robot;
    if (!document.RootElement()) refuse(file_, "", "this is not XML", "a URDF is an XML file whose root is <robot>");
    refuse(file_, fmt::format("<{}> (line {})", document.RootElement()->Value(), document.RootElement()->Row()),
           "there is no <robot> element", "a URDF's root is <robot>; convert other formats such as SDF or MJCF to URDF first");
  }

  // A link or joint with a name that is not taken. `lines`: where the names met so far are.
  bool named(TiXmlElement& element, const char* kind, std::unordered_map<std::string, int>& lines) {
    read_.enter(fmt::format("{} number {}", kind, lines.size() + 1));
    const std::optional<std::string> name = read_.required(element, "name", fmt::format("write <{} name=\"...\">", kind));
    if (!name) return false;
    read_.enter(fmt::format("{} '{}'", kind, *name));
    const auto [first, is_new] = lines.emplace(*name, element.Row());
    if (!is_new)
      read_.error(element, fmt::format("the name is already taken by the {} of line {}", kind, first->second),
                  "rename one of them");
    return true;
  }

  Eigen::Vector3d rpy(const TiXmlElement& owner) {
    const TiXmlElement* origin = owner.FirstChildElement("origin");
    if (!origin) return Eigen::Vector3d::Zero();
    if (origin->Attribute("quat_xyzw"))
      read_.error(*origin, "<origin quat_xyzw> is not supported", "write the rotation as rpy");
    else read_.only_attributes(*origin, {"xyz", "rpy"});
    read_.vector(*origin, "xyz");
    return read_.vector(*origin, "rpy").value_or(Eigen::Vector3d::Zero());
  }

  LinkOutline link(const TiXmlElement& element) {
    LinkOutline outline{element.Attribute("name"), element.Row()};
    read_.only_children(element, {"inertial"},
                        {"visual", "collision", "self_collision_checking", "contact", "sensor", "gazebo"});
    const TiXmlElement* inertial = element.FirstChildElement("inertial");
    if (!inertial) return outline;
    read_.only_children(*inertial, {"origin", "mass", "inertia"}, {});
    outline.inertial_rpy = rpy(*inertial);
    if (const TiXmlElement* mass = inertial->FirstChildElement("mass")) {
      read_.only_attributes(*mass, {"value"});
      read_.required(*mass, "value", "write <mass value=\"...\"/> in kg");
      const std::optional<double> value = read_.number(*mass, "value");
      if (value && *value < 0)
        read_.error(*mass, fmt::format("the mass is negative ({} kg)", *value), "give the link a mass of zero or more");
    } else {
      read_.error(*inertial, "<inertial> has no <mass>", "add <mass value=\"...\"/>, or remove <inertial>");
    }
    if (const TiXmlElement* inertia = inertial->FirstChildElement("inertia")) {
      read_.only_attributes(*inertia,
                            {"ixx", "ixy", "ixz", "iyy", "iyz", "izz", "iyx", "izx", "izy"});  // the last three repeat others
      for (const char* name : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
        read_.required(*inertia, name, "give all of ixx, ixy, ixz, iyy, iyz, izz in kg m²");
        read_.number(*inertia, name);
      }
    } else {
      read_.error(*inertial, "<inertial> has no <inertia>", "add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../>");
    }
    return outline;
  }

  JointOutline joint(const TiXmlElement& element) {
    JointOutline outline;
    outline.name = element.Attribute("name");
    outline.line = element.Row();
    read_.only_children(element,
                        {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"},
                        {"gazebo", "sensor", "hardwareInterface"});
    outline.type = type(element);
    outline.parent = end(element, "parent");
    outline.child = end(element, "child");
    outline.origin_rpy = rpy(element);
    if (outline.type == "revolute" || outline.type == "continuous" || outline.type == "prismatic") axis(element);
    if (const TiXmlElement* limit = element.FirstChildElement("limit"))
      for (const char* name : {"lower", "upper", "effort", "velocity"}) read_.number(*limit, name);
    if (const TiXmlElement* dynamics = element.FirstChildElement("dynamics"))
      for (const char* name : {"damping", "friction"}) {
        const std::optional<double> value = read_.number(*dynamics, name);
        if (value && *value < 0)
          read_.error(*dynamics, fmt::format("the {} is negative ({})", name, *value), "give a value of zero or more");
      }
    if (const TiXmlElement* mimic = element.FirstChildElement("mimic")) {
      read_.only_attributes(*mimic, {"joint", "multiplier", "offset"});
      read_.required(*mimic, "joint", "name the joint that drives this one, or remove <mimic>");
      read_.number(*mimic, "multiplier");
      read_.number(*mimic, "offset");
    }
    return outline;
  }

  std::string type(const TiXmlElement& element) {
    const std::string type =
        read_.required(element, "type", "write type=\"revolute\", continuous, prismatic or fixed").value_or("");
    if (type == "floating" || type == "planar")
      read_.error(element, fmt::format("joints of type '{}' are not supported", type),
                  type == "floating" ? "remove the joint and the link above it, and ask for --base floating"
                                     : "write it as two prismatic joints and a revolute one");
    else if (!type.empty() && type != "revolute" && type != "continuous" && type != "prismatic" && type != "fixed")
      read_.error(element, fmt::format("joints of type '{}' are not supported", type),
                  "use revolute, continuous, prismatic or fixed");
    return type;
  }

  // <parent link> or <child link>
  std::string end(const TiXmlElement& element, const char* tag) {
    const std::string remedy = fmt::format("add <{} link=\"...\"/>", tag);
    if (const TiXmlElement* found = element.FirstChildElement(tag)) return read_.required(*found, "link", remedy).value_or("");
    read_.error(element, fmt::format("the joint has no <{}>", tag), remedy);
    return "";
  }

  void axis(const TiXmlElement& element) {
    const TiXmlElement* axis = element.FirstChildElement("axis");
    if (!axis) return read_.warning(element, "the joint has no <axis>; 1 0 0 is taken", "write <axis xyz=\"1 0 0\"/>");
    read_.only_attributes(*axis, {"xyz"});
    if (!read_.required(*axis, "xyz", "write <axis xyz=\"0 0 1\"/> or another direction")) return;
    const std::optional<Eigen::Vector3d> direction = read_.vector(*axis, "xyz");
    if (direction && direction->norm() < 1e-9)
      read_.error(*axis, "the axis has zero length", "give the direction the joint turns about or slides along");
  }

  // What urdfdom has to read: it would refuse a whole robot for a malformed mesh or a missing limit.
  static std::string reduced(TiXmlDocument& document, TiXmlElement& robot) {
    for (TiXmlNode* child = robot.FirstChild(); child;) {
      TiXmlNode* next = child->NextSibling();
      const std::string_view tag = child->Value();
      if (child->ToElement() && tag == "link") {
        remove_all_but(*child, {"inertial"});
      } else if (child->ToElement() && tag == "joint") {
        remove_all_but(*child, {"origin", "parent", "child", "axis", "dynamics", "mimic"});
        TiXmlElement limit("limit");
        limit.SetAttribute("effort", 0);
        limit.SetAttribute("velocity", 0);
        child->InsertEndChild(limit);
      } else {
        robot.RemoveChild(child);
      }
      child = next;
    }
    robot.RemoveAttribute("version");
    TiXmlPrinter printer;
    document.Accept(&printer);
    return printer.Str();
  }

  static void remove_all_but(TiXmlNode& node, std::initializer_list<std::string_view> kept) {
    for (TiXmlNode* child = node.FirstChild(); child;) {
      TiXmlNode* next = child->NextSibling();
      if (!child->ToElement() || std::find(kept.begin(), kept.end(), child->Value()) == kept.end()) node.RemoveChild(child);
      child = next;
    }
  }

  std::string file_;
  Diagnostics errors_;
  ElementReader read_;
};

}  // namespace

UrdfOutline read_outline(const std::string& file, const std::string& text, Diagnostics& warnings) {
  return OutlineReader(file, warnings).outline(text);
}

std::string place(const LinkOutline& link) { return fmt::format("link '{}' (line {})", link.name, link.line); }
std::string place(const JointOutline& joint) { return fmt::format("joint '{}' (line {})", joint.name, joint.line); }

}  // namespace dalembert::frontend
