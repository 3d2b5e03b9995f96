// eval and check as a user runs them: both engines agree, and a wrong line of generated code is found.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include "run_dalembert.hpp"

namespace dalembert::test {
namespace {

const std::string arm = ERROR_ROBOTS "/scenes/arm.urdf";
const std::string quickly[] = {"--flags", "-std=c++17 -O1 " PRECOMPILED_EIGEN};
const std::string as_users_do[] = {"--flags", "-O3 -march=native -std=c++17 " PRECOMPILED_EIGEN};

// Rows of numbers; an empty row between states.
std::vector<std::vector<double>> rows(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    rows.emplace_back();
    for (double x; words >> x;) rows.back().push_back(x);
  }
  return rows;
}

struct Use {
  std::string output;
  size_t rows, columns;
  std::vector<std::string> options;
};

TEST(Eval, EnginesAgreeAndShapesAreThoseOfTheQuantity) {
  const std::vector<std::string> fixed{"--base", "fixed"}, floating{"--base", "floating"};
  const std::vector<std::string> driven{
      "--base",     "fixed",     "--mimic",     "{wrist: {of: elbow, multiplier: -1.5, offset: 0.1}}",
      "--armature", "wrist=0.1", "--damping",   "wrist=2,grip=1",
      "--friction", "elbow=0.5", "--stiffness", "{elbow: {k: 3, rest: 0.2}}"};
  for (const Use& use :
       {Use{"mass_matrix", 10, 10, floating}, Use{"wrench_influence", 10, 30, floating}, Use{"coriolis_matrix", 4, 4, fixed},
        Use{"jacobian_tool", 6, 4, fixed}, Use{"bias", 3, 1, driven}, Use{"mass_matrix", 3, 3, driven}}) {
    SCOPED_TRACE(use.output);
    const size_t nv = use.output == "jacobian_tool" ? use.columns : use.rows, nq = nv + (nv == 10 ? 1 : 0);
    std::string states;
    for (int s = 0; s < 2; ++s) {
      for (size_t i = 0; i < nq + nv; ++i) states += std::to_string(std::sin(static_cast<double>(i) + 10 * s)) + ' ';
      states += '\n';
    }
    Outcome outcomes[2];
    for (int e = 0; e < 2; ++e) {
      std::vector<std::string> arguments{
          "eval", arm, "--state", "-", "--output", use.output, "--engine", e ? "generated" : "generic", quickly[0], quickly[1]};
      arguments.insert(arguments.end(), use.options.begin(), use.options.end());
      outcomes[e] = run_dalembert(arguments, ".", states);
      ASSERT_EQ(outcomes[e].status, 0) << outcomes[e].err;
    }
    const auto generic = rows(outcomes[0].out), generated = rows(outcomes[1].out);
    ASSERT_EQ(generic.size(), 2 * use.rows + 1);
    ASSERT_EQ(generated.size(), generic.size());
    double largest = 0, difference = 0;
    for (size_t i = 0; i < generic.size(); ++i) {
      ASSERT_EQ(generic[i].size(), i == use.rows ? 0 : use.columns);
      ASSERT_EQ(generated[i].size(), generic[i].size());
      for (size_t k = 0; k < generic[i].size(); ++k) {
        largest = std::max(largest, std::abs(generic[i][k]));
        difference = std::max(difference, std::abs(generic[i][k] - generated[i][k]));
      }
    }
    EXPECT_GT(largest, 0);
    EXPECT_LE(difference, 1e-12 * largest);
  }
}

// The generic engine's numbers: nothing is compiled.
TEST(Eval, NamesRowsAndColumnsWhereAskedTo) {
  const auto eval = [](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"eval",    arm,        "--base", "fixed",   "--engine",
                                       "generic", "--output", output,   "--state", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_dalembert(arguments, ".", "0 0 0 0 0 0 0 0\n0 0 0 0.5 0 0 0 0\n");
  };
  const Outcome matrix = eval("mass_matrix", {"--labels"});
  EXPECT_EQ(matrix.status, 0) << matrix.err;
  std::istringstream lines(matrix.out);
  std::string line, first, row;
  std::getline(lines, line);
  std::istringstream head(line);
  std::vector<std::string> names{std::istream_iterator<std::string>(head), {}};
  EXPECT_EQ(names, (std::vector<std::string>{"shoulder", "elbow", "grip", "wrist"})) << matrix.out;
  std::getline(lines, row);
  EXPECT_TRUE(row.starts_with("shoulder  ")) << matrix.out;
  EXPECT_EQ(std::count(matrix.out.begin(), matrix.out.end(), '\n'), 2 * 5 + 1) << matrix.out;
  const Outcome pose =
      eval("pose_tip", {"--frames", "{tip: {link: hand, at: [0, 0, 0.25, 0, 0, 0], outputs: [pose]}}", "--labels"});
  EXPECT_EQ(pose.out.substr(0, pose.out.find("\n\n")),
            "   x_axis  y_axis  z_axis  origin\nx       1       0       0     0.3\ny       0       1       0       0\n"
            "z       0       0       1    0.85")
      << pose.err;
  EXPECT_EQ(eval("kinetic_energy", {"--labels"}).out, "0\n\n0\n");
  const Outcome json = eval("gravity", {"--json"});
  EXPECT_EQ(json.out,
            "{\n  \"output\": \"gravity\",\n  \"symbol\": \"g\",\n  \"unit\": \"N, N m\",\n"
            "  \"help\": \"gravity term of M dv/dt + C v + g = tau: what holds the robot still\",\n  \"rows\": [\"shoulder\", "
            "\"elbow\", \"grip\", \"wrist\"],\n  \"columns\": [],\n"
            "  \"states\": [\n    [[0], [0], [9.8100000000000005], [0]],\n    [[0], [0], [9.8100000000000005], [0]]\n  ]\n}\n")
      << json.err;
  EXPECT_EQ(eval("gravity", {"--json", "--labels"}).status, 2);
}

TEST(Eval, NamesOfManyWordsAreOneBetweenBlanksAndThemselvesInJson) {
  const TemporaryFolder folder;
  write_text(folder.path() + "/r.urdf",
             "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' "
             "iyy='1' iyz='0' izz='1'/></inertial></link><joint name='left knee' type='continuous'><parent link='a'/><child "
             "link='b'/><axis xyz='0 0 1'/></joint></robot>");
  const auto eval = [&](const std::string& style) {
    const Outcome outcome = run_dalembert(
        {"eval", "r.urdf", "--base", "fixed", "--engine", "generic", "--output", "mass_matrix", "--state", "-", style},
        folder.path(), "0 0\n");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_EQ(eval("--labels"), "           left_knee\nleft_knee          1\n");
  EXPECT_NE(eval("--json").find("\"rows\": [\"left knee\"],\n  \"columns\": [\"left knee\"]"), std::string::npos);
}

// NaN where the scene says nothing is read.
TEST(Eval, DoesNotReadWhatTheQuantityDoesNotDependOn) {
  struct Case {
    std::vector<std::string> options;
    std::string output, state, same;
  };
  const std::string zeros = " 0 0 0 0", q = "0.1 -0.2 0.3 0.4", nans = " nan nan nan nan";
  const std::string pose = "0.5 0.6 0.7 0.6 0 0 0.8 ", no_pose = "nan nan nan nan nan nan nan ", twist = " 0 0 0 0 0 0";
  const std::string no_twist = " nan nan nan nan nan nan";
  for (const Case& c :
       {Case{{"--base", "fixed", "--outputs", "gravity"}, "gravity", q + zeros, q + nans},
        Case{{"--base", "fixed", "--outputs", "mass_matrix"}, "mass_matrix", q + zeros, "nan -0.2 0.3 0.4" + nans},
        Case{{"--base", "floating", "--outputs", "mass_matrix"},
             "mass_matrix",
             pose + q + twist + zeros,
             no_pose + q + no_twist + nans},
        Case{{"--base", "fixed", "--rates_zero", "true", "--outputs", "bias"}, "bias", q + zeros, q + nans}}) {
    SCOPED_TRACE(c.output);
    std::vector<std::string> arguments{"eval", arm, "--state", "-", "--output", c.output, quickly[0], quickly[1]};
    arguments.insert(arguments.end(), c.options.begin(), c.options.end());
    const Outcome plain = run_dalembert(arguments, ".", c.state + "\n"),
                  poisoned = run_dalembert(arguments, ".", c.same + "\n");
    ASSERT_EQ(plain.status, 0) << plain.err;
    ASSERT_EQ(poisoned.status, 0) << poisoned.err;
    EXPECT_EQ(poisoned.out, plain.out);
    EXPECT_EQ(plain.out.find("nan"), std::string::npos);
  }
}

TEST(Eval, RefusesWhatWouldSpoilSines) {
  for (const std::string engine : {"generated", "batch"}) {
    const Outcome outcome = run_dalembert({"eval", arm, "--base", "fixed", "--output", "mass_matrix", "--engine", engine,
                                           "--state", "-", "--flags", "-std=c++17 -O1 -ffast-math"},
                                          ".", "0.1 -0.2 0.3 0.4 1 2 3 4\n");
    EXPECT_NE(outcome.status, 0) << outcome.out;
    EXPECT_NE(outcome.err.find("compile this file without"), std::string::npos) << outcome.err;
  }
}

// A state is what the function takes, even for a result that depends on less.
TEST(Eval, GivesResultsOfTheScenesFunctionsByTheirNames) {
  const std::string state = "0.1 -0.2 0.3 0.4 1 2 3 4";
  const auto eval = [](const std::string& output, const std::string& engine, const std::string& state) {
    return run_dalembert({"eval", arm, "--base", "fixed", "--functions", "{plan: [mass_matrix, forward_dynamics_dv]}",
                          "--output", output, "--engine", engine, "--state", "-", quickly[0], quickly[1]},
                         ".", state + "\n");
  };
  const Outcome own = eval("mass_matrix", "generated", state);
  for (const std::string engine : {"generic", "generated"}) {
    const Outcome outcome = eval("plan_mass_matrix", engine, state + " 5 6 7 8");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto expected = rows(own.out), given = rows(outcome.out);
    ASSERT_EQ(given.size(), 4u);
    for (size_t i = 0; i < 4; ++i)
      for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(given[i][k], expected[i][k], 1e-12);
  }
  const Outcome derivative = eval("plan_forward_dynamics_dv", "generated", state + " 5 6 7 8");
  EXPECT_EQ(derivative.status, 0) << derivative.err;
  const Outcome wrong = eval("plan_mass_matrix", "generic", state);
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("there are 8 numbers instead of 12"), std::string::npos) << wrong.err;
  EXPECT_NE(wrong.err.find("then tau (4)"), std::string::npos) << wrong.err;
  const Outcome unknown = eval("plan_mass_matrx", "generic", state);
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("did you mean 'plan_mass_matrix'?"), std::string::npos) << unknown.err;
}

TEST(Check, PassesInDoubleAndFloat) {
  for (const char* scalar : {"double", "float"}) {
    const Outcome outcome =
        run_dalembert({"check", arm, "--scalar", scalar, "--outputs", "gravity", quickly[0], quickly[1]}, ".");
    EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    EXPECT_EQ(outcome.out.find("DIFFERS"), std::string::npos);
    EXPECT_EQ(outcome.out.find("not told"), std::string::npos);
  }
}

// A function that the scene names has one line with its time, and no result of it has one. What is computed together may be all
// that is compiled; what one piece computes has no other code.
TEST(Check, GivesEachFunctionOneTime) {
  using Names = std::vector<std::string>;
  struct Case {
    std::vector<std::string> options;
    Names headings, timed;
  };
  const std::vector<std::string> functions{"--functions", "{plan: [mass_matrix, center_of_mass]}"};
  const Case cases[] = {
      {functions, {"each by code of its own", "all by one code"}, {"gravity", "plan()", "evaluate()", "plan()"}},
      {{functions[0], functions[1], "--together"}, {"all by one code"}, {"evaluate()", "plan()"}},
      {{"--together"}, {"its code"}, {"gravity"}},
  };
  for (const Case& expected : cases) {
    std::vector<std::string> arguments{"check", arm, "--base", "fixed", "--outputs", "gravity", quickly[0], quickly[1]};
    arguments.insert(arguments.end(), expected.options.begin(), expected.options.end());
    const Outcome outcome = run_dalembert(arguments, ".");
    EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    std::istringstream text(outcome.out);
    Names timed, headings;
    for (std::string line; std::getline(text, line);) {
      if (line.empty()) continue;
      const std::string name = line.substr(2, line.find("  ", 2) - 2);
      if (line.ends_with(" a call")) headings.push_back(name);
      if (line.ends_with(" ns") || line.ends_with(" µs")) timed.push_back(name);
    }
    EXPECT_EQ(headings, expected.headings) << outcome.out;
    EXPECT_EQ(timed, expected.timed) << outcome.out;
    EXPECT_NE(outcome.out.find("self-test                         passes"), std::string::npos) << outcome.out;
  }
}

// What users are told to build with is what is tested, and times are its; another compiler, flags and lanes can be had. Scripts
// in place of the compiler show with what they are called.
TEST(Check, CompilesAsUsersDoUnlessToldOtherwise) {
  const Outcome usual = run_dalembert({"check", arm, "--outputs", "gravity"}, ".");
  EXPECT_EQ(usual.status, 0) << usual.err << usual.out;
  EXPECT_NE(usual.out.find("compiled by c++ -O3 -march=native -std=c++17\n"), std::string::npos) << usual.out;
  EXPECT_NE(usual.out.find("self-test                         passes"), std::string::npos) << usual.out;

  const TemporaryFolder folder;
  const std::string compiler = folder.path() + "/compiler";
  write_text(compiler, "#!/bin/sh\necho \"$@\" >> '" + folder.path() + "/called'\nexec c++ \"$@\"\n");
  chmod(compiler.c_str(), 0700);
  for (const std::string command : {"check", "eval"}) {
    std::vector<std::string> arguments{command,  arm,       "--base",         "fixed",   "--compiler",
                                       compiler, "--flags", "-std=c++20 -Os", "--lanes", "2"};
    if (command == "check") arguments.insert(arguments.end(), {"--outputs", "gravity"});
    else arguments.insert(arguments.end(), {"--output", "gravity", "--state", "-"});
    const Outcome outcome = run_dalembert(arguments, ".", "0.1 0.2 0.3 0.4 0 0 0 0\n");
    EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    const std::string called = text_of(folder.path() + "/called");
    EXPECT_EQ(called.rfind("-std=c++20 -Os -DDALEMBERT_LANES=2 ", 0), 0u) << called;
    std::remove((folder.path() + "/called").c_str());
  }
}

// clang++ 14 takes C++14 where nothing is said: the workspace then lacks its alignment.
TEST(Check, RefusesAnOlderLanguageThanTheCodeIsWrittenIn) {
  const Outcome outcome = run_dalembert({"check", arm, "--outputs", "gravity", "--flags", "-O1 -std=gnu++14"}, ".");
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_NE(outcome.err.find("dalembert needs C++17"), std::string::npos) << outcome.err;
}

// At the edge: C of joints that do not meet, and derivatives with one joint, are zero but for rounding, nothing is left but the
// base, angles are sums, numbers are multiplied with numbers in lanes. What is compiled has no warning.
TEST(Check, PassesAtTheEdge) {
  const std::string branches = ERROR_ROBOTS "/../robots/two_branches_at_base.urdf";
  setenv("CXX", "c++ -Wall -Wextra -Wpedantic -Werror", 1);
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {branches, "--base", "fixed", "--cut", "a_02,b_02", "--outputs", "coriolis_matrix"},
           {branches, "--base", "floating", "--cut", "a_01,b_01", "--payloads", "base", "--outputs", "gravity"},
           {branches, "--form", "rolled", "--without", "fold", "--outputs", "inverse_dynamics_dq"},
           {ERROR_ROBOTS "/../robots/pendulum.urdf", "--base", "fixed", "--gravity", "none", "--outputs",
            "forward_dynamics_dq,forward_dynamics_dv"},
           {ERROR_ROBOTS "/../robots/hand.urdf", "--base", "fixed", "--outputs", "inverse_mass_matrix", "--frames",
            "{a_palm: [twist]}"},
           {arm, "--base", "fixed", "--outputs", "mass_matrix", "--mimic",
            "{elbow: {of: shoulder, multiplier: 0.3}, wrist: {of: shoulder, multiplier: 0.3, offset: 1}}"}}) {
    std::vector<std::string> command{"check", quickly[0], quickly[1]};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const Outcome outcome = run_dalembert(command, ".");
    EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  }
  unsetenv("CXX");
}

// Joints that move no mass: rows of zeros in M, nothing divided by them, in either form.
TEST(Check, PassesWhereJointsMoveNoMass) {
  struct Case {
    const char *robot, *form, *output;
  };
  for (const Case& c : {Case{"massless_subtree", "straight", "coriolis_matrix"},
                        {"massless_subtree", "rolled", "coriolis_matrix"},
                        {"inertia_but_no_mass_on_a_slide", "rolled", "coriolis_matrix"},
                        {"massless_subtree", "rolled", "bias"}}) {
    SCOPED_TRACE(std::string(c.robot) + ' ' + c.form);
    const Outcome outcome = run_dalembert({"check", std::string(ERROR_ROBOTS "/") + c.robot + ".urdf", "--base", "floating",
                                           "--form", c.form, "--outputs", c.output, as_users_do[0], as_users_do[1]},
                                          ".");
    EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  }
}

// What may be wrong by as much as it is large is not passed in silence: two contacts that hold one link twice.
TEST(Check, SaysWhatItCannotTell) {
  const Outcome outcome =
      run_dalembert({"check", arm, "--base", "floating", "--contacts",
                     "{held: {link: hand, type: weld}, again: {link: hand, type: point, at: [0.1, 0.2, 0]}}", "--outputs",
                     "constrained_forward_dynamics_dq", quickly[0], quickly[1]},
                    ".");
  EXPECT_NE(outcome.out.find("  not told\n"), outcome.out.npos) << outcome.err << outcome.out;
  EXPECT_NE(outcome.out.find("  not told: what rounding does may be as large as the result"), outcome.out.npos) << outcome.out;
}

// A wheel moves no centre of mass, and all that its column has is rounding; a part of a result that is next to nothing is
// measured against the whole. Motions that end where M is nearly singular are no differences.
TEST(Check, MeasuresWhatVanishesAgainstWhatItIsMadeOf) {
  const std::string robot = ERROR_ROBOTS "/turned_wheel.urdf";
  for (const char* base : {"fixed", "floating"}) {
    const Outcome outcome = run_dalembert(
        {"check", robot, "--base", base, "--outputs", "[{center_of_mass_jacobian: {joints: [wheel]}}]", quickly[0], quickly[1]},
        ".");
    EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  }
}

// Nor does a joint move a point on its own axis: rows that are rounding, and what is made of them.
TEST(Check, MeasuresRowsOfPointsThatNothingMovesAgainstTheirLevers) {
  const Outcome outcome = run_dalembert(
      {"check", ERROR_ROBOTS "/../robots/two_branches_at_base.urdf", "--base", "fixed", "--contacts", "{b_01: point}",
       "--functions", "rows=constraint_jacobian,constraint_bias,delassus_matrix", "--outputs", "[]", quickly[0], quickly[1]},
      ".");
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
}

// M of which nothing is left at any state is no agreement of zeros: a point mass on its own joint's axis, held and not.
TEST(Check, DoesNotTellWhereMIsSingularAtEveryState) {
  for (const char* output : {"constrained_forward_dynamics", "delassus_matrix", "impact"}) {
    const Outcome outcome = run_dalembert({"check", ERROR_ROBOTS "/point_mass_on_axis.urdf", "--base", "fixed", "--payloads",
                                           "b", "--contacts", "b=point", "--outputs", output, quickly[0], quickly[1]},
                                          ".");
    EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    EXPECT_NE(outcome.out.find("  not told\n"), outcome.out.npos) << outcome.err << outcome.out;
    EXPECT_NE(outcome.out.find("in half of them payloads, some contacts"), outcome.out.npos) << outcome.out;
  }
}

// Twenty kilometres from the base the generic engine, which takes moments about the base, loses what emitted code keeps.
TEST(Check, SaysWhereTheGenericEngineIsOff) {
  const Outcome outcome = run_dalembert(
      {"check", ERROR_ROBOTS "/far_from_base.urdf", "--base", "fixed", "--outputs", "mass_matrix", quickly[0], quickly[1]},
      ".");
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
  EXPECT_NE(outcome.out.find("  the generic engine is off\n"), outcome.out.npos) << outcome.out;
}

// A robot without any mass has Jacobians, and no dynamics.
TEST(Eval, NeedsAMassForDynamicsOnly) {
  const std::string robot = ERROR_ROBOTS "/no_mass_at_all.urdf";
  for (const char* engine : {"generic", "generated"}) {
    const Outcome outcome = run_dalembert({"eval", robot, "--base", "fixed", "--state", "-", "--output", "jacobian_b",
                                           "--engine", engine, as_users_do[0], as_users_do[1]},
                                          ".", "0.3 0\n");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "0\n0\n0\n0\n0\n1\n");
  }
  const Outcome outcome = run_dalembert({"eval", robot, "--state", "-", "--output", "mass_matrix"}, ".", "0.3 0\n");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("nothing that moves has a mass: there are no dynamics"), std::string::npos) << outcome.err;
}

// An inertia that no body has is computed with all the same.
TEST(Check, PassesOnInertiasAccepted) {
  const Outcome outcome = run_dalembert({"check", ERROR_ROBOTS "/negative_inertia.urdf", "--inertia", "accept", "--outputs",
                                         "bias", as_users_do[0], as_users_do[1]},
                                        ".");
  EXPECT_EQ(outcome.status, 0) << outcome.err << outcome.out;
}

// A compiler that first turns an addition of the generated code into a subtraction.
TEST(Check, FindsAWrongLine) {
  const TemporaryFolder folder;
  const std::string compiler = folder.path() + "/compiler";
  write_text(compiler,
             "#!/bin/sh\nfor file; do case \"$file\" in */code_and_interface.cpp)\n"
             "  sed -i '0,/\\(Scalar .* = .*\\) + /s//\\1 - /' \"${file%/*}/dynamics.cpp\";;\nesac; done\nexec c++ \"$@\"\n");
  chmod(compiler.c_str(), 0700);
  setenv("CXX", compiler.c_str(), 1);
  const Outcome outcome = run_dalembert({"check", arm, "--outputs", "mass_matrix", quickly[0], quickly[1]}, ".");
  unsetenv("CXX");
  EXPECT_EQ(outcome.status, 1) << outcome.err << outcome.out;
  EXPECT_NE(outcome.out.find("DIFFERS"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("FAILS: mass_matrix("), std::string::npos) << outcome.out;
}

// What is off or gives way is compared, too: code in which all constraints always act is found.
TEST(Check, LetsConstraintsGo) {
  const TemporaryFolder folder;
  const std::string compiler = folder.path() + "/compiler";
  write_text(compiler,
             "#!/bin/sh\nfor file; do case \"$file\" in */code_and_interface.cpp)\n"
             "  sed -i 's/[.]active [?] Scalar(1) : Scalar(0)/.active ? Scalar(1) : Scalar(1)/' "
             "\"${file%/*}/dynamics.cpp\";;\nesac; done\nexec c++ \"$@\"\n");
  chmod(compiler.c_str(), 0700);
  for (const char* cxx : {"c++", compiler.c_str()}) {
    setenv("CXX", cxx, 1);
    const Outcome outcome = run_dalembert(
        {"check", arm, "--base", "fixed", "--outputs", "impact", "--contacts", "hand=point", quickly[0], quickly[1]}, ".");
    unsetenv("CXX");
    EXPECT_EQ(outcome.status, cxx == compiler ? 1 : 0) << outcome.err << outcome.out;
    EXPECT_EQ(outcome.out.find("DIFFERS") != std::string::npos, cxx == compiler) << outcome.out;
    EXPECT_NE(outcome.out.find("20 random states, in half of them some contacts or loops off or giving way"), std::string::npos)
        << outcome.out;
  }
}

// Rollouts beside the integrators with the generic engine's accelerations, of contacts and joints with quaternions too; and
// where nothing acts that should, both check and self-test say so.
TEST(Check, CoversRollouts) {
  setenv("CXX", "c++ -Wall -Wextra -Wpedantic -Werror", 1);
  const Outcome held =
      run_dalembert({"check", arm, "--base", "fixed", "--batch", "true", "--outputs", "constrained_forward_dynamics,impact",
                     "--functions", "{free: [bias, forward_dynamics]}", "--contacts", "hand=point", "--rollouts", "impacts",
                     "--joints", "{elbow: spherical}", quickly[0], quickly[1]},
                    ".");
  EXPECT_EQ(held.status, 0) << held.err << held.out;
  for (const char* line :
       {"its rollouts, 4 steps ", "constrained_forward_dynamics, Euler ", "constrained_forward_dynamics, rk4 ", "free, Euler "})
    EXPECT_NE(held.out.find(line), std::string::npos) << line << held.out;

  // Stiff joints by linearly implicit steps: one of a ball, one behind a motor, one that drives another; dampers and springs
  // are in what the self-test has from 50 digits, too.
  const std::vector<std::string> stiff{"check",       arm,
                                       "--base",      "floating",
                                       "--batch",     "true",
                                       "--outputs",   "forward_dynamics",
                                       "--rollouts",  "linearly_implicit",
                                       "--joints",    "{elbow: spherical}",
                                       "--elastic",   "{shoulder: {k: 1e6, inertia: 0.1, damping: 1e3}}",
                                       "--mimic",     "{grip: {of: wrist, multiplier: -2}}",
                                       "--damping",   "elbow=1e3,wrist=2,grip=5",
                                       "--stiffness", "wrist=1e6",
                                       quickly[0],    quickly[1]};
  const Outcome at_rest = run_dalembert(stiff, ".");
  EXPECT_EQ(at_rest.status, 0) << at_rest.err << at_rest.out;
  EXPECT_NE(at_rest.out.find("forward_dynamics, implicit "), std::string::npos) << at_rest.out;

  const TemporaryFolder folder;
  const std::string compiler = folder.path() + "/compiler";
  // Of the ball's damper nothing counts.
  write_text(compiler,
             "#!/bin/sh\nfor file; do case \"$file\" in */batch.cpp)\n"
             "  sed -i '/broadcast<width, Scalar>(h [*] 1000/s/1000/10/' \"$file\";;\nesac; done\nexec c++ \"$@\"\n");
  chmod(compiler.c_str(), 0700);
  setenv("CXX", compiler.c_str(), 1);
  const Outcome undamped = run_dalembert(stiff, ".");
  EXPECT_EQ(undamped.status, 1) << undamped.err << undamped.out;
  EXPECT_NE(undamped.out.find("FAILS: forward_dynamics("), std::string::npos) << undamped.out;
  std::istringstream lines_of_implicit(undamped.out);
  for (std::string line; std::getline(lines_of_implicit, line);)
    EXPECT_EQ(line.ends_with("  DIFFERS"), line.find("forward_dynamics, implicit ") != std::string::npos) << line;

  write_text(
      compiler,
      "#!/bin/sh\nfor file; do case \"$file\" in */batch.cpp)\n"
      "  sed -i '/rollout, batch.q, batch.v, batch.input/s/batch.input/nullptr/' \"$file\";;\nesac; done\nexec c++ \"$@\"\n");
  chmod(compiler.c_str(), 0700);
  setenv("CXX", compiler.c_str(), 1);
  const Outcome spoilt = run_dalembert(
      {"check", arm, "--base", "fixed", "--batch", "true", "--outputs", "forward_dynamics", quickly[0], quickly[1]}, ".");
  unsetenv("CXX");
  EXPECT_EQ(spoilt.status, 1) << spoilt.err << spoilt.out;
  EXPECT_NE(spoilt.out.find("FAILS: forward_dynamics("), std::string::npos) << spoilt.out;
  std::istringstream lines(spoilt.out);
  for (std::string line; std::getline(lines, line);) {
    const bool is_rollout = line.find("forward_dynamics, ") != std::string::npos;
    EXPECT_EQ(line.ends_with("  DIFFERS"), is_rollout) << line;
  }
}

// The file gets a plan, and with it the next generation is the same, byte for byte.
TEST(Plan, IsMeasuredAndRepeated) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() + "/scene.yaml", before = "base: fixed  # on a table\noutputs: [mass_matrix]\n";
  write_text(scene, before);
  const Outcome measured =
      run_dalembert({"generate", arm, "--scene", scene, "-o", "a", "--plan", "measure", quickly[0], quickly[1]}, folder.path());
  ASSERT_EQ(measured.status, 0) << measured.err;
  EXPECT_NE(measured.out.find("chosen"), std::string::npos) << measured.out;
  const std::string after = text_of(scene);
  EXPECT_TRUE(after.starts_with(before + "plan:\n  evaluate: {form: ")) << after;
  const Outcome again = run_dalembert({"generate", arm, "--scene", scene, "-o", "b"}, folder.path());
  ASSERT_EQ(again.status, 0) << again.err;
  for (const char* file : {"/dynamics.cpp", "/dynamics.hpp"})
    EXPECT_EQ(text_of(folder.path() + "/a" + file), text_of(folder.path() + "/b" + file)) << file;
}

TEST(Plan, IsNotMeasuredWhereItsFileCannotHoldIt) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() + "/scene.yaml";
  write_text(scene, "{base: fixed}\n");
  const Outcome run = run_dalembert({"generate", arm, "--scene", scene, "-o", "a", "--plan", "measure"}, folder.path());
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("key 'plan': error: its keys do not each begin a line"), std::string::npos) << run.err;
  EXPECT_EQ(text_of(scene), "{base: fixed}\n");
  EXPECT_EQ(text_of(folder.path() + "/a/dynamics.cpp"), "");
}

}  // namespace
}  // namespace dalembert::test
