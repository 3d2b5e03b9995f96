#include "plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace standing {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double gravity = 9.81;

// From 0 to 1 while x does, with first and second derivative (per x) zero at both ends.
struct Rise {
  double r, dr, ddr;
};
Rise rise(double x) {
  if (x <= 0) return {0, 0, 0};
  if (x >= 1) return {1, 0, 0};
  return {x * x * x * (10 + x * (6 * x - 15)), 30 * x * x * (x - 1) * (x - 1), 60 * x * (x - 1) * (2 * x - 1)};
}

// From 0 to 1 and back to 0, at rest at both ends.
Rise bump(double x) {
  if (x < 0.5) return [&](Rise r) { return Rise{r.r, 2 * r.dr, 4 * r.ddr}; }(rise(2 * x));
  return [&](Rise r) { return Rise{r.r, -2 * r.dr, 4 * r.ddr}; }(rise(2 - 2 * x));
}

// Adds part after part; each begins where the last has ended.
class Writer {
 public:
  explicit Writer(const Target& start) : now_(start) {}

  const Target& now() const { return now_; }
  void part(const std::string& name) { plan_.parts.push_back({name, plan_.targets.size()}); }

  // change(target, x) for x from 0 to 1 within `seconds`; what it says at 1 stays.
  template <class Change>
  void during(double seconds, Change change) {
    const Target before = now_;
    const int ticks = std::max(1, static_cast<int>(std::lround(seconds / period)));
    for (int k = 1; k <= ticks; ++k) {
      now_ = before;
      change(now_, static_cast<double>(k) / ticks);
      plan_.targets.push_back(now_);
    }
    now_.com_v = now_.com_a = now_.push = Vector3d::Zero();
    for (FootTarget& foot : now_.foot) foot.v = foot.a = Vector3d::Zero();
  }

  void wait(double seconds) {
    during(seconds, [](Target&, double) {});
  }

  void move(const Vector3d& way, double seconds) {
    during(seconds, [&](Target& t, double x) {
      const Rise r = rise(x);
      t.com += r.r * way, t.com_v = r.dr / seconds * way, t.com_a = r.ddr / (seconds * seconds) * way;
    });
  }

  // A whole number of turns of an ellipse, faded in and out.
  void sway(const Vector3d& cosine, const Vector3d& sine, double turns, double seconds) {
    during(seconds, [&](Target& t, double x) {
      const double w = 2 * pi * turns, c = std::cos(w * x), s = std::sin(w * x), fade = std::min(0.25, 0.5 / turns);
      const Rise up = rise(x / fade), down = rise((1 - x) / fade);
      const double f = up.r * down.r, df = (up.dr * down.r - up.r * down.dr) / fade,
                   ddf = (up.ddr * down.r - 2 * up.dr * down.dr + up.r * down.ddr) / (fade * fade);
      const Vector3d e = c * cosine + s * sine, de = w * (c * sine - s * cosine), dde = -w * w * e;
      t.com += f * e;
      t.com_v = (df * e + f * de) / seconds;
      t.com_a = (ddf * e + 2 * df * de + f * dde) / (seconds * seconds);
    });
  }

  void load(Side side, double until, double seconds) {
    during(seconds, [&](Target& t, double x) {
      double& load = t.foot[side].load;
      load = x >= 1 ? until : load + x * (until - load);
    });
  }

  // Lifts a foot that bears nothing, or lowers it.
  void lift(Side side, double height, double seconds) {
    during(seconds, [&](Target& t, double x) {
      const Rise r = rise(x);
      FootTarget& foot = t.foot[side];
      foot.p.z() += height * r.r, foot.v.z() = height * r.dr / seconds, foot.a.z() = height * r.ddr / (seconds * seconds);
    });
  }

  // Swings a foot that bears nothing to where it is to stand.
  void swing(Side side, const Vector3d& to, double height, double seconds) {
    const Vector3d way = to - now_.foot[side].p;
    during(seconds, [&](Target& t, double x) {
      const Rise r = rise(x), z = bump(x);
      FootTarget& foot = t.foot[side];
      const Vector3d up(0, 0, height);
      foot.p += r.r * way + z.r * up;
      foot.v = (r.dr * way + z.dr * up) / seconds;
      foot.a = (r.ddr * way + z.ddr * up) / (seconds * seconds);
    });
  }

  // Carries the centre of mass over the other foot and lifts this one.
  void lift_off(Side side, double moving, double unloading, double lifting) {
    Vector3d way = now_.foot[other(side)].p - now_.com;
    way.z() = 0;
    move(way, moving);
    load(side, 0, unloading);
    lift(side, 0.1, lifting);
  }

  // Stands on the other foot for `seconds`.
  void stand_without(Side side, double seconds) {
    const Vector3d back = now_.com;
    lift_off(side, 1.5, 0.4, 1);
    wait(seconds);
    lift(side, -0.1, 1);
    load(side, 1, 0.4);
    move(back - now_.com, 1.5);
  }

  void push(const Vector3d& impulse, double rest) {
    constexpr double seconds = 0.1;
    during(seconds, [&](Target& t, double) { t.push = impulse / seconds; });
    wait(rest);
  }

  Plan finish(double seconds) {
    const auto ticks = static_cast<std::size_t>(std::lround(seconds / period));
    if (plan_.targets.size() < ticks) part("stands"), wait(seconds - plan_.targets.size() * period);
    plan_.targets.resize(ticks);
    while (plan_.parts.back().begin >= ticks) plan_.parts.pop_back();
    return std::move(plan_);
  }

  std::vector<Target>& targets() { return plan_.targets; }

 private:
  Plan plan_;
  Target now_;
};

// Where `com` is a centre of pressure, puts the centre of mass whose acceleration has it: of a mass at constant height,
// c̈ = g/z (c − p). Solved for all ticks at once, c being p at both ends; that is the one solution that does not run away.
void carry(std::vector<Target>::iterator begin, std::vector<Target>::iterator end) {
  const auto n = end - begin;
  const double rate = gravity / begin->com.z(), step = rate * period * period;
  std::vector<Vector3d> p, c;
  for (auto t = begin; t != end; ++t) p.push_back(t->com);
  // −c_{k−1} + (2 + step) c_k − c_{k+1} = step p_k: elimination forwards, c backwards.
  std::vector<double> factor(n, 0.0);
  c = p;
  for (std::ptrdiff_t k = 1; k + 1 < n; ++k) {
    const double pivot = 2 + step - factor[k - 1];
    factor[k] = 1 / pivot;
    c[k] = (step * p[k] + c[k - 1]) / pivot;
  }
  for (std::ptrdiff_t k = n - 2; k > 0; --k) c[k] += factor[k] * c[k + 1];
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    Target& t = begin[k];
    const bool inside = k > 0 && k + 1 < n;
    t.com = c[k];
    t.com_v = inside ? Vector3d((c[k + 1] - c[k - 1]) / (2 * period)) : Vector3d::Zero();
    t.com_a = inside ? Vector3d(rate * (c[k] - p[k])) : Vector3d::Zero();
    t.com.z() = p[k].z(), t.com_v.z() = t.com_a.z() = 0;
  }
}

}  // namespace

Plan stand(const Target& start, double seconds, double impulse) {
  Writer w(start);
  w.part("stands"), w.wait(2);
  w.part("sways"), w.sway({0.02, 0, 0}, {0, 0.06, 0}, 4, 12);
  w.part("squats"), w.move({0, 0, -0.15}, 2), w.wait(1), w.move({0, 0, 0.15}, 2), w.wait(1);
  w.part("on the left foot"), w.stand_without(right, 4);
  w.part("on the right foot"), w.stand_without(left, 4);
  w.part("pushes ahead"), w.push({impulse, 0, 0}, 3.9);
  w.part("pushes back"), w.push({-impulse, 0, 0}, 3.9);
  w.part("pushes left"), w.push({0, impulse, 0}, 3.9);
  w.part("pushes right"), w.push({0, -impulse, 0}, 3.9);
  return w.finish(seconds);
}

Plan stand_briefly(const Target& start, double seconds, double impulse) {
  Writer w(start);
  w.part("stands"), w.wait(0.1);
  w.part("pushes ahead"), w.push({impulse, 0, 0}, 0.5);
  w.part("pushes left"), w.push({0, impulse, 0}, 0.5);
  w.part("squats"), w.move({0, 0, -0.15}, 0.8), w.move({0, 0, 0.15}, 0.8);
  w.part("on the left foot"), w.lift_off(right, 1, 0.2, 0.4);
  w.wait(std::max(period, seconds - w.targets().size() * period));
  return w.finish(seconds);
}

Plan walk(const Target& start, int steps) {
  constexpr double length = 0.15, height = 0.05;      // m
  constexpr double both_feet = 0.25, one_foot = 0.6;  // s
  constexpr double at_ends = 2;                       // s
  Writer w(start);
  w.part("crouches"), w.move({0, 0, -0.03}, 1);
  w.part("walks");
  const std::size_t begin = w.targets().size();
  const auto middle = [&] { return Vector3d((w.now().foot[left].p + w.now().foot[right].p) / 2); };
  const auto pressure = [&](const Vector3d& to, double seconds, Side unloaded, Side loaded) {  // from where it is; on both feet
    Vector3d way = to - w.now().com;
    way.z() = 0;
    w.during(seconds, [&](Target& t, double x) {
      t.com += x * way;
      t.foot[unloaded].load = std::min(t.foot[unloaded].load, 1 - x);
      t.foot[loaded].load = std::max(t.foot[loaded].load, x);
    });
  };
  w.during(at_ends, [&](Target& t, double x) { t.com += rise(x).r * (middle() - t.com).cwiseProduct(Vector3d(1, 1, 0)); });
  for (int step = 0; step < steps; ++step) {
    const Side swinging = step % 2 ? left : right, standing = other(swinging);
    pressure(w.now().foot[standing].p, step ? both_feet : 2 * both_feet, swinging, standing);
    Vector3d to = w.now().foot[swinging].p;
    to.x() = w.now().foot[standing].p.x() + (step + 1 < steps ? length : 0);
    w.swing(swinging, to, height, one_foot);
  }
  w.during(2 * both_feet, [&, way = Vector3d((middle() - w.now().com).cwiseProduct(Vector3d(1, 1, 0)))](Target& t, double x) {
    t.com += x * way;
    for (FootTarget& foot : t.foot) foot.load = std::max(foot.load, x);
  });
  w.wait(at_ends);
  carry(w.targets().begin() + begin, w.targets().end());
  return w.finish(w.targets().size() * period);
}

}  // namespace standing
