#include "urdf_text.hpp"

#include <tinyxml2.h>

#include <initializer_list>
#include <set>
#include <stdexcept>

namespace dalembert::oracle {
namespace {

using tinyxml2::XMLElement;

void remove_children(XMLElement& parent, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    while (XMLElement* child = parent.FirstChildElement(name)) parent.DeleteChild(child);
  }
}

void prefix_attribute(XMLElement* element, const char* attribute) {
  const char* value = element ? element->Attribute(attribute) : nullptr;
  if (value) element->SetAttribute(attribute, link_name_in_oracle(value).c_str());
}

void set_placeholder_inertia(XMLElement& link) {
  remove_children(link, {"inertial"});
  XMLElement* inertial = link.InsertNewChildElement("inertial");
  inertial->InsertNewChildElement("mass")->SetAttribute("value", 1);
  XMLElement* inertia = inertial->InsertNewChildElement("inertia");
  for (const char* diagonal : {"ixx", "iyy", "izz"}) inertia->SetAttribute(diagonal, 1);
  for (const char* product : {"ixy", "ixz", "iyz"}) inertia->SetAttribute(product, 0);
}

// The one link that is no joint's child (the file is known to be a tree: the front end has read it).
std::string root_link(XMLElement& robot) {
  std::set<std::string> children;
  for (auto* joint = robot.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    if (auto* child = joint->FirstChildElement("child")) children.insert(child->Attribute("link"));
  }
  for (auto* link = robot.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    if (!children.count(link->Attribute("name"))) return link->Attribute("name");
  }
  throw std::runtime_error("no root link");
}

void insert_floating_joint(XMLElement& robot) {
  const std::string root = root_link(robot);
  robot.InsertNewChildElement("link")->SetAttribute("name", "oracle_ground");
  XMLElement* joint = robot.InsertNewChildElement("joint");
  joint->SetAttribute("name", floating_joint_name);
  joint->SetAttribute("type", "floating");
  joint->InsertNewChildElement("parent")->SetAttribute("link", "oracle_ground");
  joint->InsertNewChildElement("child")->SetAttribute("link", root.c_str());
}

}  // namespace

std::string edited_urdf(const std::string& path, const UrdfEdit& edit) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS) throw std::runtime_error(path + ": " + document.ErrorStr());
  XMLElement* robot = document.FirstChildElement("robot");
  if (!robot) throw std::runtime_error(path + ": no <robot>");

  remove_children(*robot, {"transmission", "gazebo"});
  for (auto* link = robot->FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    remove_children(*link, {"visual", "collision"});
    if (edit.placeholder_inertia) set_placeholder_inertia(*link);
    prefix_attribute(link, "name");
  }
  for (auto* joint = robot->FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    prefix_attribute(joint->FirstChildElement("parent"), "link");
    prefix_attribute(joint->FirstChildElement("child"), "link");
  }
  if (edit.floating_joint) insert_floating_joint(*robot);

  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace dalembert::oracle
