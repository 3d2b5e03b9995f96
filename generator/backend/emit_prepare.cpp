#include "backend/emit_prepare.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/code_text.hpp"
#include "backend/kept.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

using ir::Source;

// Kept roles of one source; −1 where there is none.
int role_of(const CodeInput& code, Source source, bool held) {
  for (size_t r = 0; r < code.rolled.roles.size(); ++r)
    if (code.rolled.roles[r].source == source && code.rolled.roles[r].held == held && is_kept(code, static_cast<int>(r)))
      return static_cast<int>(r);
  return -1;
}

// A kept role that is a joint's number of one of the function's vectors.
struct Gathered {
  int role;
  std::string vector;
  int first;  // the joints' numbers in it begin there
};
std::vector<Gathered> gathered(const CodeInput& code) {
  std::vector<Gathered> all;
  const std::vector<std::string> vectors = vectors_of(code);
  const auto add = [&](Source source, const std::string& vector, int first) {
    if (const int role = role_of(code, source, false); role >= 0) all.push_back({role, vector, first});
  };
  add(Source::position, vectors[0], base_positions(code));
  add(Source::rate, vectors[1], base_rows(code));
  for (const Source source : {Source::acceleration, Source::effort}) add(source, vectors.back(), base_rows(code));
  return all;
}

// What is to be prepared: statements, tables and counts follow from this.
struct Prepared {
  std::vector<int> turning, sliding;  // joints
  bool quaternions = false;           // some joints' positions are not one number each
  bool plain = false;                 // all joints turn, and each by a coordinate of its own
  int sine[2], cosine[2], slide[2];   // roles of the joints as they are, and held; −1: none, or no joint has it
  std::vector<Gathered> gathered;

  explicit Prepared(const CodeInput& code) : gathered(backend::gathered(code)) {
    for (int k = 0; k < code.tree.joints(); ++k) {
      const ir::Body& joint = code.tree.bodies[static_cast<size_t>(k)];
      quaternions = quaternions || joint.of_quaternion();
      if (joint.of_quaternion()) continue;  // its pose is a parameter
      if (joint.turns()) turning.push_back(k);
      if (joint.slides()) sliding.push_back(k);
    }
    plain = sliding.empty() && !quaternions && !has_driven(code);
    for (const bool held : {false, true}) {
      sine[held] = turning.empty() ? -1 : role_of(code, Source::sine, held);
      cosine[held] = turning.empty() ? -1 : role_of(code, Source::cosine, held);
      slide[held] = sliding.empty() ? -1 : role_of(code, Source::slide, held);
    }
  }

  bool sines(bool held) const { return sine[held] >= 0; }  // a sine comes with its cosine
  bool any_sines() const { return sines(false) || sines(true); }
  bool any_slides() const { return slide[false] >= 0 || slide[true] >= 0; }
  bool angles() const { return any_sines() && !plain; }
  bool spreads() const { return !gathered.empty(); }
};

// The coordinate of every slot's joint, as a number of q or of v; where a lane has no body left, its last joint's.
std::vector<int> coordinates_of_slots(const CodeInput& code, bool of_q) {
  const std::vector<int> coordinates = of_q ? code.tree.positions() : code.tree.coordinates();
  std::vector<int> of(static_cast<size_t>(code.plan.slots), 0);
  for (const ir::Segment& s : code.plan.segments)
    for (int lane = 0; lane < s.width; ++lane) {
      int last = 0;
      for (int step = 0; step < s.steps; ++step) {
        const int body = s.bodies[static_cast<size_t>(lane)][static_cast<size_t>(step)];
        if (body >= 0) last = coordinates[static_cast<size_t>(body)];
        of[static_cast<size_t>(s.first_slot + step * s.width + lane)] = last;
      }
    }
  return of;
}

// The first slots of all fours in which limbs stand.
std::vector<int> fours(const CodeInput& code) {
  std::vector<int> first;
  for (const ir::Segment& s : code.plan.segments)
    for (int slot = 0; slot < s.slots(); slot += 4) first.push_back(s.first_slot + slot);
  return first;
}

// The position of a joint as a number of q.
std::string position(const CodeInput& code, int body) {
  const ir::Body& joint = code.tree.bodies[static_cast<size_t>(body)];
  const std::string q = fmt::format("q[{}]", base_positions(code) + code.tree.positions()[static_cast<size_t>(body)]);
  if (!joint.driven()) return q;
  return fmt::format("{} * {} + {}", literal(joint.multiplier, code.scene.scalar), q, literal(joint.offset, code.scene.scalar));
}

// Of a screw: how far it slides for its angle.
std::string slide(const CodeInput& code, int body) {
  const ir::Body& joint = code.tree.bodies[static_cast<size_t>(body)];
  const std::string q = position(code, body);
  return fmt::format("{} * {}", literal(joint.slide_per_unit(), code.scene.scalar), joint.driven() ? "(" + q + ")" : q);
}

// The positions of the joints of one kind, to an array with a place per slot; joints that are held are left out.
std::string spread(const CodeInput& code, const std::string& array, const std::string& kind, const std::vector<int>& joints,
                   bool held) {
  std::vector<std::string> apart;
  std::string skip, text;
  for (size_t i = 0; i < joints.size(); ++i) {
    const int k = joints[i];
    const ir::Body& joint = code.tree.bodies[static_cast<size_t>(k)];
    const bool rests = held && code.tree.carries_reference(static_cast<size_t>(k));
    if (rests) apart.push_back(fmt::format("k == {}", i));
    if (rests) continue;
    if (kind == "sliding" && joint.is_screw())
      text += fmt::format("  {}[{}] = {};  // helical joint\n", array, slot_of(code, k), slide(code, k));
    else if (joint.driven())
      text += fmt::format("  {}[{}] = {};  // mimic joint\n", array, slot_of(code, k), position(code, k));
  }
  if (!apart.empty()) skip = fmt::format("if (!({})) ", fmt::join(apart, " || "));
  // Driven joints are set after the loop, which takes their drivers' positions for them; so are the slides of screws.
  return fmt::format("  for (int k = 0; k < {0}; ++k) {1}{2}[{3}_slot[k]] = q[{4} + {3}_joint[k]];\n{5}", joints.size(), skip,
                     array, kind, base_positions(code), text);
}

std::string at_rest(const CodeInput& code, const Prepared& p) {
  std::string text;
  for (int k = 0; k < code.tree.joints(); ++k)
    if (code.tree.carries_reference(static_cast<size_t>(k)))
      text += fmt::format("  {0}[{2}] = 0;\n  {1}[{2}] = 1;\n", kept(code, p.sine[true], 0), kept(code, p.cosine[true], 0),
                          slot_of(code, k));
  return text;
}

// Of sincos_of_slots(): how many slots, fours of them, and angles together where recursions take four limbs at most.
std::string slots_text(const CodeInput& code) {
  const auto& segments = code.plan.segments;
  const bool by_fours =
      code.plan.slots > 8 && std::none_of(segments.begin(), segments.end(), [](const auto& s) { return s.width > 4; });
  return fmt::format("{}, {}{}", code.plan.slots, fours(code).size(), by_fours ? ", 4" : "");
}

std::string sines_text(const CodeInput& code, const Prepared& p, bool held) {
  const std::string s = kept(code, p.sine[held], 0), c = kept(code, p.cosine[held], 0);
  if (!p.plain)
    return "  // Sines and cosines of all angles together; slots without a turning joint stay at zero.\n" +
           spread(code, "scratch.angle[0]", "turning", p.turning, held) +
           fmt::format("  dalembert::sincos_of_slots<{}>(scratch.angle[0], first_of_four, {}, {});\n", slots_text(code), s, c);
  return fmt::format(
      "  // Sines and cosines of all angles together.\n"
      "  dalembert::sincos_of_slots_at<{}>(q + {}, slot_joint, first_of_four, {}, {});\n",
      slots_text(code), base_positions(code), s, c);
}

}  // namespace

bool needs_angles(const CodeInput& code) { return Prepared(code).angles(); }

bool prepare_reads_q(const CodeInput& code) {
  const Prepared p(code);
  return p.any_sines() || p.any_slides();
}

bool prepare_spreads(const CodeInput& code) { return Prepared(code).spreads(); }

std::string prepare_statements(const CodeInput& code) {
  const Prepared p(code);
  std::string text;
  if (p.sines(false)) text += sines_text(code, p, false);
  if (p.sines(true)) {
    text +=
        p.sines(false)
            ? fmt::format(
                  "  // The joints that carry the frame of reference stand at zero in Phase I: nothing made of poses depends "
                  "on them.\n"
                  "  for (int i = 0; i < {}; ++i) {{\n    {}[i] = {}[i];\n    {}[i] = {}[i];\n  }}\n",
                  code.plan.slots, kept(code, p.sine[true], 0), kept(code, p.sine[false], 0), kept(code, p.cosine[true], 0),
                  kept(code, p.cosine[false], 0))
            : sines_text(code, p, true);
    text += at_rest(code, p);
  }
  for (const bool held : {false, true})
    if (p.slide[held] >= 0) text += spread(code, kept(code, p.slide[held], 0), "sliding", p.sliding, held);
  for (const Gathered& g : p.gathered)
    text += fmt::format(
        "  for (const int i : first_of_four) dalembert::store<4, Scalar>({} + i, dalembert::gather<4>({} + {}, {} + "
        "i));\n",
        kept(code, g.role, 0), g.vector, g.first,
        p.quaternions && code.rolled.roles[static_cast<size_t>(g.role)].source == Source::position ? "slot_position"
                                                                                                   : "slot_joint");
  return text;
}

std::string prepare_tables(const CodeInput& code) {
  const Prepared p(code);
  const std::vector<int> coordinates = code.tree.positions();
  std::string text;
  const auto tables = [&](const std::string& kind, const std::vector<int>& of) {
    std::vector<int> slots, from;
    for (int k : of) slots.push_back(slot_of(code, k)), from.push_back(coordinates[static_cast<size_t>(k)]);
    text += int_table(kind + "_slot", slots) + int_table(kind + "_joint", from);
  };
  // Numbers of q alone in a part of a robot are others than those of v.
  if (p.spreads() || (p.plain && p.any_sines())) text += int_table("slot_joint", coordinates_of_slots(code, !p.spreads()));
  if (p.quaternions && role_of(code, Source::position, false) >= 0)
    text += int_table("slot_position", coordinates_of_slots(code, true));
  if (p.spreads() || p.any_sines()) text += int_table("first_of_four", fours(code));
  if (p.angles()) tables("turning", p.turning);
  if (p.any_slides()) tables("sliding", p.sliding);
  return text;
}

ir::Operations prepare_operations(const CodeInput& code) {
  const Prepared p(code);
  ir::Operations sum;
  const auto rests = [&](int k, bool held) { return held && code.tree.carries_reference(static_cast<size_t>(k)); };
  // A multiplier and an offset each.
  const auto positions = [&](const std::vector<int>& of, bool held) {
    for (const int k : of)
      if (code.tree.bodies[static_cast<size_t>(k)].driven() && !rests(k, held)) ++sum.multiply, ++sum.add;
  };
  if (p.any_sines()) sum.sincos = 4 * static_cast<long>(fours(code).size());
  if (p.angles()) positions(p.turning, !p.sines(false));
  for (const bool held : {false, true})
    if (p.slide[held] >= 0) {
      positions(p.sliding, held);
      sum.multiply += std::count_if(p.sliding.begin(), p.sliding.end(), [&](int k) {
        return code.tree.bodies[static_cast<size_t>(k)].is_screw() && !rests(k, held);
      });
    }
  return sum;
}

}  // namespace dalembert::backend
