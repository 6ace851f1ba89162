#include "apps/evaluate/memory/figures.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "memory/store/store.h"

namespace loci::apps::memory_experiment {
namespace {

class MemoryAtSize : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("loci_memory_" + std::to_string(getpid()));
    make_folder(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::filesystem::path folder;
  NoProgress silent;
};

TEST_F(MemoryAtSize, KeepsWhatWasCommittedWhenItsWriterIsKilled) {
  MemoryOptions options;
  options.observations = 300;
  options.readers = 0;
  options.questions = 10;
  options.kills = 5;
  const MemoryFigures figures = measure(options, folder, silent);
  EXPECT_EQ(figures.kills, 5);
  EXPECT_EQ(figures.kills_lost, 0);
  EXPECT_EQ(figures.kills_unsound, 0);
}

TEST_F(MemoryAtSize, KnowsTheThingsOfTheHomeAndWritesLittleForWhatDoesNotChange) {
  MemoryOptions options;
  options.observations = 4000;
  options.readers = 2;
  options.questions = 10;
  const MemoryFigures figures = measure(options, folder, silent);
  EXPECT_GE(figures.objects, 95U) << "a hundred objects are in the home";
  EXPECT_LT(figures.bytes_per_observation, 1000);
  const IdentityFigures& identity = figures.identity;
  EXPECT_GT(identity.f1(), 0.98);
  const auto& stayed = identity.events[static_cast<size_t>(TrueEvent::stayed)];
  EXPECT_LT(stayed.said_moved, 10U);
  EXPECT_GT(stayed.same, stayed.all * 99 / 100);
  EXPECT_GT(figures.reader_questions, 0U);
  const memory::Store store = memory::Store::open_read(folder / "simulated.loci");
  size_t beliefs = 0;
  for (const memory::Store::TableSize& size : store.statistics())
    if (size.table == "belief") beliefs = static_cast<size_t>(size.rows);
  EXPECT_LT(beliefs, figures.observations) << "a tenth of one row per object and scene";
  options.reuse = true;
  const MemoryFigures again = measure(options, folder, silent);
  EXPECT_EQ(again.scenes, 0U);
  EXPECT_EQ(again.objects, figures.objects);
  EXPECT_EQ(again.questions.size(), figures.questions.size());
}

TEST_F(MemoryAtSize, LearnsHowMuchLooksVaryAndTellsFalseDetectionsFromThings) {
  MemoryOptions options;
  options.observations = 8000;
  options.readers = 0;
  options.questions = 10;
  options.home.clutter = 0.1;
  const IdentityFigures identity = measure(options, folder, silent).identity;
  EXPECT_GT(identity.f1(), 0.985);
  const auto& ghosts = identity.events[static_cast<size_t>(TrueEvent::ghost)];
  EXPECT_LT(ghosts.confused, ghosts.all / 5) << "few are taken for a known object that moved";
}

}  // namespace
}  // namespace loci::apps::memory_experiment
