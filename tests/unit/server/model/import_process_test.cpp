// SPDX-License-Identifier: Apache-2.0
// The parent against import programs that misbehave: each is a small shell script.
#include "server/model/import_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using testing::HasSubstr;

class ImportProcessTest : public testing::Test {
 protected:
  Error run(const std::string& script, std::chrono::seconds limit = std::chrono::seconds(600)) {
    const std::filesystem::path program = folder_.write("import.sh", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    const Result<Model> model = import_in_process("some.ifc", {.program = program, .time_limit = limit});
    EXPECT_FALSE(model);
    return model ? Error{} : model.error();
  }
  TemporaryFolder folder_;
};

TEST_F(ImportProcessTest, ACrashIsOneLineThatNamesTheFile) {
  const Error error = run("echo first >&2; echo 'assertion failed: x' >&2; kill -ABRT $$");
  EXPECT_EQ(error.code, ErrorCode::kBadData);
  EXPECT_THAT(error.message,
              testing::StartsWith("some.ifc: the importer crashed on this file (Aborted: assertion failed: x)"));
}

TEST_F(ImportProcessTest, ItsOwnReasonIsPassedOn) {
  EXPECT_EQ(run("echo 'no faces' >&2; exit 1").message, "some.ifc: cannot be imported: no faces; repair or convert it");
  EXPECT_EQ(run("echo 'some.ifc: too old; convert it' >&2; exit 1").message, "some.ifc: too old; convert it");
  EXPECT_THAT(run("exit 1").message, HasSubstr("gave no reason"));
}

TEST_F(ImportProcessTest, BeingKilledMeansTooMuchMemory) {
  EXPECT_EQ(run("kill -KILL $$").code, ErrorCode::kLimitExceeded);
  EXPECT_EQ(run("echo 'it needs more memory than the import process may use' >&2; exit 1").code,
            ErrorCode::kLimitExceeded);
}

TEST_F(ImportProcessTest, OneThatNeverEndsIsStopped) {
  const auto start = std::chrono::steady_clock::now();
  const Error error = run("exec sleep 30", std::chrono::seconds(0));
  EXPECT_EQ(error.code, ErrorCode::kLimitExceeded);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST_F(ImportProcessTest, DamagedResultsAreErrors) {
  EXPECT_THAT(run("echo rubbish >&3").message, HasSubstr("damaged data"));
  EXPECT_FALSE(run("exit 0").message.empty()) << "success without a model";
}

TEST_F(ImportProcessTest, AFloodOfTalkIsHarmless) {
  EXPECT_THAT(run("head -c 1000000 /dev/zero | tr '\\0' 'x' >&2; exit 1").message, HasSubstr("cannot be imported"));
}

TEST(ImportProcess, AMissingProgramIsNamed) {
  const Result<Model> model = import_in_process("some.ifc", {.program = "no/such/program"});
  ASSERT_FALSE(model);
  EXPECT_THAT(model.error().message, HasSubstr("no/such/program: the import program cannot be started"));
}

}  // namespace
}  // namespace farfield
