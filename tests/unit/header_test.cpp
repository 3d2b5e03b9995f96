// The generated header is the manual: what is called begins before line 30, no line is too long to read, results say what they
// are, internals stand behind, and the words are the field's.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <read_robot.hpp>
#include <regex>
#include <sstream>

#include "compile.hpp"
#include "diagnostics.hpp"
#include "ir/aliases.hpp"
#include "ir/joint_words.hpp"

namespace dalembert {
namespace {

struct Case {
  const char *name, *robot, *form;
  Settings settings;
};

// Those of contacts, where the scene has some.
std::string every_output(bool of_contacts = false) {
  std::string names;
  for (const ir::QuantityRow& row : ir::quantities())
    if (of_contacts || !ir::is_of_constraints(row.quantity)) names += (names.empty() ? "" : ",") + std::string(row.name);
  return names;
}

// What a header can hold: both forms; every quantity, every quantity of links; run-time inputs; mimic and elastic joints; named
// functions; a fixed base.
const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"all_rolled",
       "two_levels_of_branching",
       "rolled",
       {{"contacts", "c_01=weld"}, {"outputs", every_output(true)}, {"wrenches", "c_01"}, {"parallel", "tasks"}}},
      {"all_straight", "skew_axes", "straight", {{"base", "fixed"}, {"outputs", every_output()}, {"gravity", "run_time"}}},
      {"frames",
       "two_levels_of_branching",
       "",
       {{"frames",
         "{c_01: [pose, twist, jacobian, jacobian_world, jacobian_mixed, acceleration_bias, acceleration_bias_world, "
         "acceleration_bias_mixed]}"},
        {"payloads", "c_01"},
        {"functions",
         "{reach: [mass_matrix_factor, bias, jacobian_mixed_c_01], plan: [forward_dynamics, forward_dynamics_dq]}"}}},
      {"mimic",
       "chain_7",
       "rolled",
       {{"mimic", "{link_03_joint: {of: link_05_joint, multiplier: 2}}"}, {"outputs", every_output()}}},
      {"elastic", "chain_7", "", {{"base", "fixed"}, {"elastic", "{link_03_joint: {k: 100, inertia: 0.1}}"}}},
  };
  return all;
}

// What is emitted of each case, in their order.
const std::vector<std::vector<backend::OutputFile>>& emitted() {
  static const std::vector<std::vector<backend::OutputFile>> all = [] {
    std::vector<std::vector<backend::OutputFile>> files;
    for (const Case& c : cases()) files.push_back(compile_without_self_test(read_robot(c.robot, c.settings, c.form)));
    return files;
  }();
  return all;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

size_t line_with(const std::vector<std::string>& lines, const std::string& text) {
  const auto at =
      std::find_if(lines.begin(), lines.end(), [&](const std::string& line) { return line.find(text) != line.npos; });
  return static_cast<size_t>(at - lines.begin());
}

void expect_readable(const std::string& header) {
  const std::vector<std::string> lines = lines_of(header);
  EXPECT_LT(line_with(lines, "inline constexpr int nq"), 29u);
  for (size_t i = 0; i < lines.size(); ++i) EXPECT_LE(lines[i].size(), 120u) << "line " << i + 1 << ": " << lines[i];
  const size_t functions = line_with(lines, "// Functions."), results = line_with(lines, "// Results"),
               workspace = line_with(lines, "struct Workspace {"), scratch = line_with(lines, "  struct "),
               notes = line_with(lines, "// Notes");
  EXPECT_LT(functions, results);
  EXPECT_LT(results, workspace);
  EXPECT_LT(workspace, notes);
  ASSERT_LT(notes, lines.size());
  EXPECT_LT(workspace, scratch) << "internals stand behind the interface";
  EXPECT_LT(notes, line_with(lines, "// all together")) << "operations are counted behind the interface";
  // Every result is told of: symbol, unit, meaning.
  static const std::regex told(R"(^// .+ \[.+\]: .+)");
  int count = 0;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].starts_with("inline Result<") || !lines[i].ends_with(");")) continue;
    ++count;
    size_t first = i;
    while (first > 0 && lines[first - 1].starts_with("// ")) --first;
    std::string comment = "//";
    for (size_t k = first; k < i; ++k) comment += lines[k].substr(2);
    EXPECT_TRUE(std::regex_search(comment, told)) << lines[i] << "\n" << comment;
    EXPECT_EQ(comment.find("LINK"), comment.npos) << comment;
  }
  EXPECT_GT(count, 0);
}

TEST(Header, IsTheManual) {
  for (size_t i = 0; i < cases().size(); ++i) {
    SCOPED_TRACE(cases()[i].name);
    for (const backend::OutputFile& file : emitted()[i])
      if (file.name == "dynamics.hpp") expect_readable(file.text);
  }
}

// The same of those that are committed, MAHRU's and an arm's.
TEST(Header, OfTheCommittedRobotsIsTheManual) {
  for (const char* robot : {"mahru", "arm"}) {
    SCOPED_TRACE(robot);
    std::ifstream in(std::string(GENERATED) + "/" + robot + "/dynamics.hpp");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    ASSERT_FALSE(text.empty());
    expect_readable(text);
  }
}

// Names may be as long as a URDF has them; lines are broken where a blank allows it.
// Who has the header alone knows whose rows are whose, and who follows whom.
TEST(Header, TellsRowsAndFollowers) {
  const Settings settings{
      {"contacts", "{foot: {link: c_01, type: weld}, toe: {link: d_02, type: point, at: [0.1, 0, -0.05], axes: link}}"},
      {"loops", "{tie: {links: [e_02, f_01], type: hinge}}"},
      {"mimic", "{b_02_joint: {of: b_01_joint, multiplier: -2, offset: 0.1}}"},
      {"outputs", "constraint_jacobian"}};
  const std::string wrapped = compile_without_self_test(read_robot("two_levels_of_branching", settings, "")).front().text,
                    text = std::regex_replace(wrapped, std::regex("\n//     "), " ");
  for (const char* line :
       {"//   b_02_joint = -2 b_01_joint + 0.1\n",
        "//   foot: weld of link c_01, at 0 0 0 in its frame, m; rows 0 to 2 x y z, 3 to 5 about x y z, along the world's "
        "axes\n",
        "//   toe: point of link d_02, at 0.1 0 -0.05 in its frame, m; rows 6 to 8 x y z, along the link's axes\n",
        "rows 9 to 11 x y z, 12 to 13 about x y, along the first frame's axes\n"})
    EXPECT_NE(text.find(line), text.npos) << line;
}

TEST(Header, LongNamesBreakLines) {
  const TestRobot* robot = std::find_if(std::begin(test_robots), std::end(test_robots),
                                        [](const TestRobot& r) { return r.name == std::string_view("chain_7"); });
  std::ifstream in(robot->urdf);
  const std::string urdf{std::istreambuf_iterator<char>(in), {}};
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "header_test_long_names.urdf";
  std::ofstream(file) << std::regex_replace(urdf, std::regex("link_"), "the_link_of_the_manipulator_by_its_number_");
  Request request;
  request.robot = file.string();
  request.settings = {{"frames", "the_link_of_the_manipulator_by_its_number_07"},
                      {"payloads", "the_link_of_the_manipulator_by_its_number_07"}};
  Diagnostics warnings;
  for (const backend::OutputFile& output : compile_without_self_test(read_model(request, warnings)))
    if (output.name == "dynamics.hpp") expect_readable(output.text);
  std::filesystem::remove(file);
}

TEST(Header, TellsWhatIsNotReadByBranches) {
  const Model model = read_robot("humanoid", {{"outputs", "[]"}, {"jacobians", "leg_left_6_ankle_roll"}});
  std::string header;
  for (const backend::OutputFile& file : compile_without_self_test(model))
    if (file.name == "dynamics.hpp") header = std::regex_replace(file.text, std::regex("\n// *"), " ");
  const std::string leg = "leg_left_1_hip_yaw_joint to leg_left_6_ankle_roll_joint";
  EXPECT_NE(header.find("Not read: the base's pose; positions of all joints but " + leg + "; v."), header.npos);
  std::vector<int> of_leg{0, 1, 2, 3, 4, 5}, others;
  for (int k = 6; k < model.tree.joints(); ++k) others.push_back(k);
  EXPECT_EQ(ir::joints_in_words(others, model.tree), "all joints but " + leg);
  EXPECT_EQ(ir::joints_in_words(of_leg, model.tree), leg);
  EXPECT_EQ(ir::joints_in_words({0}, model.tree), "leg_left_1_hip_yaw_joint");
  EXPECT_EQ(ir::joints_in_words({0, 1}, model.tree), "leg_left_1_hip_yaw_joint, leg_left_2_hip_roll_joint");
}

// docs_test.py reads the same list against the pages, help and messages.
TEST(Words, OfEmittedTextAreTheFields) {
  std::ifstream list(WORDS);
  std::vector<std::pair<std::string, std::regex>> words;
  for (std::string line; std::getline(list, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::string word = line.substr(0, line.find('\t'));
    words.emplace_back(word, std::regex(word, std::regex::icase));
  }
  ASSERT_GT(words.size(), 5u) << WORDS;
  for (size_t i = 0; i < cases().size(); ++i)
    for (const backend::OutputFile& file : emitted()[i])
      for (const std::string& line : lines_of(file.text))
        for (const auto& [word, pattern] : words)
          EXPECT_FALSE(std::regex_search(line, pattern))
              << cases()[i].name << ", " << file.name << ": '" << word << "' in: " << line;
}

// A ball has four numbers in q and three in v: what stands behind it is one further in q.
TEST(HeaderForC, SaysWhereJointsStand) {
  const Model model =
      read_robot("chain_7", {{"base", "floating"}, {"joints", "{link_03_joint: spherical}"}, {"outputs", "bias"}});
  std::string c_api;
  for (const backend::OutputFile& file : compile_without_self_test(model))
    if (file.name == "c_api.h") c_api = file.text;
  for (const std::string item :
       {"q_size = 17", "v_size = 15", "q_index_link_01_joint = 7", "v_index_link_01_joint = 6", "q_index_link_03_joint_x = 9",
        "v_index_link_03_joint_x = 8", "q_index_link_03_joint_z = 9", "v_index_link_03_joint_z = 10",
        "q_index_link_04_joint = 13", "v_index_link_04_joint = 11", "q_index_link_07_joint = 16", "v_index_link_07_joint = 14"})
    EXPECT_TRUE(std::regex_search(c_api, std::regex("\\b" + model.name + "_" + item + "\\b"))) << item << "\n" << c_api;
  EXPECT_NE(c_api.find("link_03_joint: quaternion x y z w q[9] to q[12]"), c_api.npos) << c_api;
}

TEST(Aliases, AreTheFieldsNamesForOurs) {
  for (const auto* aliases : {&ir::quantity_aliases(), &ir::link_quantity_aliases()})
    for (const ir::Alias& alias : *aliases) {
      EXPECT_FALSE(ir::quantity_named(alias.alias)) << alias.alias;
      EXPECT_FALSE(ir::link_quantity_named(alias.alias)) << alias.alias;
      EXPECT_EQ(ir::named_by_us(alias.alias, *aliases), alias.name);
      EXPECT_EQ(ir::named_by_us(alias.name, *aliases), alias.name);
    }
  const Model theirs = read_robot("chain_7", {{"outputs", "crba,nle,com,aba,ccrba"},
                                              {"functions", "{step: [rnea, com]}"},
                                              {"frames", "{link_07: [placement, local_world_aligned, local]}"}}),
              ours = read_robot("chain_7", {{"outputs", "mass_matrix,bias,center_of_mass,forward_dynamics,momentum_matrix"},
                                            {"functions", "{step: [inverse_dynamics, center_of_mass]}"},
                                            {"frames", "{link_07: [pose, jacobian_mixed, jacobian]}"}});
  EXPECT_EQ(theirs.scene.outputs, ours.scene.outputs);
  EXPECT_EQ(theirs.scene.frames, ours.scene.frames);
  EXPECT_EQ(theirs.scene.functions.at(0).quantities, ours.scene.functions.at(0).quantities);
  EXPECT_THROW(read_robot("chain_7", {{"outputs", "com,center_of_mass"}}), InputError) << "the same twice";
}

}  // namespace
}  // namespace dalembert
