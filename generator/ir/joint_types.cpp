#include "ir/joint_types.hpp"

#include <numbers>

#include "ir/robot_description.hpp"

namespace dalembert::ir {
namespace {

JointTypeRow fixed() {
  return {.word = "fixed",
          .coordinates = "",
          .nq = 0,
          .nv = 0,
          .quaternion = -1,
          .turns = false,
          .slides = false,
          .has_axis = false,
          .in_urdf = true,
          .in_scenes = false,
          .parts = [](const Joint&) { return std::vector<JointPart>(); }};
}

// In JointType's order.
const std::vector<JointTypeRow>& rows() {
  using namespace joints;
  static const std::vector<JointTypeRow> all = {revolute(), continuous(), prismatic(),  helical(), universal(),
                                                planar(),   spherical(),  free_flyer(), fixed()};
  return all;
}

JointWords words_of(bool JointTypeRow::*said) {
  JointWords words;
  for (std::size_t i = 0; i < rows().size(); ++i)
    if (rows()[i].*said) words.emplace_back(rows()[i].word, static_cast<JointType>(i));
  return words;
}

}  // namespace

const JointTypeRow& row_of(JointType type) { return rows()[static_cast<std::size_t>(type)]; }

double slide_per_unit(JointType type, double pitch) {
  const JointTypeRow& row = row_of(type);
  return !row.slides ? 0 : row.turns ? pitch / (2 * std::numbers::pi) : 1;
}

const char* word_of(bool turns, bool slides) {
  for (const JointTypeRow& row : rows())
    if (row.nv == 1 && row.turns == turns && row.slides == slides) return row.word;
  return row_of(JointType::fixed).word;
}

JointWords urdf_joint_words() { return words_of(&JointTypeRow::in_urdf); }
JointWords joint_words() { return words_of(&JointTypeRow::in_scenes); }

}  // namespace dalembert::ir
