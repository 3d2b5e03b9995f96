#include "backend/emit_notes.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "backend/literals.hpp"
#include "ir/constraint_words.hpp"
#include "ir/plan_words.hpp"

namespace dalembert::backend {
namespace {

std::string links(const CodeInput& code) {
  std::string text = "// Links and the bodies they move with:\n";
  for (const ir::LinkPlacement& link : code.robot->links)
    if (link.on.empty())
      text += comment_lines(
          fmt::format("  {:<32} {}", link.link,
                      link.body < 0 ? code.robot->base_link : code.robot->bodies[static_cast<size_t>(link.body)].name),
          0, 4);
  if (code.scene.placed.empty()) return text;
  text += "// Frames of the scene, the links that they are on, their origins there, m, and roll, pitch, yaw, rad:\n";
  for (const ir::Frame& frame : code.scene.placed)
    text += comment_lines(fmt::format("  {:<32} {}, {:.6g} {:.6g} {:.6g}, {:.6g} {:.6g} {:.6g}", frame.name, frame.link,
                                      frame.xyz.x(), frame.xyz.y(), frame.xyz.z(), frame.rpy.x(), frame.rpy.y(), frame.rpy.z()),
                          0, 4);
  return text;
}

std::string followers(const CodeInput& code) {
  std::string text;
  for (const ir::Body& body : code.robot->bodies) {
    if (!body.driven()) continue;
    const std::string& driver = code.robot->bodies[static_cast<size_t>(body.driven_by)].joint;
    const std::string offset =
        body.offset == 0 ? "" : fmt::format(" {} {}", body.offset < 0 ? '-' : '+', std::abs(body.offset));
    text += comment_lines(fmt::format("  {} = {} {}{}", body.joint, body.multiplier, driver, offset), 0, 4);
  }
  return text.empty() ? "" : "// Joints that follow others, without a coordinate of their own; rad, m:\n" + text;
}

std::string place(const Eigen::Isometry3d& at) {
  const Eigen::Vector3d p = at.translation();
  std::string text = fmt::format("{:.6g} {:.6g} {:.6g}", p.x(), p.y(), p.z());
  if (at.linear().isIdentity()) return text;
  const Eigen::Quaterniond turned(at.linear());
  return text +
         fmt::format(" and turned by x y z w {:.6g} {:.6g} {:.6g} {:.6g}", turned.x(), turned.y(), turned.z(), turned.w());
}

// "0 to 2 x y z, 3 to 5 about x y z"
std::string rows_in_words(int first, const std::vector<int>& linear, const std::vector<int>& angular) {
  std::string text;
  const auto add = [&](const char* about, const std::vector<int>& axes) {
    if (axes.empty()) return;
    const int last = first + static_cast<int>(axes.size()) - 1;
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", first, last > first ? fmt::format(" to {}", last) : "");
    text += about;
    for (const int axis : axes) text += fmt::format(" {}", "xyz"[axis]);
    first = last + 1;
  };
  add("", linear), add(" about", angular);
  return text;
}

std::string constraints(const CodeInput& code) {
  const ir::Scene& scene = code.scene;
  if (!scene.any_constraint()) return "";
  std::string text = "// Contacts and loops, and their rows among those of all:\n";
  int row = 0;
  for (const ir::Contact& c : scene.contacts) {
    const std::vector<int> xyz{0, 1, 2};
    text += comment_lines(fmt::format("  {}: {} of {}, at {} in its frame, m; rows {}, along {} axes", c.name,
                                      ir::word_of(ir::contact_words(), c.type), scene.called(c.link),
                                      place(Eigen::Isometry3d(Eigen::Translation3d(c.at))),
                                      rows_in_words(row, xyz, c.type == ir::ContactType::weld ? xyz : std::vector<int>{}),
                                      c.along_link ? "the link's" : "the world's"),
                          0, 4);
    row += c.rows();
  }
  for (const ir::Loop& l : scene.loops) {
    const std::string rows = l.type == ir::LoopType::distance ? fmt::format("{}: the distance", row)
                                                              : rows_in_words(row, l.linear_axes(), l.angular_axes());
    text += comment_lines(
        fmt::format("  {}: {} of {}, at {} in its frame, with {}, at {} in its frame, m; rows {}{}", l.name,
                    ir::word_of(ir::loop_words(), l.type), scene.called(l.links[0]), place(l.at[0]), scene.called(l.links[1]),
                    place(l.at[1]), rows, l.type == ir::LoopType::distance ? "" : ", along the first frame's axes"),
        0, 4);
    row += l.rows();
  }
  return text;
}

}  // namespace

std::string followers_and_constraints(const CodeInput& code) { return followers(code) + constraints(code); }

std::string tables_of_robot(const CodeInput& code) { return links(code) + followers_and_constraints(code); }

}  // namespace dalembert::backend
