#include "passes/lower_segment.hpp"

#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "passes/equations.hpp"
#include "passes/roles.hpp"

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;
using ir::Paragraph;

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
    code_.paragraphs.push_back({name, {equation}, direction, ir::Graph(options_), {}, {}});
    paragraph_ = &code_.paragraphs.back();
    return *paragraph_;
  }

  ir::Graph& graph() { return paragraph_->graph; }
  Sym constant(double value) { return {&graph(), graph().constant(value)}; }
  Sym input(InputKind kind, int index, int component = 0) { return {&graph(), graph().input({kind, index, component})}; }
  Sym state(int role, int component = 0) {
    const auto own = own_.find({role, component});
    if (own == own_.end()) return input(InputKind::state, role, component);
    const Sym share =
        own->second.op == ir::Op::constant ? constant(own->second.value) : input(InputKind::table, own->second.input.index);
    return limbs_attached() ? share + input(InputKind::state, role, component) : share;
  }
  Vec3 state3(int role, int from = 0) { return {state(role, from), state(role, from + 1), state(role, from + 2)}; }
  Sym carried(int role, int component) { return input(InputKind::carried, role, component); }
  Vec3 carried3(int role, int from = 0) { return {carried(role, from), carried(role, from + 1), carried(role, from + 2)}; }
  // A body's own share of a sum that is a constant of the body is not stored but read from the table where the sum is. That is
  // less work, and a loop that stores nothing but a table is taken for a memcpy of constants, which g++ 12.2 expands wrongly
  // for targets with AVX-512: it writes 32 bytes {a, a, 0, 0} as {a, a, a, a}.
  void store(int role, int component, Sym x) {
    const ir::Node& n = graph()[x.id];
    const bool constant_of_body = n.op == ir::Op::constant || (n.op == ir::Op::input && n.input.kind == InputKind::table);
    if (own_.contains({role, component})) throw std::logic_error("a sum is stored over what its slot has received");
    // What totals are stored over later is stored like any other share: only joints that move no mass have constant ones there,
    // the same zero for all.
    const bool replaced = totals_follow_ && n.op == ir::Op::constant;
    if (is_sum(role) && constant_of_body && !replaced) {
      own_.insert({{role, component}, n});
      code_.received.push_back({role, component});
    } else {
      paragraph_->stores.push_back({role, component, x.id});
    }
  }
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
    for (int i = 0; i < 3; ++i)
      c.half_second[static_cast<size_t>(i)] = table(std::string("half_second_") + "xyz"[i] + "xyz"[i], true,
                                                    [=](size_t b) { return 0.5 * n(b).moments.second(i, i); });
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
  // Phases I to III in as few loops as pay. A longer limb on its own has its steps in consecutive slots: what does not run
  // along it is computed for several steps at once, in a loop of its own. So are the moments where C wants so many values
  // that they would not fit into the registers together with the poses.
  void matrices() {
    const bool alone = segment_.width == 1 && segment_.steps > (program_.coriolis ? 1 : 4);
    const MovingBody body = kinematics();
    totals_follow_ = alone;
    if (alone || program_.coriolis) {
      begin("moments", moments_equation, Direction::anywhere);
      if (program_.coriolis) paragraph_->equations.push_back(rates_equation);
      moments_of({{rotation_matrix([this](int r, int i) { return state3(r, i); }), state3(position)},
                  joint(),
                  {state3(velocity, 0), state3(velocity, 3)}});
    } else {
      paragraph_->equations.push_back(moments_equation);
      moments_of(body);
    }
    totals_follow_ = false;
    const Sums total = accumulate();
    if (alone) {
      each_sum(total, [this](int role, int i, Sym x) { store(role, i, x); });
      begin("forces", forces_equation, Direction::anywhere);
      forces(sums([this](int role, int i) { return state(role, i); }));
    } else {
      paragraph_->equations.push_back(forces_equation);
      forces(total);
    }
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

  bool limbs_attached() const {
    std::set<int> mine;
    for_each_body([&](size_t b) { mine.insert(static_cast<int>(b)); });
    for (size_t k = 0; k < normal_.bodies.size(); ++k)
      if (mine.contains(normal_.bodies[k].parent) && !mine.contains(static_cast<int>(k))) return true;
    return false;
  }

  struct MovingBody {
    Pose pose;
    Twist joint, velocity;
  };
  static constexpr const char *moments_equation = "Phase II: h = R hk + m p, S = R Sk R' + R hk p' + p (R hk)' + m p p'",
                              *rates_equation = "Phase II: P = m u + w x h, D = -[w](S + t 1) - u h' + (h.u) 1; dJ = ad(V) J",
                              *forces_equation = "Phase III: F = A* J, G = A* dJ + B* J, H = P x Jv + D' Jw";

  MovingBody kinematics() {
    begin("kinematics", "Phase I: R = Rp Rk Rz(q), p = pp + Rp pk, J = [p x z; z], V = Vp + J dq", Direction::outwards);
    const BodyConstants c = body_constants(true);
    const Pose parent{rotation_matrix([this](int r, int i) { return carried3(r, i); }), carried3(position)};
    const Pose here = pose(parent, c, joint_position(true));
    const Twist j = joint_twist(here, c);
    const Sym speed = state(rate);
    const Twist v = body_twist({carried3(velocity, 0), carried3(velocity, 3)}, j, speed);
    for (int i = 0; i < 3; ++i) {
      const Vec3 axis = column(here.rotation, static_cast<size_t>(i));
      store(rotation, axis, 3 * i), carry(rotation, axis, 3 * i);
    }
    store(position, here.position), carry(position, here.position);
    store(joint_linear, j.linear);
    if (!program_.all_revolute) store(joint_angular, j.angular);
    store(velocity, v.linear, 0), carry(velocity, v.linear, 0);
    store(velocity, v.angular, 3), carry(velocity, v.angular, 3);
    return {here, j, v};
  }

  void moments_of(const MovingBody& body) {
    const BodyConstants c = body_constants(true);
    const Twist rate = joint_twist_rate(body.velocity, body.joint);
    store(joint_rate, rate.linear, 0), store(joint_rate, rate.angular, 3);
    Sums s = moments(body.pose, c);
    add_velocity(s, body.velocity, c.mass, c.half_trace);
    each_sum(s, [this](int role, int i, Sym x) { store(role, i, x); });
  }

  Sums accumulate() {
    begin("accumulate", "Phase II: sums over the subtree (eq. 29, 30)", Direction::inwards);
    const Sums below = sums([this](int role, int i) { return carried(role, i); });
    const Sums total = sums([this](int role, int i) { return state(role, i); }) + below;
    each_sum(total, [this](int role, int i, Sym x) { carry(role, i, x); });
    return total;
  }

  void forces(const Sums& s) {
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
  bool totals_follow_ = false;                   // sums are stored once more, as totals
  std::map<std::pair<int, int>, ir::Node> own_;  // by role and component: own shares that are constants
};

}  // namespace

void lower_segment(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Segment& segment,
                   const ir::RolledProgram& program, const std::vector<double>& composite_mass,
                   const ir::Graph::Options& options, ir::SegmentCode& code) {
  SegmentLowering lowering(tree, normal, segment, program, composite_mass, options, code);
  if (program.mass || program.coriolis || program.wrench) lowering.matrices();
  if (program.gravity) lowering.gravity();
  if (program.bias) lowering.bias();
}

}  // namespace dalembert::passes
