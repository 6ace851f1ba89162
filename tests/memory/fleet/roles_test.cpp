// What roles of the server may do, and may not.

#include "memory/fleet/fleet_roles.h"
#include "tests/memory/fleet/fleet_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::RandomMemory;

class Roles : public testing_support::FleetTest {
 protected:
  void SetUp() override {
    FleetTest::SetUp();
    if (IsSkipped()) return;
    sql("CREATE ROLE robot_a LOGIN; CREATE ROLE robot_b LOGIN; CREATE ROLE reader LOGIN; CREATE ROLE "
        "stranger LOGIN;");
    grant_role(parse_fleet_url(url()), {"robot_a", "home", "a"});
    grant_role(parse_fleet_url(url()), {"robot_b", "home", "b"});
    grant_role(parse_fleet_url(url()), {"reader", "home", {}});
    push(file_, {"home", "a"}, "robot_a");
    push(file_, {"home", "b"}, "robot_b");
    push(file_, {"away", "a"});
  }

  /// "" = done.
  std::string attempt(const std::string& role, const std::string& statement) const {
    try {
      connection(role)->run(statement);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  int64_t count(const std::string& role, const std::string& table) const {
    int64_t count = -1;
    connection(role)->query("SELECT count(*) FROM loci." + table, {},
                            [&](ResultRow row) { count = integer_of(row[0]); });
    return count;
  }
};

TEST_F(Roles, ARobotHasItsOwnRowsAlone) {
  EXPECT_EQ(count("robot_a", "robot"), 1);
  EXPECT_EQ(3 * count("robot_a", "observation"), count("postgres", "observation"));
  EXPECT_EQ(count("robot_a", "v_objects"), count("robot_b", "v_objects"));
  EXPECT_THAT(attempt("robot_a", "INSERT INTO loci.meta VALUES ('home', 'b', 'key', 'value', 0)"),
              HasSubstr("row-level security"));
  EXPECT_THAT(attempt("robot_a", "INSERT INTO loci.meta VALUES ('away', 'a', 'key', 'value', 0)"),
              HasSubstr("row-level security"));
  EXPECT_THAT(attempt("robot_a", "UPDATE loci.robot SET robot = 'b'"), HasSubstr("row-level security"));
  EXPECT_EQ(attempt("robot_a", "DELETE FROM loci.observation WHERE robot = 'b' OR home = 'away'"), "");
  EXPECT_THAT(differences(file_, {"home", "b"}), IsEmpty());
  EXPECT_THAT(differences(file_, {"away", "a"}), IsEmpty());
  for (const char* statement :
       {"INSERT INTO loci.member VALUES ('robot_a', 'home', 'b')", "UPDATE loci.member SET robot = 'b'",
        "SELECT loci.admit('robot_a', 'home', 'b')", "DELETE FROM loci.version", "DROP TABLE loci.scene",
        "ALTER TABLE loci.scene DISABLE ROW LEVEL SECURITY", "TRUNCATE loci.scene", "SET ROLE postgres",
        "UPDATE loci.observation SET x = 0", "CREATE TABLE loci.mine (i int)"})
    EXPECT_THAT(attempt("robot_a", statement), testing::Not(IsEmpty())) << statement;
  EXPECT_THROW(push(file_, {"home", "b"}, "robot_a"), Error);
  EXPECT_EQ(push(file_, {"home", "a"}, "robot_a").transactions, 0);
}

TEST_F(Roles, AReaderReadsAHomeAndWritesNothing) {
  EXPECT_EQ(count("reader", "robot"), 2);
  EXPECT_EQ(2 * count("postgres", "observation"), 3 * count("reader", "observation"));
  for (const TableLayout& table : table_layouts()) {
    EXPECT_THAT(attempt("reader", "DELETE FROM " + table_name(table)), HasSubstr("permission denied"))
        << table.name;
    EXPECT_THAT(attempt("reader", "INSERT INTO " + table_name(table) + " SELECT * FROM " + table_name(table)),
                HasSubstr("permission denied"))
        << table.name;
  }
  EXPECT_THAT(attempt("reader", "UPDATE loci.robot SET complete = false"), HasSubstr("permission denied"));
  try {
    push(file_, {"home", "c"}, "reader");
    FAIL() << "a reader pushed";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("permission denied"), HasSubstr("loci-memory grant")));
  }
  EXPECT_THAT(differences(pull("&robot=b", "reader"), {"home", "b"}), IsEmpty());
}

TEST_F(Roles, AStrangerSeesNothing) {
  EXPECT_THAT(attempt("stranger", "SELECT * FROM loci.robot"), HasSubstr("permission denied"));
  EXPECT_THROW(pull("&robot=b", "stranger"), Error);
  EXPECT_THROW(push(file_, {"home", "stranger"}, "stranger"), Error);
}

TEST_F(Roles, RightsAreTakenBack) {
  const FleetRole reader{"reader", "home", {}};
  revoke_role(parse_fleet_url(url()), reader);
  EXPECT_THAT(attempt("reader", "SELECT * FROM loci.robot"), HasSubstr("permission denied"));
  EXPECT_THROW(revoke_role(parse_fleet_url(url()), reader), Error);
  EXPECT_THROW(grant_role(parse_fleet_url(url()), {"nobody\"; DROP SCHEMA loci CASCADE; --", "home", {}}),
               Error);
  EXPECT_THROW(grant_role(parse_fleet_url(url("", "robot_a")), {"robot_a", "home", "b"}), Error);
  sql("CREATE ROLE \"it's; \"\"me\"\"\" LOGIN");
  grant_role(parse_fleet_url(url()), {"it's; \"me\"", "home", {}});
  EXPECT_EQ(count("it%27s%3B%20%22me%22", "robot"), 2);
}

}  // namespace
}  // namespace loci::memory
