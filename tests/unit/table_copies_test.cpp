// No emitted loop stores a bare table of constants: it would become a memcpy of constants, which g++ 12.2 expands wrongly for
// targets with AVX-512. tests/matrix/table_copies.py reads the same from what the compiler makes of the code.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <robots.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "compile.hpp"
#include "frontend/urdf_reader.hpp"
#include "pipeline.hpp"

namespace dalembert {
namespace {

// The stores of `code` whose value is what was just loaded from a table.
std::vector<std::string> stored_tables(const std::string& code) {
  static const std::regex load(R"(const V (\w+) = dalembert::load<[^(]*\((?!scratch)[^;]*\);)"),
      store(R"(dalembert::store<[^(]*\(scratch[^,]*, (\w+|dalembert::load<[^(]*\((?!scratch)[^()]*\))\);)");
  std::vector<std::string> found, names;
  std::istringstream lines(code);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.find("for (") != std::string::npos) names.clear();
    if (std::regex_search(line, match, load)) names.push_back(match[1]);
    if (!std::regex_search(line, match, store)) continue;
    const std::string value = match[1];
    if (value.starts_with("dalembert::load") || std::find(names.begin(), names.end(), value) != names.end())
      found.push_back(line);
  }
  return found;
}

TEST(TableCopies, AreFoundInText) {
  EXPECT_EQ(stored_tables("dalembert::store<4, Scalar>(scratch.first[0] + slot, dalembert::load<4>(arm_first_x + i));").size(),
            1);
  EXPECT_EQ(stored_tables("const V first_x_k = dalembert::load<4>(arm_first_x + i);\n"
                          "dalembert::store<4, Scalar>(scratch.first[0] + slot, first_x_k);")
                .size(),
            1);
  EXPECT_TRUE(stored_tables("const V sine = dalembert::load<4>(scratch.sine[0] + slot);\n"
                            "dalembert::store<4, Scalar>(scratch.first[0] + slot, sine);\n"
                            "dalembert::store<4, Scalar>(scratch.first[0] + slot, 2.0 * dalembert::load<4>(arm_first_x + i));")
                  .empty());
}

class EmittedCode : public ::testing::TestWithParam<TestRobot> {};

// Of a tree of ten branches two joints long, alike but for their numbers, which would be written in place if they were the
// same.
TEST(Tables, HaveNamesOfTheirOwn) {
  const auto link = [](const std::string& name) {
    const std::string digit(1, static_cast<char>('0' + name[0] % 10));
    return "<link name='" + name + "'><inertial><origin xyz='0.1" + digit + " 0.01" + digit + " -0.02" + digit +
           "'/><mass value='2." + digit + "'/><inertia ixx='0.0118' ixy='0.0004" + digit + "' ixz='-0.0003" + digit +
           "' iyy='0.0161' iyz='0.0002" + digit + "' izz='0.0157'/></inertial></link>";
  };
  const auto joint = [](const std::string& parent, const std::string& child, const char* axis) {
    return "<joint name='to_" + child + "' type='continuous'><origin xyz='0.3" +
           std::string(1, static_cast<char>('0' + child[0] % 10)) + " 0 0.02'/><parent link='" + parent + "'/><child link='" +
           child + "'/><axis xyz='" + axis + "'/></joint>";
  };
  std::string text = "<robot name='tree'>" + link("base");
  for (char branch = 'a'; branch < 'k'; ++branch) {
    const std::string upper = std::string(1, branch) + "1", lower = std::string(1, branch) + "2";
    text += link(upper) + link(lower) + joint("base", upper, "0 0 1") + joint(upper, lower, "0 1 0");
  }
  Diagnostics warnings;
  Model model;
  model.description = frontend::read_urdf_text("tree.urdf", text + "</robot>", warnings);
  model.name = "tree";
  model.options.form = ir::Form::rolled;
  apply_scene(model, frontend::read_scene_text("", "", {{"base", "fixed"}, {"outputs", "mass_matrix"}}), warnings);
  const std::regex table(R"(constexpr Scalar (\w+)\[)");
  std::vector<std::string> names;
  for (const backend::OutputFile& file : compile_without_self_test(model))
    for (std::sregex_iterator at(file.text.begin(), file.text.end(), table), end; at != end; ++at) names.push_back((*at)[1]);
  EXPECT_GT(names.size(), 10u);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << *std::adjacent_find(names.begin(), names.end());
}

TEST_P(EmittedCode, StoresNoTable) {
  for (const char* base : {"fixed", "floating"}) {
    Diagnostics warnings;
    const Model model = read_model(
        {GetParam().urdf, "", {{"base", base}, {"outputs", "mass_matrix,coriolis_matrix,gravity,bias"}}, "rolled", {}, ""},
        warnings);
    for (const backend::OutputFile& file : compile(model))
      for (const std::string& line : stored_tables(file.text)) ADD_FAILURE() << base << ", " << file.name << ": " << line;
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, EmittedCode, ::testing::ValuesIn(test_robots),
                         [](const auto& robot) { return robot.param.name; });

}  // namespace
}  // namespace dalembert
