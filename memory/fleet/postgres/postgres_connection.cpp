// A module of its own, as libpq brings TLS, Kerberos and LDAP.

#include "memory/fleet/postgres_connection.h"

#include <libpq-fe.h>

#include <algorithm>

#include "mapping/base/error.h"

namespace loci::memory {
namespace {

struct Clear {
  void operator()(PGresult* result) const { PQclear(result); }
  void operator()(PGconn* connection) const { PQfinish(connection); }
};
using Result = std::unique_ptr<PGresult, Clear>;

std::string first_line(const char* text) {
  const std::string_view all = text == nullptr ? "" : text;
  return std::string(all.substr(0, all.find('\n')));
}

class LibpqConnection : public PostgresConnection {
 public:
  LibpqConnection(const std::string& url, const std::string& shown) : shown_(shown) {
    // What the URL says comes later and holds.
    const char* const names[] = {"connect_timeout", "application_name", "dbname", "client_encoding", nullptr};
    const char* const values[] = {"10", "loci", url.c_str(), "UTF8", nullptr};
    connection_.reset(PQconnectdbParams(names, values, 1));
    if (PQstatus(connection_.get()) != CONNECTION_OK)
      throw Error("cannot be reached: " + first_line(PQerrorMessage(connection_.get())), {shown_, 0, {}},
                  "check that the server runs, and host, port, database, role and password");
    PQsetNoticeProcessor(
        connection_.get(), [](void*, const char*) {}, nullptr);
  }

  int64_t run(const std::string& statement, const SqlParameters& parameters) override {
    const Result result = execute(statement, parameters);
    check(result.get());
    const std::string_view changed = PQcmdTuples(result.get());
    return changed.empty() ? 0 : std::stoll(std::string(changed));
  }

  void run_script(const std::string& statements) override {
    check(Result(PQexec(connection_.get(), statements.c_str())).get());
  }

  void query(const std::string& statement, const SqlParameters& parameters,
             const std::function<void(ResultRow)>& visitor) override {
    const std::vector<const char*> values = pointers(parameters);
    if (PQsendQueryParams(connection_.get(), statement.c_str(), static_cast<int>(values.size()), nullptr,
                          values.data(), nullptr, nullptr, kBinary) == 0)
      throw lost();
    PQsetSingleRowMode(connection_.get());
    const Drain drain{*this};
    while (const Result result{PQgetResult(connection_.get())}) {
      check(result.get());
      for (int row = 0; row < PQntuples(result.get()); ++row) pass_on(result.get(), row, visitor);
    }
  }

  void copy_in(const std::string& statement,
               const std::function<void(const std::function<void(std::string_view)>&)>& fill) override {
    check(Result(PQexec(connection_.get(), statement.c_str())).get());
    try {
      fill([&](std::string_view bytes) {
        for (constexpr size_t kPart = size_t{1} << 20; !bytes.empty();
             bytes.remove_prefix(std::min(kPart, bytes.size())))
          if (PQputCopyData(connection_.get(), bytes.data(),
                            static_cast<int>(std::min(kPart, bytes.size()))) != 1)
            throw lost();
      });
    } catch (...) {
      PQputCopyEnd(connection_.get(), "stopped");
      const Drain drain{*this};
      throw;
    }
    const Drain drain{*this};
    if (PQputCopyEnd(connection_.get(), nullptr) != 1) throw lost();
    check(Result(PQgetResult(connection_.get())).get());
  }

 private:
  static constexpr int kBinary = 1;

  /// Takes what is left of an answer, so that the next statement can be sent.
  struct Drain {
    LibpqConnection& of;
    ~Drain() {
      bool cancelled = false;
      while (const Result left{PQgetResult(of.connection_.get())}) {
        if (!cancelled) of.cancel();
        cancelled = true;
      }
    }
  };

  void cancel() {
    PGcancel* request = PQgetCancel(connection_.get());
    char message[256];
    PQcancel(request, message, sizeof message);
    PQfreeCancel(request);
  }

  static std::vector<const char*> pointers(const SqlParameters& parameters) {
    std::vector<const char*> values;
    for (const auto& parameter : parameters) values.push_back(parameter ? parameter->c_str() : nullptr);
    return values;
  }

  Result execute(const std::string& statement, const SqlParameters& parameters) {
    const std::vector<const char*> values = pointers(parameters);
    return Result(PQexecParams(connection_.get(), statement.c_str(), static_cast<int>(values.size()), nullptr,
                               values.data(), nullptr, nullptr, kBinary));
  }

  void pass_on(const PGresult* result, int row, const std::function<void(ResultRow)>& visitor) {
    row_.resize(static_cast<size_t>(PQnfields(result)));
    for (int i = 0; i < PQnfields(result); ++i)
      if (PQgetisnull(result, row, i) != 0)
        row_[static_cast<size_t>(i)].reset();
      else
        row_[static_cast<size_t>(i)] =
            std::string_view(PQgetvalue(result, row, i), static_cast<size_t>(PQgetlength(result, row, i)));
    visitor(row_);
  }

  Error lost() const {
    return Error("the connection was lost: " + first_line(PQerrorMessage(connection_.get())), {shown_, 0, {}},
                 "run the command again: it goes on where it stopped");
  }

  void check(const PGresult* result) const {
    const ExecStatusType status = PQresultStatus(result);
    if (status != PGRES_FATAL_ERROR && status != PGRES_BAD_RESPONSE) return;
    const char* const code = PQresultErrorField(result, PG_DIAG_SQLSTATE);
    const std::string_view state = code == nullptr ? "" : code;
    const std::string message = first_line(PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY));
    if (state.empty() || state.starts_with("08") || state.starts_with("57P")) throw lost();
    const auto hint = [&]() -> std::string {
      if (state == "42501") return "loci-memory grant, run by the owner of the schema loci, gives rights";
      if (state == "55P03") return "another program is pushing this memory; wait until it has finished";
      if (state.starts_with("53")) return "make room on the server, and run the command again";
      return {};
    };
    throw Error(message, {shown_, 0, {}}, hint());
  }

  std::string shown_;
  std::unique_ptr<PGconn, Clear> connection_;
  std::vector<std::optional<std::string_view>> row_;
};

}  // namespace
}  // namespace loci::memory

extern "C" loci::memory::PostgresConnection* loci_connect_to_postgres(const std::string& url,
                                                                      const std::string& shown) {
  return new loci::memory::LibpqConnection(url, shown);
}
