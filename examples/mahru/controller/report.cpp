#include "report.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "figures.hpp"

namespace controller {
namespace {

constexpr double dynamics_target = 10;     // µs, 99th percentile
constexpr double self_test_target = 1000;  // µs
constexpr double rms_target = 1e-3;        // rad
constexpr double agreement_target = 1e-9;  // relative
constexpr double drift_target = 1e-6;      // relative, over the whole run: the integrator's error, not the law's

// The files are plotted by column number: time, then per joint angle and desired angle, then the times.
void write_csv(const std::string& file, const std::vector<Tick>& ticks, const char* const* joint_names) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (!out) throw std::runtime_error(file + ": cannot be written");
  fmt::print(out, "time_s");
  for (int i = 0; i < joints; ++i) fmt::print(out, ",{0}_rad,{0}_desired_rad", joint_names[i]);
  fmt::print(out, ",largest_error_rad,dynamics_us,law_us,plant_us,rehearsal_us,begun_us,woken_us\n");
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    const Tick& tick = ticks[k];
    fmt::print(out, "{:.3f}", k * period);
    for (int i = 0; i < joints; ++i) fmt::print(out, ",{:.9g},{:.9g}", tick.q[i], tick.q_d[i]);
    fmt::print(out, ",{:.6g},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", (tick.q - tick.q_d).cwiseAbs().maxCoeff(),
               1e-3 * tick.dynamics, 1e-3 * tick.law, 1e-3 * tick.plant, 1e-3 * tick.rehearsal, 1e-3 * tick.begun,
               1e-3 * tick.woken);
  }
  if (std::fclose(out) != 0) throw std::runtime_error(file + ": cannot be written");
}

std::string plot_script(const std::string& csv, const std::string& svg, std::size_t ticks, const char* const* joint_names) {
  constexpr int after_joints = 2 + 2 * joints;  // column of largest_error_rad
  std::string tracking = "plot";
  for (int i = 0; i < joints; i += 4)
    tracking += fmt::format(
        " data every 10 using 1:{0} with lines lw 2 lc {3} title '{2}', data every 10 using 1:{1} with lines lc black dt 2 "
        "notitle,",
        2 + 2 * i, 3 + 2 * i, joint_names[i], 1 + i / 4);
  tracking.back() = '\n';
  return fmt::format(R"(
set terminal svg size 1100,1200 dynamic background 'white' font 'sans,13'
set output {svg}
data = {csv}
set datafile separator ','
set key noenhanced outside right
set grid
set multiplot layout 4,1
set xlabel 'time, s'
set ylabel 'joint angle, rad'
set title 'Tracking (every fourth joint; dashed: desired)'
{tracking}
set logscale y
set format y '10^{{%L}}'
set ylabel 'largest error of a joint, rad'
set title 'Tracking error'
plot data every 10 using 1:{error} with lines notitle, 1e-3 with lines dt 2 lc black title 'target (RMS)'
set format y '%g'
set ylabel 'time, µs'
set title 'Each tick'
plot data every 5 using 1:{plant} with points pt 7 ps 0.2 lc 3 title 'plant', data every 5 using 1:{woken} with points pt 7 ps 0.2 lc 4 title 'wake-up lateness', data every 5 using 1:{law} with points pt 7 ps 0.2 lc 2 title 'whole law', data every 5 using 1:{dynamics} with points pt 7 ps 0.2 lc 1 title 'dynamics call'
unset logscale
set logscale x
set yrange [0:1]
set xlabel 'time, µs'
set ylabel 'share of ticks below'
set title 'Distribution of times'
plot data using {dynamics}:(1.0/{ticks}) smooth cumulative title 'dynamics call', data using {law}:(1.0/{ticks}) smooth cumulative title 'whole law', data using {plant}:(1.0/{ticks}) smooth cumulative title 'plant', data using {woken}:(1.0/{ticks}) smooth cumulative title 'wake-up lateness'
unset multiplot
)",
                     fmt::arg("svg", quoted(svg)), fmt::arg("csv", quoted(csv)), fmt::arg("tracking", tracking),
                     fmt::arg("error", after_joints), fmt::arg("dynamics", after_joints + 1), fmt::arg("law", after_joints + 2),
                     fmt::arg("plant", after_joints + 3), fmt::arg("woken", after_joints + 6), fmt::arg("ticks", ticks));
}

}  // namespace

bool print_table(const Summary& summary, Base base, const char* const* joint_names, bool timing_counts) {
  print_header();
  print_row("dynamics call (generated)", summary.dynamics);
  print_row("  rehearsal of it, caches cold", summary.rehearsal);
  print_row("whole control law", summary.law);
  print_row("plant and checks (MuJoCo)", summary.plant);
  print_row("begin of the tick, late by", summary.begun);
  print_row("wake-up lateness (jitter)", summary.woken);
  fmt::print("\n  of {} deadlines missed from computing {}, missed from late begin or preemption {}\n", summary.ticks,
             summary.missed_by_computing, summary.missed_by_system);
  fmt::print("  tracking after the first second: RMS {:.3g} rad, peak {:.3g} rad ({})\n", summary.rms_error, summary.peak_error,
             joint_names[summary.worst_joint]);
  fmt::print("  heap allocations in the loop: {}\n", summary.heap_allocations);
  fmt::print("  generated M against MuJoCo's: largest difference {:.2g} of M's largest element\n",
             summary.mass_matrix_difference);
  if (base == Base::floating) {
    const char* kind[] = {"linear", "angular"};
    for (int i = 0; i < 2; ++i)
      fmt::print(
          "  {:<7} momentum: largest change {:.2g} by the generated M, {:.2g} by MuJoCo; they differ by {:.2g} (all "
          "relative)\n",
          kind[i], summary.drift[i][0], summary.drift[i][1], summary.disagreement[i]);
  }

  fmt::print("\n");
  bool in_time = verdict("no deadline missed from computing", summary.missed_by_computing == 0);
  in_time &=
      verdict(fmt::format("p99 of the dynamics call under {:g} µs", dynamics_target), summary.dynamics.p99 < dynamics_target);
  in_time &= verdict("self-test at the start under 1 ms", summary.self_test < self_test_target);
  bool met = in_time || !timing_counts;
  met &= verdict("RMS tracking error under 1e-3 rad after the first second", summary.rms_error < rms_target);
  met &= verdict("no heap allocation in the loop", summary.heap_allocations == 0);
  met &= verdict("M agrees with MuJoCo's to 1e-9", summary.mass_matrix_difference < agreement_target);
  if (base == Base::floating) {
    met &= verdict("momenta agree with MuJoCo's to 1e-9",
                   summary.disagreement[0] < agreement_target && summary.disagreement[1] < agreement_target);
    met &= verdict("momenta conserved to 1e-6", summary.drift[0][0] < drift_target && summary.drift[1][0] < drift_target);
  }
  return met;
}

void write_files(const std::string& directory, const std::vector<Tick>& ticks, Base base, const char* const* joint_names) {
  std::filesystem::create_directories(directory);
  const std::string stem =
      (std::filesystem::path(directory) / (base == Base::fixed ? "mahru_fixed" : "mahru_floating")).string();
  write_csv(stem + ".csv", ticks, joint_names);
  fmt::print("\n  every tick: {}.csv\n", stem);

  const std::string script = plot_script(stem + ".csv", stem + ".svg", ticks.size(), joint_names);
  draw(script, stem + ".svg");
}

}  // namespace controller
