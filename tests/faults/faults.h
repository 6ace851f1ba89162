#pragma once

#include <gmock/gmock.h>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace loci::testing_support {

/// How often something is tried: LOCI_FAULT_ROUNDS in the environment, else `few`.
int fault_rounds(int few);

/// What became of a program.
struct Finished {
  bool killed = false;
  int exit_code = -1;
  double seconds = 0;
  std::string error;  ///< stderr
};

/// Runs a command such as "loci-memory verify -m F/day.loci", F being the folder, with more variables in its
/// environment ("NAME=value"). Killed with SIGKILL after a time, unless that is negative. In a folder that
/// its user may not write (or root: with the rights of nobody) when `unprivileged`.
Finished run_program(const std::string& command, const std::filesystem::path& folder,
                     double kill_after_s = -1, const std::vector<std::string>& environment = {},
                     bool unprivileged = false);

/// A command that changes or makes a memory.
struct Operation {
  std::string name;
  std::string command;             ///< with F for the folder
  std::string memory;              ///< that it changes or makes
  std::vector<std::string> files;  ///< what it needs of the templates
  bool resumes = false;            ///< commits scene by scene, and goes on when it is called again
};
inline void PrintTo(const Operation& operation, std::ostream* out) {
  *out << operation.command;
}
/// run, ingest, edit, forget, retain, merge, reason, migration.
const std::vector<Operation>& all_operations();

/// Operations on small memories, which are made once.
class FaultTest : public testing::TestWithParam<Operation> {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();
  /// Runs the operation undisturbed, to know its states.
  void SetUp() override;

  std::filesystem::path memory() const { return folder_ / GetParam().memory; }
  Finished run(double kill_after_s = -1, const std::vector<std::string>& environment = {},
               bool unprivileged = false) const {
    return run_program(GetParam().command, folder_, kill_after_s, environment, unprivileged);
  }
  /// The folder as it was before the command.
  void reset() const;
  /// After a disturbance: nothing half, the memory verified, what the command reads as it was. Called again
  /// it gives its result, and nothing else is left in the folder.
  void expect_sound(const std::string& what) const;
  /// Scenes that were committed.
  int64_t scenes() const;

  std::filesystem::path folder_;
  double seconds_ = 0;  ///< of the undisturbed command

 private:
  /// What the memory holds, apart from times of commits; empty when it is not there.
  std::string content() const;
  /// Nothing but what the operation reads and makes lies in the folder.
  void expect_nothing_else() const;

  std::vector<std::string> states_;  ///< that an operation which does all or nothing may leave
  std::string result_;
};

}  // namespace loci::testing_support
