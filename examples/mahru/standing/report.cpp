#include "report.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "../controller/figures.hpp"

namespace standing {
namespace {

constexpr double law_target = 200;         // µs, p99.9
constexpr double self_test_target = 1000;  // µs
constexpr double slip_target = 2e-3;       // m
constexpr double com_target = 5e-3;        // m, RMS
constexpr double agreement_target = 1e-9;  // relative
// Rounding of the program's rows, and of MuJoCo's solver, which stops at a tolerance.
constexpr double commanded_rounding = 1e-6, ground_rounding = 1e-3;

bool inside(const SoleUse& use, double rounding) { return use.friction <= 1 + rounding && use.pressure <= 1 + rounding; }

void print_parts(const Summary& summary, const Plan& plan) {
  fmt::print("\n  {:<18} {:>6} | {:^13} | {:^6} | {:^13} | {:^13} | {:>6} | {:>6} | {:>5}\n", "", "", "centre of mass", "",
             "law's forces", "ground's", "", "", "");
  fmt::print("  {:<18} {:>6} | {:>6} {:>6}  | {:>6} | {:>6} {:>6} | {:>6} {:>6} | {:>6} | {:>6} | {:>5}\n", "part", "from",
             "RMS", "peak", "slip", "cone", "sole", "cone", "sole", "differ", "torque", "steps");
  fmt::print("  {:<18} {:>6} | {:>6} {:>6}  | {:>6} | {:>6} {:>6} | {:>6} {:>6} | {:>6} | {:>6} | {:>5}\n", "", "s", "mm", "mm",
             "mm", "of 1", "of 1", "of 1", "of 1", "N, N m", "of 1", "of QP");
  const auto row = [](const std::string& name, double from, const Figures& f) {
    fmt::print(
        "  {:<18} {:>6.1f} | {:>6.2f} {:>6.2f}  | {:>6.3f} | {:>6.3f} {:>6.3f} | {:>6.3f} {:>6.3f} | {:>6.1f} | {:>6.2f} | "
        "{:>5}\n",
        name, from, 1e3 * f.com_rms, 1e3 * f.com_peak, 1e3 * f.slip, f.commanded.friction, f.commanded.pressure,
        f.ground.friction, f.ground.pressure, f.force_difference, f.torque, f.steps);
  };
  for (std::size_t i = 0; i < summary.parts.size(); ++i)
    row(plan.parts[i].name, plan.parts[i].begin * period, summary.parts[i]);
  row("all", 0, summary.all);
}

}  // namespace

bool print_tables(const Summary& summary, const Plan& plan, bool timing_counts) {
  print_parts(summary, plan);
  controller::print_header();
  controller::print_row("dynamics call (generated)", summary.dynamics);
  controller::print_row("whole control law", summary.law);
  controller::print_row("plant and checks (MuJoCo)", summary.plant);
  controller::print_row("begin of the tick, late by", summary.begun);
  controller::print_row("wake-up lateness (jitter)", summary.woken);
  fmt::print("\n  of {} deadlines missed from computing {}, missed from late begin or preemption {}\n", summary.ticks,
             summary.missed_by_computing, summary.missed_by_system);
  fmt::print("  heap allocations in the loop: {}\n", summary.heap_allocations);
  fmt::print("  generated momentum against MuJoCo's: largest difference {:.2g} of the robot's at 1 m/s\n",
             summary.all.disagreement);
  if (summary.fell) fmt::print("  the robot FELL at {:.3f} s\n", summary.ticks * period);

  using controller::verdict;
  fmt::print("\n");
  bool in_time = verdict("no deadline missed from computing", summary.missed_by_computing == 0);
  in_time &= verdict(fmt::format("p99.9 of the whole law below {:g} µs", law_target), summary.law.p999 < law_target);
  in_time &= verdict("self-test at the start under 1 ms", summary.self_test < self_test_target);
  bool met = in_time || !timing_counts;
  const Figures& all = summary.all;
  met &= verdict(fmt::format("{:g} s without a fall", plan.targets.size() * period), !summary.fell);
  met &= verdict("feet slip by less than 2 mm", all.slip < slip_target);
  met &= verdict("centre of mass within 5 mm RMS of its reference", all.com_rms < com_target);
  met &= verdict("the law's forces inside cones and soles every tick", inside(all.commanded, commanded_rounding));
  met &= verdict("the ground's forces inside cones and soles every tick", inside(all.ground, ground_rounding));
  met &= verdict("torques inside their limits every tick", all.gave_way == 0 && all.torque <= 1 + commanded_rounding);
  met &= verdict("no heap allocation in the loop", summary.heap_allocations == 0);
  met &= verdict("momentum agrees with MuJoCo's to 1e-9", all.disagreement < agreement_target);
  return met;
}

namespace {

// Plotted by column number.
void write_csv(const std::string& file, const std::vector<Tick>& ticks, const Plan& plan, const Limits& there) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (!out) throw std::runtime_error(file + ": cannot be written");
  fmt::print(out, "time_s,com_x_m,com_y_m,com_z_m,reference_x_m,reference_y_m,reference_z_m");
  for (const char* side : {"left", "right"})
    fmt::print(out, ",{0}_sole_x_m,{0}_sole_z_m,{0}_law_N,{0}_ground_N,{0}_cone_of_1,{0}_sole_of_1", side);
  fmt::print(out, ",torque_of_1,qp_steps,dynamics_us,law_us,plant_us,begun_us,woken_us\n");
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    const Tick& t = ticks[k];
    const Vector3d& wanted = plan.targets[k].com;
    fmt::print(out, "{:.3f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", k * period, t.com.x(), t.com.y(), t.com.z(), wanted.x(),
               wanted.y(), wanted.z());
    for (const Side side : sides) {
      const SoleUse use = sole_use(t.ground.segment<6>(6 * side), there.friction, there.x, there.y);
      fmt::print(out, ",{:.6g},{:.6g},{:.6g},{:.6g},{:.4g},{:.4g}", t.sole[side].x(), t.sole[side].z(),
                 t.commanded[6 * side + 2], t.ground[6 * side + 2], use.friction, use.pressure);
    }
    fmt::print(out, ",{:.4g},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", t.torque, t.steps, 1e-3 * t.dynamics, 1e-3 * t.law,
               1e-3 * t.plant, 1e-3 * t.begun, 1e-3 * t.woken);
  }
  if (std::fclose(out) != 0) throw std::runtime_error(file + ": cannot be written");
}

std::string plot_script(const std::string& stem, const Plan& plan, std::size_t ticks) {
  std::string marks;
  double height = 0.6;  // of the part's name, in turns, so that short parts' do not overlap
  for (const Plan::Part& part : plan.parts) {
    if (part.begin >= ticks) break;
    marks += fmt::format("set arrow from {0}, graph 0 to {0}, graph 1 nohead lc 'grey' dt 3\n", part.begin * period);
    marks +=
        fmt::format("set label {} at {}, graph {} font ',9'\n", controller::quoted(part.name), part.begin * period, height);
    height = 1.1 - height;
  }
  return fmt::format(R"(
set terminal svg size 1100,1300 dynamic background 'white' font 'sans,13'
set output {svg}
data = {csv}
set datafile separator ','
set key noenhanced outside right
set lmargin 9
set rmargin 20
set grid
set multiplot layout 5,1
set xlabel 'time, s'
set xrange [0:{seconds}]
{marks}
set ylabel 'm'
set title 'Centre of mass (dashed: reference)'
plot for [i=0:2] data every {every} using 1:(column(i + 2)) with lines lw 2 lc i + 1 title word('x y z', i + 1), for [i=0:2] data every {every} using 1:(column(i + 5)) with lines lc black dt 2 notitle
unset label
set ylabel 'm'
set logscale y
set format y '10^{{%L}}'
set title 'Centre of mass off its reference'
plot data every {every} using 1:(sqrt(($2-$5)**2+($3-$6)**2+($4-$7)**2)+1e-7) with lines notitle, 5e-3 with lines dt 2 lc black title 'target (RMS)'
unset logscale y
set format y '%g'
set ylabel 'N'
set title 'What the feet bear (dashed: as the law commands)'
plot data every {every} using 1:11 with lines lw 2 title 'left', data every {every} using 1:17 with lines lw 2 title 'right', data every {every} using 1:10 with lines lc black dt 2 notitle, data every {every} using 1:16 with lines lc black dt 2 notitle
set ylabel 'of what is possible'
set yrange [0:1.1]
set title 'Ground at the feet: friction of its cone, centre of pressure of its way to the edge; torques of their limits'
plot data every {every} using 1:($12>$18?$12:$18) with lines title 'cone', data every {every} using 1:($13>$19?$13:$19) with lines title 'sole', data every {every} using 1:20 with lines lc 4 title 'torque'
unset arrow
set logscale x
set xrange [*:*]
set yrange [0:1]
set xlabel 'time, µs'
set ylabel 'share of ticks below'
set title 'Distribution of times'
plot data every {few} using 22:({few}.0/{ticks}) smooth cumulative title 'dynamics call', data every {few} using 23:({few}.0/{ticks}) smooth cumulative title 'whole law', data every {few} using 24:({few}.0/{ticks}) smooth cumulative title 'plant'
unset multiplot
)",
                     fmt::arg("svg", controller::quoted(stem + ".svg")), fmt::arg("csv", controller::quoted(stem + ".csv")),
                     fmt::arg("marks", marks), fmt::arg("ticks", ticks), fmt::arg("seconds", ticks * period),
                     fmt::arg("every", 1 + ticks / 600), fmt::arg("few", 1 + ticks / 200));
}

}  // namespace

void write_files(const std::string& stem, const std::vector<Tick>& ticks, const Plan& plan, const Limits& there) {
  write_csv(stem + ".csv", ticks, plan, there);
  fmt::print("\n  every tick: {}.csv\n", stem);
  controller::draw(plot_script(stem, plan, ticks.size()), stem + ".svg");
}

}  // namespace standing
