#include "passes/lower_rolled.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "passes/equations.hpp"
#include "passes/lower.hpp"
#include "passes/lower_inputs.hpp"

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;
using ir::NodeId;
using ir::Paragraph;
using ir::Quantity;

std::vector<ir::Role> make_roles() {
  std::vector<ir::Role> r(role_count);
  r[sine] = {"sine", "sin q", 1};
  r[cosine] = {"cosine", "cos q", 1};
  r[slide] = {"slide", "q of prismatic joints, m", 1};
  r[rate] = {"rate", "dq", 1};
  r[pose_sine] = {"pose_sine", "sin q, 0 where the joint carries the reference frame", 1};
  r[pose_cosine] = {"pose_cosine", "cos q, 1 where the joint carries the reference frame", 1};
  r[pose_slide] = {"pose_slide", "q of prismatic joints, 0 where the joint carries the reference frame", 1};
  r[rotation] = {"rotation", "R, column by column", 9};
  r[position] = {"position", "p", 3};
  r[joint_linear] = {"joint_linear", "J, linear part", 3};
  r[joint_angular] = {"joint_angular", "J, angular part", 3};
  r[joint_rate] = {"joint_rate", "dJ", 6};
  r[body_linear] = {"body_linear", "u", 3};
  r[body_angular] = {"body_angular", "w", 3};
  r[first] = {"first", "h, of the body, then of its subtree", 3};
  r[second] = {"second", "S: xx xy xz yy yz zz", 6};
  r[momentum] = {"momentum", "P", 3};
  r[bias_block] = {"bias_block", "D, row by row", 9};
  r[inertia_force] = {"inertia_force", "F = A* J", 6};
  r[bias_force] = {"bias_force", "G = A* dJ + B* J", 6};
  r[transposed] = {"transposed", "H", 3};
  r[below_force] = {"below_force", "ad(V)' F + H, for the base's columns", 6};
  r[down] = {"down", "gravity along the body's axes", 3};
  r[gravity_first] = {"gravity_first", "h of the subtree in the body's axes", 3};
  r[gravity_torque] = {"gravity_torque", "g", 1};
  r[motion] = {"motion", "w, dw, a in the body's axes", 9};
  r[force] = {"force", "f, n of the subtree in the body's axes", 6};
  r[bias_torque] = {"bias_torque", "C v + g", 1};
  return r;
}

// The paragraph under construction and its tables.
class SegmentLowering {
 public:
  SegmentLowering(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Segment& segment,
                  const ir::RolledProgram& program, const std::vector<double>& composite_mass,
                  const ir::Graph::Options& options, ir::SegmentCode& code)
      : tree_(tree),
        normal_(normal),
        segment_(segment),
        program_(program),
        composite_mass_(composite_mass),
        options_(options),
        code_(code) {}

  Paragraph& begin(const std::string& name, const std::string& equation, Direction direction) {
    code_.paragraphs.push_back({name, equation, direction, ir::Graph(options_), {}, {}});
    paragraph_ = &code_.paragraphs.back();
    return *paragraph_;
  }

  ir::Graph& graph() { return paragraph_->graph; }
  Sym constant(double value) { return {&graph(), graph().constant(value)}; }
  Sym input(InputKind kind, int index, int component = 0) { return {&graph(), graph().input({kind, index, component})}; }
  Sym state(int role, int component = 0) { return input(InputKind::state, role, component); }
  Vec3 state3(int role, int from = 0) { return {state(role, from), state(role, from + 1), state(role, from + 2)}; }
  Sym carried(int role, int component) { return input(InputKind::carried, role, component); }
  Vec3 carried3(int role, int from = 0) { return {carried(role, from), carried(role, from + 1), carried(role, from + 2)}; }
  void store(int role, int component, Sym x) { paragraph_->stores.push_back({role, component, x.id}); }
  void store(int role, const Vec3& x, int from = 0) {
    for (int i = 0; i < 3; ++i) store(role, from + i, x[static_cast<size_t>(i)]);
  }
  void carry(int role, int component, Sym x) { paragraph_->carried.push_back({role, component, x.id}); }
  void carry(int role, const Vec3& x, int from = 0) {
    for (int i = 0; i < 3; ++i) carry(role, from + i, x[static_cast<size_t>(i)]);
  }

  // A constant of every body of the segment: a number where all agree, else a column of the table. Where a lane holds no body
  // kinematic constants may be anything (another lane's are taken), inertial ones are zero.
  Sym table(const std::string& name, bool inertial, const std::function<double(size_t body)>& value) {
    std::vector<double> values(static_cast<size_t>(segment_.slots()), 0);
    bool first = true, uniform = true;
    double common = 0;
    const auto see = [&](double x) {
      if (first) common = x;
      uniform = uniform && x == common;
      first = false;
    };
    for (int step = 0; step < segment_.steps; ++step) {
      double spare = 0;
      for (int lane = 0; lane < segment_.width; ++lane)
        if (const int b = body(lane, step); b >= 0) spare = value(static_cast<size_t>(b));
      for (int lane = 0; lane < segment_.width; ++lane) {
        const int b = body(lane, step);
        double& x = values[static_cast<size_t>(step * segment_.width + lane)];
        x = b >= 0 ? value(static_cast<size_t>(b)) : inertial ? 0 : spare;
        if (b >= 0 || inertial) see(x);
      }
    }
    if (uniform) return constant(common);
    for (size_t c = 0; c < code_.columns.size(); ++c)
      if (code_.columns[c].values == values) return input(InputKind::table, static_cast<int>(c));
    code_.columns.push_back({name, values});
    return input(InputKind::table, static_cast<int>(code_.columns.size()) - 1);
  }

  // `reference`: for the poses of Phase I, where a fixed base's first bodies are the frames of reference.
  BodyConstants body_constants(bool reference) {
    const auto n = [this](size_t b) -> const ir::NormalBody& { return normal_.bodies[b]; };
    const auto held = [=, this](size_t b) { return reference && !tree_.floating_base && n(b).parent < 0; };
    BodyConstants c;
    const std::string prefix = reference ? "pose_" : "";
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<size_t>(i);
      for (int j = 0; j < 3; ++j)
        c.rotation[at][static_cast<size_t>(j)] = table(prefix + "rotation_" + "xyz"[i] + "xyz"[j], false, [=](size_t b) {
          return held(b) ? double(i == j) : n(b).rotation(i, j);
        });
      c.translation[at] =
          table(prefix + "translation_" + "xyz"[i], false, [=](size_t b) { return held(b) ? 0 : n(b).translation[i]; });
      c.first[at] = table(std::string("first_") + "xyz"[i], true, [=](size_t b) { return n(b).moments.first[i]; });
      for (int j = i; j < 3; ++j)
        c.second[sym6_index[at][static_cast<size_t>(j)]] =
            table(std::string("second_") + "xyz"[i] + "xyz"[j], true, [=](size_t b) { return n(b).moments.second(i, j); });
    }
    c.revolute = table("revolute", false, [=](size_t b) { return n(b).prismatic ? 0 : 1; });
    c.prismatic = table("prismatic", false, [=](size_t b) { return n(b).prismatic ? 1 : 0; });
    c.mass = table("mass", true, [=](size_t b) { return n(b).moments.mass; });
    c.half_trace = table("half_trace", true, [=](size_t b) { return n(b).moments.half_trace; });
    return c;
  }
  Sym composite_mass() {
    return table("composite_mass", true, [this](size_t b) { return composite_mass_[b]; });
  }

  JointPosition joint_position(bool reference) {
    bool turning = false, sliding = false;
    for_each_body([&](size_t b) { (normal_.bodies[b].prismatic ? sliding : turning) = true; });
    const bool apart = reference && !tree_.floating_base;
    return {turning ? state(apart ? pose_sine : sine) : constant(0),
            turning ? state(apart ? pose_cosine : cosine) : constant(1),
            sliding ? state(apart ? pose_slide : slide) : constant(0)};
  }

  Twist joint() { return {state3(joint_linear), program_.all_revolute ? state3(rotation, 6) : state3(joint_angular)}; }
  Mat3 rotation_matrix(const std::function<Vec3(int, int)>& source) {
    const Vec3 z = source(rotation, 6), y = source(rotation, 3), x = source(rotation, 0);
    return from_columns(x, y, z);
  }
  Sums sums(const std::function<Sym(int, int)>& source) {
    Sums s;
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<size_t>(i);
      s.first[at] = source(first, i);
      s.momentum[at] = source(momentum, i);
      for (int j = 0; j < 3; ++j) s.bias[at][static_cast<size_t>(j)] = source(bias_block, 3 * i + j);
    }
    for (int i = 0; i < 6; ++i) s.second[static_cast<size_t>(i)] = source(second, i);
    return s;
  }
  template <class Put>
  static void each(const Sums& s, const Put& put) {
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<size_t>(i);
      put(first, i, s.first[at]);
      put(momentum, i, s.momentum[at]);
      for (int j = 0; j < 3; ++j) put(bias_block, 3 * i + j, s.bias[at][static_cast<size_t>(j)]);
    }
    for (int i = 0; i < 6; ++i) put(second, i, s.second[static_cast<size_t>(i)]);
  }

  void matrices() {
    kinematics();
    moments_of_bodies();
    accumulate();
    forces();
  }

  void gravity() {
    begin("gravity_outwards", "down = (Rk Rz(q))' down_p", Direction::outwards);
    const BodyConstants c = body_constants(false);
    const Vec3 above = carried3(down), here = to_child(c, joint_position(false), above);
    store(down, here);
    carry(down, here);
    store(gravity_first, c.first);

    begin("gravity_inwards", "g = -(h x down)_z (revolute), -m down_z (prismatic); h_p += Rk Rz(q) h + m p",
          Direction::inwards);
    const BodyConstants k = body_constants(false);
    const JointPosition q = joint_position(false);
    const Sym mass = composite_mass();
    const Vec3 d = state3(down), below = carried3(gravity_first), h = state3(gravity_first) + below;
    const Sym weight = mass * d[2], moment = difference_of_products(h[0], d[1], h[1], d[0]);
    store(gravity_torque, 0, -sum_of_products(k.revolute, moment, k.prismatic, weight));
    const Vec3 origin = k.translation + q.displacement * column(k.rotation, 2);
    const Vec3 moved = mass * origin;
    carry(gravity_first, to_parent(k, q, h) + moved);
  }

  void bias() {
    begin("bias_outwards",
          "Newton-Euler in body axes: w, dw, a of the body and f = m a + dw x h + w x (w x h), n = h x a + I dw + w x I w",
          Direction::outwards);
    const BodyConstants c = body_constants(false);
    const Motion parent{carried3(motion, 0), carried3(motion, 3), carried3(motion, 6)};
    const Sym speed = state(rate);
    const Motion here = propagate(parent, c, joint_position(false), speed);
    const Force f = body_force(here, c);
    const Vec3* parts[] = {&here.angular, &here.angular_acceleration, &here.acceleration};
    for (int i = 0; i < 3; ++i) store(motion, *parts[i], 3 * i), carry(motion, *parts[i], 3 * i);
    store(force, f.force, 0);
    store(force, f.torque, 3);

    begin("bias_inwards", "C v + g = n_z (revolute), f_z (prismatic); f_p += R f, n_p += R n + p x R f", Direction::inwards);
    const BodyConstants k = body_constants(false);
    const JointPosition q = joint_position(false);
    const Vec3 force_below = carried3(force, 0), total = state3(force, 0) + force_below;
    const Vec3 torque_below = carried3(force, 3), torque = state3(force, 3) + torque_below;
    store(bias_torque, 0, sum_of_products(k.revolute, torque[2], k.prismatic, total[2]));
    const Vec3 origin = k.translation + q.displacement * column(k.rotation, 2), moved = to_parent(k, q, total);
    carry(force, moved, 0);
    const Vec3 lever = cross(origin, moved);
    carry(force, to_parent(k, q, torque) + lever, 3);
  }

 private:
  int body(int lane, int step) const { return segment_.bodies[static_cast<size_t>(lane)][static_cast<size_t>(step)]; }
  template <class F>
  void for_each_body(const F& f) const {
    for (int lane = 0; lane < segment_.width; ++lane)
      for (int step = 0; step < segment_.steps; ++step)
        if (const int b = body(lane, step); b >= 0) f(static_cast<size_t>(b));
  }

  void kinematics() {
    begin("kinematics", "Phase I: R = Rp Rk Rz(q), p = pp + Rp pk, J = [p x z; z], V = Vp + J dq", Direction::outwards);
    const BodyConstants c = body_constants(true);
    const Pose parent{rotation_matrix([this](int r, int i) { return carried3(r, i); }), carried3(position)};
    const Pose here = pose(parent, c, joint_position(true));
    const Twist j = joint_twist(here, c);
    const Sym speed = state(rate);
    const Twist v = body_twist({carried3(body_linear), carried3(body_angular)}, j, speed);
    for (int i = 0; i < 3; ++i) {
      const Vec3 axis = column(here.rotation, static_cast<size_t>(i));
      store(rotation, axis, 3 * i), carry(rotation, axis, 3 * i);
    }
    store(position, here.position), carry(position, here.position);
    store(joint_linear, j.linear);
    if (!program_.all_revolute) store(joint_angular, j.angular);
    store(body_linear, v.linear), carry(body_linear, v.linear);
    store(body_angular, v.angular), carry(body_angular, v.angular);
  }

  void moments_of_bodies() {
    begin("moments",
          "Phase II: h = R hk + m p, S = R (Sk R' + hk p') + p h', P = m u + w x h, D = -[w](S + t 1) - u h' + (h.u) 1; dJ = "
          "ad(V) J",
          Direction::anywhere);
    const BodyConstants c = body_constants(true);
    const Pose here{rotation_matrix([this](int r, int i) { return state3(r, i); }), state3(position)};
    const Twist v{state3(body_linear), state3(body_angular)};
    const Twist rate = joint_twist_rate(v, joint());
    store(joint_rate, rate.linear, 0), store(joint_rate, rate.angular, 3);
    Sums s = moments(here, c);
    add_velocity(s, v, c.mass, c.half_trace);
    each(s, [this](int role, int i, Sym x) { store(role, i, x); });
  }

  void accumulate() {
    begin("accumulate", "Phase II: sums over the subtree (eq. 29, 30)", Direction::inwards);
    const Sums below = sums([this](int role, int i) { return carried(role, i); });
    const Sums total = sums([this](int role, int i) { return state(role, i); }) + below;
    each(total, [this](int role, int i, Sym x) { store(role, i, x), carry(role, i, x); });
  }

  void forces() {
    begin("forces", "Phase III: F = A* J, G = A* dJ + B* J, H = P x Jv + D' Jw", Direction::anywhere);
    const Sums s = sums([this](int role, int i) { return state(role, i); });
    const Sym mass = composite_mass();
    const Twist j = joint(), rate{state3(joint_rate, 0), state3(joint_rate, 3)};
    const Twist f = apply_inertia(mass, s, j), g = apply_inertia(mass, s, rate), b = apply_bias(s, j);
    const Vec3 h = apply_bias_transposed(s, j);
    store(inertia_force, f.linear, 0), store(inertia_force, f.angular, 3);
    store(bias_force, g.linear + b.linear, 0), store(bias_force, g.angular + b.angular, 3);
    store(transposed, h);
    const Vec3 u{input(InputKind::velocity, 0), input(InputKind::velocity, 1), input(InputKind::velocity, 2)};
    const Vec3 w{input(InputKind::velocity, 3), input(InputKind::velocity, 4), input(InputKind::velocity, 5)};
    store(below_force, cross(f.linear, w), 0);
    const Vec3 turning = cross(f.angular, w);
    store(below_force, cross(f.linear, u) + turning + h, 3);
  }

  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::Segment& segment_;
  const ir::RolledProgram& program_;
  const std::vector<double>& composite_mass_;
  const ir::Graph::Options options_;
  ir::SegmentCode& code_;
  Paragraph* paragraph_ = nullptr;
};

using Values = std::set<std::pair<int, int>>;  // (role, component)

// What later paragraphs read, from the slots' own values and across the start of a segment from its parents' slots.
struct Needed {
  Values read, gathered;
  bool operator==(const Needed&) const = default;
};

bool keeps(const ir::StateStore& s, const Needed& needed, bool has_children) {
  const std::pair<int, int> value{s.role, s.component};
  return needed.read.contains(value) || (has_children && needed.gathered.contains(value));
}

bool carries(const ir::StateStore& c, const Paragraph& p, const Needed& needed, const Values& live) {
  const std::pair<int, int> value{c.role, c.component};
  return live.contains(value) || (p.direction == Direction::inwards && needed.read.contains(value));
}

// The carried values a paragraph needs for what it keeps; adds what it reads to `needed`.
Values follow(const Paragraph& p, Needed& needed, bool has_children) {
  Values live;
  while (true) {
    std::vector<NodeId> roots;
    for (const auto& s : p.stores)
      if (keeps(s, needed, has_children)) roots.push_back(s.node);
    for (const auto& c : p.carried)
      if (carries(c, p, needed, live)) roots.push_back(c.node);
    const auto uses = ir::uses(p.graph, roots);
    const Values before = live;
    for (NodeId id = 0; id < p.graph.size(); ++id) {
      const ir::Node& n = p.graph[id];
      if (uses[static_cast<size_t>(id)] == 0 || n.op != ir::Op::input) continue;
      if (n.input.kind == InputKind::carried) live.insert({n.input.index, n.input.component});
      if (n.input.kind == InputKind::state) needed.read.insert({n.input.index, n.input.component});
    }
    if (live == before) break;
  }
  if (p.direction == Direction::outwards) needed.gathered.insert(live.begin(), live.end());
  return live;
}

class RolledLowering {
 public:
  RolledLowering(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene, const ir::Plan& plan,
                 const ir::Graph::Options& options)
      : tree_(tree), normal_(normal), scene_(scene), plan_(plan), options_(options) {
    program_.root.graph = ir::Graph(options);
    program_.base_graph = ir::Graph(options);
  }

  ir::RolledProgram run() {
    program_.roles = make_roles();
    for (const ir::NormalBody& n : normal_.bodies) program_.all_revolute = program_.all_revolute && !n.prismatic;
    for (Quantity q : scene_.outputs) {
      program_.mass |= q == Quantity::mass_matrix;
      program_.coriolis |= q == Quantity::coriolis_matrix;
      program_.gravity |= q == Quantity::gravity && scene_.gravity_kind != ir::GravityKind::none;
      program_.bias |= q == Quantity::bias;
      program_.wrench |= q == Quantity::wrench_influence;
    }
    composite_mass_.resize(normal_.bodies.size());
    total_mass_ = normal_.base.mass;
    for (size_t k = normal_.bodies.size(); k-- > 0;) {
      composite_mass_[k] += normal_.bodies[k].moments.mass;
      const int parent = normal_.bodies[k].parent;
      (parent < 0 ? total_mass_ : composite_mass_[static_cast<size_t>(parent)]) += composite_mass_[k];
    }
    for (const ir::Segment& segment : plan_.segments) lower_segment(segment);
    base();
    prune_all();
    return std::move(program_);
  }

 private:
  void lower_segment(const ir::Segment& segment) {
    program_.segments.emplace_back();
    SegmentLowering lowering(tree_, normal_, segment, program_, composite_mass_, options_, program_.segments.back());
    if (program_.mass || program_.coriolis || program_.wrench) lowering.matrices();
    if (program_.gravity) lowering.gravity();
    if (program_.bias) lowering.bias();
    for (const ir::Segment& other : plan_.segments)
      for (int parent : other.parents)
        for (const auto& lane : segment.bodies)
          if (parent >= 0 && std::find(lane.begin(), lane.end(), parent) != lane.end())
            program_.segments.back().has_children = true;
  }

  void root_store(int role, int component, Sym x) { program_.root.stores.push_back({role, component, x.id}); }
  void root_store(int role, const Vec3& x, int from = 0) {
    for (int i = 0; i < 3; ++i) root_store(role, from + i, x[static_cast<size_t>(i)]);
  }
  void element(std::string_view array, int row, int column, Sym x) {
    const auto arrays = output_arrays(tree_, scene_);
    for (size_t a = 0; a < arrays.size(); ++a)
      if (arrays[a].name == array && !x.graph->is_constant(x.id, 0))
        program_.base_elements.push_back({static_cast<int>(a), row, column, x.id});
  }

  // What is known at the root before the segments, and the base's own rows after them.
  void base() {
    const LowerInputs in(program_.root.graph, tree_, normal_, scene_);
    const Twist v = in.base_twist();
    const Vec3 gravity = in.gravity_in_base();
    for (int i = 0; i < 9; ++i) root_store(rotation, i, in.constant(i % 4 == 0 ? 1 : 0));
    root_store(position, in.zero());
    root_store(body_linear, v.linear);
    root_store(body_angular, v.angular);
    root_store(down, gravity);
    const Motion root{v.angular, in.zero(), cross(v.angular, v.linear) - gravity};
    root_store(motion, root.angular, 0);
    root_store(motion, root.angular_acceleration, 3);
    root_store(motion, root.acceleration, 6);
    if (!tree_.floating_base) return;

    const BodyConstants base = in.base();
    Sums s = moments({in.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity())), in.zero()}, base);
    add_velocity(s, v, base.mass, base.half_trace);
    SegmentLowering::each(s, [this](int role, int i, Sym x) { root_store(role, i, x); });
    root_store(gravity_first, base.first);
    const Force f = body_force(root, base);
    root_store(force, f.force, 0);
    root_store(force, f.torque, 3);
    base_block();
  }

  void base_block() {
    ir::Graph& g = program_.base_graph;
    const LowerInputs in(g, tree_, normal_, scene_);
    const auto state = [&](int role, int i) { return Sym{&g, g.input({InputKind::state, role, i})}; };
    const auto state3 = [&](int role, int from) {
      return Vec3{state(role, from), state(role, from + 1), state(role, from + 2)};
    };
    if (program_.mass || program_.coriolis) {
      Sums s;
      for (int i = 0; i < 6; ++i) s.second[static_cast<size_t>(i)] = state(second, i);
      s.first = state3(first, 0), s.momentum = state3(momentum, 0);
      s.bias = {state3(bias_block, 0), state3(bias_block, 3), state3(bias_block, 6)};
      const Twist v = in.base_twist();
      const Sym mass = in.constant(total_mass_);
      for (size_t j = 0; j < 6; ++j) {
        Twist unit{in.zero(), in.zero()};
        (j < 3 ? unit.linear : unit.angular)[j % 3] = in.constant(1);
        const Twist f = apply_inertia(mass, s, unit), a = apply_inertia(mass, s, joint_twist_rate(v, unit)),
                    b = apply_bias(s, unit);
        for (size_t i = 0; i < 6; ++i) {
          const int row = static_cast<int>(i), column = static_cast<int>(j);
          element("mass_matrix", row, column, i < 3 ? f.linear[i] : f.angular[i - 3]);
          element("coriolis_matrix", row, column, i < 3 ? a.linear[i] + b.linear[i] : a.angular[i - 3] + b.angular[i - 3]);
        }
      }
    }
    if (program_.gravity) {
      const Vec3 d = state3(down, 0), torque = cross(state3(gravity_first, 0), d);
      for (size_t i = 0; i < 3; ++i) {
        element("gravity", static_cast<int>(i), 0, -(in.constant(total_mass_) * d[i]));
        element("gravity", static_cast<int>(i) + 3, 0, -torque[i]);
      }
    }
    if (program_.bias)
      for (int i = 0; i < 6; ++i) element("bias", i, 0, state(force, i));
  }

  void prune_all() {
    Needed needed;
    read_by_results(needed.read);
    // Segments exchange values at branches: follow what is read until nothing new turns up, then drop the rest.
    for (Needed before; before != needed;) {
      before = needed;
      for (ir::SegmentCode& s : program_.segments)
        for (size_t p = s.paragraphs.size(); p-- > 0;) follow(s.paragraphs[p], needed, s.has_children);
    }
    std::set<int> used;
    const auto use = [&](const ir::StateStore& s) { used.insert(s.role); };
    for (ir::SegmentCode& s : program_.segments) {
      for (Paragraph& p : s.paragraphs) {
        const Values live = follow(p, needed, s.has_children);
        std::erase_if(p.stores, [&](const ir::StateStore& x) { return !keeps(x, needed, s.has_children); });
        std::erase_if(p.carried, [&](const ir::StateStore& x) { return !carries(x, p, needed, live); });
        std::for_each(p.stores.begin(), p.stores.end(), use);
      }
      std::erase_if(s.paragraphs, [](const Paragraph& p) { return p.stores.empty(); });
    }
    std::erase_if(program_.root.stores, [&](const ir::StateStore& s) { return !keeps(s, needed, true); });
    std::for_each(program_.root.stores.begin(), program_.root.stores.end(), use);
    for (const auto& [role, component] : needed.read) used.insert(role);
    for (int role = 0; role < role_count; ++role)
      if (!used.contains(role)) program_.roles[static_cast<size_t>(role)].name.clear();
  }

  // What Phase III's blocks, the base's rows and the final results read.
  void read_by_results(Values& read) const {
    const auto need = [&](int role) {
      for (int i = 0; i < program_.roles[static_cast<size_t>(role)].components; ++i) read.insert({role, i});
    };
    const bool matrices = program_.mass || program_.coriolis;
    if (matrices || program_.wrench) {
      need(joint_linear);
      if (!program_.all_revolute) need(joint_angular);
      for (int i = 6; i < 9 && program_.all_revolute; ++i) read.insert({rotation, i});
    }
    if (matrices) need(inertia_force);
    if (program_.coriolis) {
      for (int role : {joint_rate, bias_force, transposed}) need(role);
      if (tree_.floating_base) need(below_force);
    }
    if (program_.wrench) need(rotation), need(position);
    if (program_.gravity) need(gravity_torque);
    if (program_.bias) need(bias_torque);
    std::vector<NodeId> roots;
    for (const auto& e : program_.base_elements) roots.push_back(e.node);
    const auto uses = ir::uses(program_.base_graph, roots);
    for (NodeId id = 0; id < program_.base_graph.size(); ++id) {
      const ir::Node& n = program_.base_graph[id];
      if (uses[static_cast<size_t>(id)] > 0 && n.op == ir::Op::input && n.input.kind == InputKind::state)
        read.insert({n.input.index, n.input.component});
    }
  }

  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::Scene& scene_;
  const ir::Plan& plan_;
  const ir::Graph::Options options_;
  ir::RolledProgram program_;
  std::vector<double> composite_mass_;
  double total_mass_ = 0;
};

}  // namespace

ir::RolledProgram lower_rolled(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene,
                               const ir::Plan& plan, const ir::Graph::Options& options) {
  return RolledLowering(tree, normal, scene, plan, options).run();
}

}  // namespace dalembert::passes
