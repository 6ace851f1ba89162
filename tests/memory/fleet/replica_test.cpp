// A memory in a database is asked through a local copy, which is the robot's memory row for row.

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "memory/edits/edits.h"
#include "memory/edits/forget.h"
#include "memory/questions/location.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/erasure/forgotten_tokens.h"
#include "tests/memory/fleet/fleet_fixture.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::RandomMemory;

class Replica : public testing_support::FleetTest {
 protected:
  static std::vector<std::string> problems(const fs::path& file) {
    NoProgress silent;
    return Store::open_read(file).verify(silent).problems;
  }
  static std::string answers(const fs::path& file) {
    const Store store = Store::open_read(file);
    std::string all;
    for (const ObjectRow& object : store.objects())
      all += to_text(ask(store, WhereQuestion{object_name(object.id), {}}), TimeWriter(store)) + "\n";
    return all;
  }
  std::string error_of_pull(const std::string& query = "", const std::string& role = "postgres") const {
    try {
      pull(query, role);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(Replica, AnswersAsTheFile) {
  push();
  const fs::path replica = pull();
  EXPECT_EQ(answers(replica), answers(file_));
  EXPECT_THAT(differences(replica), IsEmpty());
  EXPECT_THAT(problems(replica), IsEmpty());
  EXPECT_EQ(fs::status(replica).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(fs::status(replica.parent_path()).permissions(), fs::perms::owner_all);
}

TEST_F(Replica, ErrorsNameTheUrlNotTheCopy) {
  push();
  const fs::path replica = pull();
  const std::string said = Store::open_read(replica).error("a mistake").what();
  EXPECT_THAT(said, testing::StartsWith("postgresql://"));
  EXPECT_THAT(said, testing::Not(HasSubstr(replica.string())));
  EXPECT_THAT(said, HasSubstr("robot="));
}

TEST_F(Replica, FollowsTheRobot) {
  push();
  const fs::path first = pull();
  EXPECT_EQ(pull(), first);
  {  // as the same robot goes on
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("loci-perceive run", "{}");
    SceneTransaction scene(store, run);
    const Id id = scene.add_scene({.time = RandomMemory::kStart + 100000 * kSecond});
    const Id seen =
        scene.add_observation({.scene = id, .number = 0, .place = 1, .position = Vector3d(0.1, 0.1, 0.8)});
    scene.add_annotation({.scene = id, .observation = seen, .type = "loci.Text", .value = "a new word"});
    scene.add_association({.scene = id,
                           .observation = seen,
                           .object = 1,
                           .explanation = Explanation::move,
                           .probability = 1,
                           .chosen = true});
    scene.add_belief(
        {.object = 1, .scene = id, .place = 1, .position = Vector3d(0.1, 0.1, 0.8), .last_scene = id});
    scene.commit();
  }
  EXPECT_NE(answers(first), answers(file_));
  push();
  EXPECT_EQ(pull(), first) << "the same file, with new rows";
  EXPECT_EQ(answers(first), answers(file_));
  EXPECT_THAT(problems(first), IsEmpty()) << "derived rows, too";
  EXPECT_EQ(Store::open_read(first).objects_with_text("new word"), std::vector<Id>{1});
  {  // a correction supersedes rows
    Store store = Store::open_write(file_);
    split_object(store, 1, RandomMemory::kStart + 50000 * kSecond);
  }
  push();
  EXPECT_EQ(pull(), first);
  EXPECT_EQ(answers(first), answers(file_));
  EXPECT_THAT(problems(first), IsEmpty());
}

TEST_F(Replica, KeepsNothingOfWhatWasForgotten) {
  push();
  const fs::path before = pull();
  const ForgetResult forgotten = forget(file_, {.object = random_->cubes[0].object});
  push();
  const fs::path after = pull();
  EXPECT_NE(after, before);
  EXPECT_FALSE(fs::exists(before));
  NoProgress silent;
  EXPECT_THAT(find_forgotten(after, forgotten.tokens, silent), IsEmpty());
  EXPECT_THAT(problems(after), IsEmpty());
  EXPECT_EQ(answers(after), answers(file_));
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache"))
    if (entry.is_regular_file()) {
      const std::string bytes = read_file(entry.path());
      for (const std::string& token : forgotten.tokens.texts)
        EXPECT_EQ(bytes.find(token), std::string::npos) << entry.path() << " " << token;
    }
}

TEST_F(Replica, IsOfTheRobotThatTheUrlNames) {
  EXPECT_THAT(error_of_pull(), HasSubstr("holds no memories"));
  push();
  const std::filesystem::path other = folder_ / "other.loci";
  RandomMemory(other, 2);
  push(other, {"home", "it's ø"});
  EXPECT_THAT(error_of_pull(),
              HasSubstr("has the memories of 2 robots: 'it's ø' of home 'home', 'robot' of home 'home'"));
  EXPECT_THAT(error_of_pull("&robot=nobody"), HasSubstr("has no memory of robot 'nobody'"));
  EXPECT_THAT(differences(pull("&robot=robot")), IsEmpty());
  EXPECT_EQ(answers(pull("&home=home&robot=it%27s%20%C3%B8")), answers(other));
}

TEST_F(Replica, ShowsNoPushThatIsNotComplete) {
  push();
  const fs::path replica = pull();
  const std::string before = answers(replica);
  sql("UPDATE loci.robot SET complete = false, revision = revision + 1; DELETE FROM loci.association");
  EXPECT_EQ(answers(pull()), before);
  fs::remove_all(folder_ / "cache");
  EXPECT_THAT(error_of_pull(), HasSubstr("has not been completed"));
}

TEST_F(Replica, NoticesRowsThatNobodyPushed) {
  push();
  sql("UPDATE loci.place SET name = 'elsewhere'");
  EXPECT_THAT(error_of_pull(), HasSubstr("are not those that it pushed"));
}

TEST_F(Replica, IsMadeAnewOfAnotherDatabase) {
  push();
  pull();
  sql("postgres", "DROP DATABASE loci WITH (FORCE)");
  sql("postgres", "CREATE DATABASE loci");
  const fs::path other = folder_ / "other.loci";
  RandomMemory(other, 9);
  push(other);
  EXPECT_EQ(answers(pull()), answers(other));
}

TEST_F(Replica, IsNotAskedForAgainAtOnce) {
  push();
  NoProgress silent;
  FleetReplica replica(url(), folder_ / "cache");
  const fs::path file = replica.update(silent, 60);
  sql("DROP SCHEMA loci CASCADE");
  EXPECT_EQ(replica.update(silent, 60), file);
  EXPECT_THROW(replica.update(silent), Error);
}

TEST_F(Replica, OfSeveralRobotsShareAConnection) {
  push();
  const fs::path other = folder_ / "other.loci";
  RandomMemory(other, 9);
  push(other, {"home", "other"});
  NoProgress silent;
  const auto connections = std::make_shared<FleetConnections>();
  FleetReplica first(url("&robot=robot"), folder_ / "cache", connections);
  FleetReplica second(url("&robot=other"), folder_ / "cache", connections);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(answers(first.update(silent)), answers(file_));
    EXPECT_EQ(answers(second.update(silent)), answers(other));
  }
  EXPECT_EQ(&connections->to(parse_fleet_url(url("&robot=robot"))),
            &connections->to(parse_fleet_url(url("&robot=other"))));
}

TEST_F(Replica, WhileFreshIsNotWaitedFor) {
  push();
  NoProgress silent;
  FleetReplica replica(url(), folder_ / "cache");
  const fs::path file = replica.update(silent, 60);
  const int updating = ::open((file.parent_path() / "lock").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(updating, LOCK_EX), 0);  // as another program does while it updates
  EXPECT_EQ(replica.update(silent, 60), file);
  ::close(updating);
}

}  // namespace
}  // namespace loci::memory
