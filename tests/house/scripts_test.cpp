// The scripts that judge: the counter of scripts/test, the table of scripts/targets, the counts of scripts/fuzz, and
// the messages without a test.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "support/paths.h"
#include "support/support.h"

namespace retalho {
namespace {

struct Outcome {
  int code = -1;
  std::string last_line;
};

Outcome run_script(const std::string& arguments, const std::string& environment = "") {
  Outcome run;
  std::FILE* pipe = ::popen((environment + test::source_folder() + "/scripts/" + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return run;
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  const int status = ::pclose(pipe);
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  run.last_line = text.substr(text.rfind('\n') + 1);
  return run;
}

class CountTests : public testing::Test {
 protected:
  Outcome count(const std::string& words = "") {
    return run_script("count_tests.py '" + folder_.path().string() + "' " + words);
  }
  void ctest(const std::string& cases) { folder_.put("ctest.xml", "<testsuite>" + cases + "</testsuite>"); }
  void report(const std::string& name, const std::string& cases) {
    folder_.put("test_" + name + ".xml", "<testsuites><testsuite name=\"S\">" + cases + "</testsuite></testsuites>");
  }
  test::ScratchFolder folder_;
};

const std::string kPassed = R"(<testcase name="a" classname="S" status="run" result="completed"/>)";
const std::string kFailed = R"(<testcase name="b" classname="S" status="run"><failure message="no"/></testcase>)";
const std::string kSkipped =
    R"(<testcase name="c" classname="S" status="run" result="skipped"><skipped message="no data"/></testcase>)";

TEST_F(CountTests, CasesAreCountedNotPrograms) {
  ctest(R"(<testcase name="tin" status="run"/><testcase name="package" status="run"/>)");
  report("tin", kPassed + kPassed + kSkipped);
  const Outcome run = count("demo=passed");
  EXPECT_EQ(run.last_line, "4 passed, 0 failed, 1 skipped");
  EXPECT_EQ(run.code, 0);
}

TEST_F(CountTests, AFailedCaseIsOneFailure) {
  ctest(R"(<testcase name="tin" status="fail"/>)");
  report("tin", kPassed + kFailed);
  const Outcome run = count();
  EXPECT_EQ(run.last_line, "1 passed, 1 failed");
  EXPECT_EQ(run.code, 1);
}

TEST_F(CountTests, ACrashIsAFailureWithOrWithoutAReport) {
  ctest(R"(<testcase name="tin" status="fail"/><testcase name="mesh" status="fail"/>)");
  report("tin", kPassed);
  EXPECT_EQ(count().last_line, "1 passed, 2 failed");
  folder_.put("test_mesh.xml", "<testsuites><testsuite");
  EXPECT_EQ(count().last_line, "1 passed, 2 failed");
  EXPECT_EQ(count().code, 1);
}

TEST_F(CountTests, AFailedCheckAndNoTestAtAllAreFailures) {
  EXPECT_EQ(count().last_line, "0 passed, 1 failed");
  EXPECT_EQ(count().code, 1);
  ctest(R"(<testcase name="tin" status="run"/>)");
  report("tin", kPassed);
  EXPECT_EQ(count("demo=passed lint=failed").last_line, "2 passed, 1 failed");
  EXPECT_EQ(count("demo=passed lint=failed").code, 1);
}

TEST(Targets, EveryRowIsComplete) {
  const Outcome run = run_script("targets --list");
  EXPECT_EQ(run.code, 0) << run.last_line;
}

/// scripts/fuzz with a program of the test's own in the place of the fuzzer of PGM.
class Fuzz : public testing::Test {
 protected:
  Outcome fuzz(const std::string& words) {
    return run_script("fuzz " + words, "RETALHO_FUZZ_BUILD='" + folder_.path().string() + "' ");
  }
  void fuzzer(const std::string& lines) {
    const std::string file = folder_.put("tests/fuzz/fuzz_pgm", "#!/bin/sh\n" + lines + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  test::ScratchFolder folder_;
};

TEST_F(Fuzz, CountsAreInTheLastLineAndAddUp) {
  fuzzer("echo 'stat::number_of_executed_units: 1200'");
  EXPECT_EQ(fuzz("1 pgm").last_line, R"({"executions": {"pgm": {"run": 1200, "total": 1200}}, "broken": false})");
  const Outcome again = fuzz("--until 1000 pgm");
  EXPECT_EQ(again.last_line, R"({"executions": {"pgm": {"run": 1200, "total": 2400}}, "broken": false})");
  EXPECT_EQ(again.code, 0);
}

TEST_F(Fuzz, UntilIsPassedOnAndFallingShortIsAFailure) {
  fuzzer(R"(case "$*" in *-runs=5000*) echo 'stat::number_of_executed_units: 4000';; esac)");
  const Outcome run = fuzz("--until 5000 pgm");
  EXPECT_EQ(run.last_line, R"({"executions": {"pgm": {"run": 4000, "total": 4000}}, "broken": true})");
  EXPECT_EQ(run.code, 1);
}

TEST_F(Fuzz, ABrokenTargetIsAFailureWithTheExecutionsSoFar) {
  fuzzer("echo '#64 NEW cov: 9'; echo '==1== ERROR: AddressSanitizer'; exit 77");
  const Outcome run = fuzz("1 pgm");
  EXPECT_EQ(run.last_line, R"({"executions": {"pgm": {"run": 64, "total": 64}}, "broken": true})");
  EXPECT_EQ(run.code, 1);
}

TEST_F(Fuzz, WordsThatAreNoneAreRefused) {
  EXPECT_EQ(fuzz("1 nonsense").code, 2);
  EXPECT_EQ(fuzz("0 pgm").code, 2);
  EXPECT_EQ(fuzz("--until many pgm").last_line, "fuzz: --until takes a number of executions, not 'many'");
}

TEST(Messages, EveryMessageHasATest) {
  const Outcome run = run_script("messages --strict");
  EXPECT_EQ(run.code, 0) << run.last_line << " (scripts/messages lists them)";
}

TEST(Messages, AMessageWithoutATestIsFound) {
  const test::ScratchFolder made;
  made.put("src/a.cpp", "throw BadInput(fmt::format(\"the grid '{}' has the colour of \"\n\"mustard\", name));\n");
  made.put("tests/a_test.cpp", "holds(\"has the color of mustard\")");
  const std::string words = "messages --strict --root '" + made.path().string() + "'";
  EXPECT_NE(run_script(words).last_line.find("messages: 1, of which 0 cannot be tested and 1 are named by no test"),
            std::string::npos);
  EXPECT_EQ(run_script(words).code, 1);
  made.put("tests/a_test.cpp", "holds(\"the colour of mustard\")");
  EXPECT_NE(run_script(words).last_line.find("and 0 are named by no test"), std::string::npos);
}

}  // namespace
}  // namespace retalho
