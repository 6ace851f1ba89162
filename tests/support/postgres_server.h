#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "mapping/base/error.h"

namespace loci::testing_support {

/// A PostgreSQL server of this process in a temporary folder, reached over a Unix socket without password. It
/// runs as user postgres when this process is root's, and ends with this process.
class PostgresServer {
 public:
  /// Null, and why, when there is no server to start.
  static std::unique_ptr<PostgresServer> start(std::string& why_not) {
    const std::filesystem::path programs = find_programs();
    if (programs.empty()) {
      why_not = "PostgreSQL's server is not installed (postgresql)";
      return nullptr;
    }
    std::unique_ptr<PostgresServer> server(new PostgresServer);
    server->programs_ = programs;
    const std::string data = server->folder_ + "/data", initdb = (programs / "initdb").string(),
                      postgres = (programs / "postgres").string();
    if (!server->run(
            {initdb, "-D", data, "-U", "postgres", "-A", "trust", "-E", "UTF8", "--locale=C", "--no-sync"})) {
      why_not = "initdb failed, see " + server->log();
      return nullptr;
    }
    server->server_ = server->spawn({postgres, "-D", data, "-k", server->folder_, "-c",
                                     "listen_addresses=", "-c", "fsync=off", "-c", "max_connections=50"});
    const std::string ready = (programs / "pg_isready").string();
    for (int attempt = 0; attempt < 200; ++attempt) {
      if (server->run({ready, "-q", "-h", server->folder_})) return server;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    why_not = "the server did not start, see " + server->log();
    return nullptr;
  }

  ~PostgresServer() {
    if (server_ > 0) {
      ::kill(server_, SIGQUIT);
      ::waitpid(server_, nullptr, 0);
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  void create_database(const std::string& name) const {
    run({(programs_ / "createdb").string(), "-h", folder_, "-U", "postgres", name});
  }
  /// For PGHOST.
  const std::string& folder() const { return folder_; }
  /// Of a database, as a role; `query` begins with '&'.
  std::string url(const std::string& database, const std::string& role = "postgres",
                  const std::string& query = "") const {
    return "postgresql:///" + database + "?host=" + folder_ + "&user=" + role + query;
  }

 private:
  PostgresServer() {
    std::string name = (std::filesystem::temp_directory_path() / "loci_pg_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw Error("cannot make a folder in " + name);
    folder_ = name;
    std::filesystem::permissions(folder_, std::filesystem::perms::all);
  }

  static std::filesystem::path find_programs() {
    std::vector<std::filesystem::path> found;
    std::error_code none;
    for (const auto& version : std::filesystem::directory_iterator("/usr/lib/postgresql", none))
      if (std::filesystem::exists(version.path() / "bin/initdb", none))
        found.push_back(version.path() / "bin");
    return found.empty() ? std::filesystem::path() : *std::max_element(found.begin(), found.end());
  }

  std::string log() const { return folder_ + "/log"; }

  pid_t spawn(std::vector<std::string> words) const {
    std::vector<std::string> all = {"setpriv", "--pdeathsig", "INT"};
    if (::geteuid() == 0) all.insert(all.end(), {"--reuid=postgres", "--regid=postgres", "--clear-groups"});
    all.insert(all.end(), words.begin(), words.end());
    const pid_t child = ::fork();
    if (child != 0) return child;
    const int out = ::open(log().c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    ::dup2(out, 1);
    ::dup2(out, 2);
    if (::chdir("/") != 0) ::_exit(127);
    std::vector<char*> arguments;
    for (std::string& word : all) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }
  bool run(std::vector<std::string> words) const {
    int status = 0;
    ::waitpid(spawn(std::move(words)), &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  std::string folder_;
  std::filesystem::path programs_;
  pid_t server_ = -1;
};

}  // namespace loci::testing_support
