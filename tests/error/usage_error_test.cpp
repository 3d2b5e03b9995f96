// Bad usage, bad state files, and places that cannot be written: exit status 2, a remedy, nothing on stdout.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cstdlib>
#include <dalembert/version.hpp>
#include <filesystem>

#include "run_dalembert.hpp"

namespace dalembert::test {
namespace {

const std::string sound = ERROR_ROBOTS "/sound.urdf";

void expect_refused(const Outcome& run, const std::string& message) {
  EXPECT_EQ(run.status, 2) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.err.find(message), std::string::npos) << run.err;
}

TEST(Usage, BadCommandLinesAreRefused) {
  expect_refused(run_dalembert({"frobnicate"}, "."), "there is no command 'frobnicate'; choose from generate, info, ");
  expect_refused(run_dalembert({"chekc", sound}, "."), "there is no command 'chekc'; did you mean 'check'?");
  expect_refused(run_dalembert({"info"}, "."), "command line: error: ROBOT is required");
  expect_refused(run_dalembert({"info", sound, "--bse", "fixed"}, "."), "there is no option --bse; did you mean '--base'?");
  expect_refused(run_dalembert({"generate", sound}, "."), "--out is required");
  expect_refused(run_dalembert({"eval", sound, "--state", "-"}, "."), "--output is required");
  expect_refused(run_dalembert({"eval", sound, "--state", "-", "--output", "bias", "--engine", "steam"}, "."), "steam");
  expect_refused(run_dalembert({"info", sound, "--name", "a-b"}, "."),
                 "option --name: error: 'a-b' cannot be the name of a C++");
  expect_refused(run_dalembert({"info", sound, "--name", "class"}, "."), "option --name: error: 'class' is a keyword of C++");
  for (const char* macro : {"DALEMBERT_INLINE", "ARM_C_API_H"})
    expect_refused(run_dalembert({"info", sound, "--name", macro}, "."),
                   "option --name: error: '" + std::string(macro) + "' could be a macro of the generated code");
}

TEST(Usage, NoCommandMeetsThreeToBeginWith) {
  const Outcome run = run_dalembert({}, ".");
  expect_refused(run, "command line: error: no command is given; begin with one of these, or with 'dalembert --help':\n");
  for (const char* command : {"info ROBOT.urdf ", "check ROBOT.urdf ", "generate ROBOT.urdf --base fixed -o DIR "})
    EXPECT_NE(run.err.find(std::string("\n  dalembert ") + command), std::string::npos) << run.err;
}

TEST(Usage, TheVersionIsAResult) {
  const Outcome run = run_dalembert({"--version"}, ".");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(run.out, "dalembert " DALEMBERT_VERSION ", runtime " + std::to_string(runtime_version) + "\n");
}

TEST(Usage, EmptyOptionsAreRefused) {
  const std::string or_not = ": error: its value is empty; give one, or leave the option out\n";
  const std::string needed = ": error: its value is empty; give one\n";
  for (const char* option : {"--scene", "--name"})
    expect_refused(run_dalembert({"info", sound, option, ""}, "."), std::string("option ") + option + or_not);
  expect_refused(run_dalembert({"check", sound, "--compiler", ""}, "."), "option --compiler" + or_not);
  expect_refused(run_dalembert({"generate", sound, "-o", ""}, "."), "option --out" + needed);
  expect_refused(run_dalembert({"eval", sound, "--state", "", "--output", "bias"}, "."), "option --state" + needed);
  expect_refused(run_dalembert({"eval", sound, "--state", "-", "--output", ""}, "."), "option --output" + needed);
  expect_refused(run_dalembert({"info", sound, "--form", ""}, "."), "--form");
  expect_refused(run_dalembert({"info", sound, "--without", ""}, "."), "--without");
  expect_refused(run_dalembert({"info", ""}, "."), "error");
}

TEST(Usage, TheRolledFormIsObeyedOrRefused) {
  const std::string alone = ERROR_ROBOTS "/nothing_moves.urdf";
  expect_refused(
      run_dalembert({"info", alone, "--base", "floating", "--form", "rolled"}, "."),
      "option --form: error: robot 'r' has no joint that moves, and the rolled form's loops run over joints; leave the "
      "option out, or ask for straight");
  expect_refused(run_dalembert({"info", sound, "--base", "floating", "--locked", "j=0", "--form", "rolled"}, "."),
                 "option --form");
  for (const char* form : {"auto", "straight"})
    EXPECT_EQ(run_dalembert({"info", alone, "--base", "floating", "--form", form}, ".").status, 0) << form;
  const Outcome run = run_dalembert({"info", sound, "--form", "rolled"}, ".");
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.out.find("rolled"), std::string::npos);
}

TEST(Usage, HelpIsAResult) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{}, {"generate"}, {"info"}, {"eval"}, {"check"}, {"report"}}) {
    std::vector<std::string> arguments = words;
    arguments.push_back("--help");
    const Outcome run = run_dalembert(arguments, ".");
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_NE(run.out.find("Usage: dalembert"), std::string::npos);
  }
}

TEST(Usage, AFullDiskIsNotSuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  for (const std::string& what : {"info '" + sound + "'", std::string("--version"), std::string("eval --help")}) {
    const std::string command = std::string("'") + dalembert_path() + "' " + what + " >/dev/full 2>/dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2) << what;
  }
}

// Nobody hears the notice of a floating base; what was asked for is as good. A file that is opened does not take the stream's
// place.
TEST(Usage, WhereStderrCannotBeWrittenTheStatusIsTheSame) {
  const TemporaryFolder folder;
  const auto status = [&](const std::string& words) {
    return WEXITSTATUS(std::system(("'" + std::string(dalembert_path()) + "' " + words).c_str()));
  };
  for (const std::string& lost : {std::string(" 2>&-"), std::string(" 2>/dev/full")}) {
    if (lost == " 2>/dev/full" && !std::filesystem::exists("/dev/full")) continue;
    EXPECT_EQ(status("info '" + sound + "' >/dev/null" + lost), 0) << lost;
    EXPECT_EQ(status("info no_such.urdf" + lost), 2) << lost;
    EXPECT_EQ(status("generate '" + sound + "' -o '" + folder.path() + "/code' <&- >/dev/null" + lost), 0) << lost;
  }
  for (const auto& file : std::filesystem::directory_iterator(folder.path() + "/code"))
    EXPECT_EQ(text_of(file.path().string()).find("notice: "), std::string::npos) << file.path();
}

// As /dev/null, which a renamed file would replace for the whole system.
TEST(Usage, WhatIsNoFileOfADiskIsWrittenToAndStays) {
  const TemporaryFolder folder;
  const std::string pipe = folder.path() + "/pipe.svg", got = folder.path() + "/got.svg";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string command = "timeout 60 cat '" + pipe + "' >'" + got + "' & '" + dalembert_path() + "' info '" + sound +
                              "' --threads 2 --schedule '" + pipe + "' >/dev/null 2>&1; status=$?; wait; exit $status";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_NE(text_of(got).find("</svg>"), std::string::npos);
}

TEST(Usage, PackagesAreNotCalledAsTargetsOfCMake) {
  const TemporaryFolder folder;
  for (const char* name : {"test", "build", "include", "all"})
    expect_refused(run_dalembert({"generate", sound, "--name", name, "--package", "-o", folder.path() + "/p"}, "."),
                   "option --package: error: '" + std::string(name) + "' is what CMake, or a folder of the package, is called");
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/p"));
  EXPECT_EQ(run_dalembert({"generate", sound, "--name", "test", "-o", folder.path() + "/code"}, ".").status, 0);
}

TEST(Usage, ControlCharactersDoNotReachTheTerminal) {
  const Outcome run = run_dalembert({"info", sound, "--locked", "\x1b[31mj=0"}, ".");
  expect_refused(run, "\\x1b[31mj");
  EXPECT_EQ(run.err.find('\x1b'), std::string::npos);
}

Outcome eval(const std::string& states, std::vector<std::string> options = {}) {
  std::vector<std::string> arguments{"eval", sound, "--state", "-", "--output", "bias", "--engine", "generic"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_dalembert(arguments, ".", states);
}

TEST(States, BadOnesAreRefusedWithTheirLine) {
  const std::vector<std::string> fixed{"--base", "fixed"};
  expect_refused(eval("", fixed), "standard input: error: there is no state in it; a state of r is 2 numbers");
  expect_refused(eval("# nothing\n\n", fixed), "standard input: error: there is no state in it");
  expect_refused(eval("0 0\n0\n", fixed), "standard input: line 2: error: there are 1 numbers instead of 2");
  expect_refused(eval("0 0 0\n", fixed), "standard input: line 1: error: there are 3 numbers instead of 2");
  expect_refused(eval("0 zero\n", fixed), "standard input: line 1: error: something on it is not a number");
  expect_refused(eval("0 0,5\n", fixed), "standard input: line 1: error: something on it is not a number: '0,5', number 2");
  expect_refused(eval("0 0 0  0 0 0 0  0   0 0 0 0 0 0 0\n"), "line 1: error: the base's quaternion has length 0; give a unit");
  expect_refused(run_dalembert({"eval", sound, "--state", "no_such", "--output", "bias"}, "."),
                 "no_such: error: there is no such file; name a state file that can be read");
  expect_refused(run_dalembert({"eval", sound, "--state", "-", "--output", "bas"}, "."),
                 "option --output: error: the quantity 'bas' is unknown; did you mean 'bias'?");
  expect_refused(run_dalembert({"eval", sound, "--state", "-", "--output", "jacobian_c"}, "."),
                 "option --output: error: there is no link 'c'");
}

TEST(States, WrenchesComeLast) {
  const std::string q = "0 0 0  0 0 0 1  0", v = " 0 0 0 0 0 0 0", a = v, wrench = " 1 2 3 4 5 6\n";
  const auto eval = [&](const std::string& states, const std::string& output) {
    return run_dalembert({"eval", sound, "--base", "floating", "--gravity", "none", "--state", "-", "--output", output,
                          "--engine", "generic", "--wrenches", "a=world"},
                         ".", states);
  };
  const Outcome run = eval(q + v + a + wrench, "inverse_dynamics");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(run.out.substr(0, 18), "-1\n-2\n-3\n-4\n-5\n-6\n");
  EXPECT_EQ(eval(q + v + "\n", "bias").status, 0);  // which has none
  expect_refused(eval(q + v + a + "\n", "inverse_dynamics"),
                 "standard input: line 1: error: there are 22 numbers instead of 28; a state of r is 28 numbers");
}

TEST(States, CommentsAndBlankLinesAreSkippedAndStatesSeparatedByAnEmptyLine) {
  const Outcome run = eval("# one\n0 1  # at rest\n\n\t0.5 2\r\n", {"--base", "fixed", "--gravity", "none"});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(run.out, "0\n\n0\n");
}

TEST(States, WhatDoesNotEndIsLeftAtOnce) {
  const auto eval = [](const std::string& state) {
    return run_dalembert({"eval", sound, "--state", state, "--output", "bias", "--engine", "generic"}, ".");
  };
  if (std::filesystem::exists("/dev/zero"))
    expect_refused(eval("/dev/zero"), "/dev/zero: error: byte 1 is zero: this is no text; name a state file that can be read");
  expect_refused(eval(dalembert_path()), "is zero: this is no text; name a state file that can be read");
  // Text without an end.
  const std::string command =
      "yes '0 0' | '" + dalembert_path() + "' eval '" + sound + "' --base fixed --state - --output bias --engine generic 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  ASSERT_TRUE(pipe);
  char said[200] = "";
  EXPECT_TRUE(std::fgets(said, sizeof said, pipe));
  EXPECT_EQ(WEXITSTATUS(pclose(pipe)), 2);
  EXPECT_STREQ(said, "standard input: error: the file is longer than 256 MiB; a state is shorter: name another file\n");
}

TEST(States, WhatIsNotFiniteIsRefusedWhereTheResultDependsOnIt) {
  const std::vector<std::string> fixed{"--base", "fixed"};
  expect_refused(eval("0 1\n0 nan\n", fixed),
                 "standard input: line 2: error: number 2, v[0], is nan, and bias depends on it; give a finite number");
  expect_refused(eval("0 -inf\n", fixed), "line 1: error: number 2, v[0], is -inf, and bias depends on it");
  const std::string pose = "nan nan nan  0 0 0 1  0.5", twist = "  0 0 0 0 0 1";
  expect_refused(eval(pose + twist + " inf\n"), "line 1: error: number 15, v[6], is inf, and bias depends on it");
  EXPECT_EQ(eval(pose + twist + " 2\n").status, 0);  // nothing depends on where the base is
  const std::vector<std::string> two{
      "eval", ERROR_ROBOTS "/mimic.urdf", "--base", "fixed", "--state", "-", "--engine", "generic", "--output"};
  const auto of = [&](const char* output, const char* state) {
    std::vector<std::string> arguments = two;
    arguments.push_back(output);
    return run_dalembert(arguments, ".", state);
  };
  expect_refused(of("mass_matrix", "0 nan 0 0\n"), "number 2, q[1], is nan, and mass_matrix depends on it");
  EXPECT_EQ(of("mass_matrix", "0 0 nan inf\n").status, 0);
  expect_refused(of("inverse_dynamics", "0 0 0 0 0 nan\n"), "number 6, a[1], is nan, and inverse_dynamics depends on it");
  expect_refused(of("forward_dynamics", "0 0 0 0 inf 0\n"), "number 5, tau[0], is inf, and forward_dynamics depends on it");
  const Outcome gravity = run_dalembert(
      {"eval", sound, "--base", "fixed", "--state", "-", "--output", "gravity", "--engine", "generic"}, ".", "0 nan\n");
  EXPECT_EQ(gravity.status, 0);
  EXPECT_EQ(gravity.err, "");
  EXPECT_EQ(gravity.out, "0\n");
}

TEST(States, QuaternionsAreNormalised) {
  const std::string rest = " 0  0 0 0 0 0 0 0\n";
  const std::vector<std::string> floating{"--base", "floating"};
  const Outcome unit = eval("0 0 0  0.6 0 0 0.8 " + rest, floating), twice = eval("0 0 0  1.2 0 0 1.6 " + rest, floating);
  EXPECT_EQ(unit.err, "");
  EXPECT_NE(twice.err.find("line 1: warning: the base's quaternion has length 2; it is normalised"), std::string::npos)
      << twice.err;
  EXPECT_EQ(unit.out, twice.out);
}

TEST(Compiler, ItsAbsenceHasARemedy) {
  setenv("CXX", "/no/such/compiler", 1);
  const Outcome run = run_dalembert({"eval", sound, "--state", "-", "--output", "bias", "--base", "fixed"}, ".", "0 0\n");
  unsetenv("CXX");
  expect_refused(run, "C++ compiler: error: '/no/such/compiler' cannot be run; install g++, or name a C++17 compiler");
}

TEST(Compiler, AFolderForItsWorkIsNeeded) {
  for (const char* folder : {"/no/such/folder", "/dev/null"}) {
    setenv("TMPDIR", folder, 1);
    const std::string command = "'" + dalembert_path() + "' eval '" + sound + "' --base fixed --state - --output bias 2>&1";
    FILE* pipe = popen(("echo 0 0 | " + command).c_str(), "r");
    unsetenv("TMPDIR");
    ASSERT_TRUE(pipe);
    char said[300] = "";
    EXPECT_TRUE(std::fgets(said, sizeof said, pipe));
    EXPECT_EQ(WEXITSTATUS(pclose(pipe)), 2);
    EXPECT_EQ(said,
              "TMPDIR=" + std::string(folder) +
                  ": error: no folder can be made there for what is compiled; set TMPDIR to a folder that can be written\n");
  }
}

TEST(Output, AFileInTheWayIsRefused) {
  const TemporaryFolder folder;
  write_text(folder.path() + "/out", "mine");
  expect_refused(run_dalembert({"generate", sound, "-o", "out"}, folder.path()),
                 "out: error: this is a file and no folder; name a folder that can be written with -o");
  expect_refused(run_dalembert({"generate", sound, "-o", "out/arm/code"}, folder.path()),
                 "out/arm/code: error: 'out' is a file and no folder; name a folder that can be written with -o");
  expect_refused(run_dalembert({"report", sound, "-o", "out"}, folder.path()), "out: error: this is a file and no folder");
  EXPECT_EQ(text_of(folder.path() + "/out"), "mine");
}

}  // namespace
}  // namespace dalembert::test
