// Ten readers and one writer, each a process of its own.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "memory/edits/edits.h"
#include "memory/questions/objects.h"
#include "memory/store/scene_transaction.h"
#include "tests/faults/faults.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::testing_support {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr int kReaders = 10;

std::chrono::duration<double> duration() {
  const char* const seconds = std::getenv("LOCI_FAULT_SECONDS");
  return std::chrono::duration<double>(seconds == nullptr ? 2 : std::atof(seconds));
}

/// Each scene has one observation of the same object, and an event: a reader never sees one without the
/// other.
void add_scene(memory::Store& store, memory::Id run, int number) {
  memory::SceneTransaction rows(store, run);
  if (number == 1) rows.add_object({.clock = {.valid_from = number}});
  const memory::Id scene = rows.add_scene({.time = number * kSecond});
  const memory::Id observation =
      rows.add_observation({.scene = scene, .number = 0, .position = Vector3d(number, 0, 1)});
  rows.add_association(
      {.scene = scene, .observation = observation, .object = 1, .probability = 1, .chosen = true});
  if (number == 1) rows.add_belief({.object = 1, .scene = scene, .last_scene = scene});
  rows.commit();
}

/// What a reader must see: as many observations as scenes, and never fewer than before.
bool is_consistent(const fs::path& file, size_t& scenes_before) {
  const memory::Store store = memory::Store::open_read(file);
  const memory::Store::ReadTransaction one_state(store);
  const size_t scenes = store.scenes().size(), observations = store.observations_of(1).size();
  const bool sound = scenes == observations && scenes >= scenes_before;
  if (!sound)
    fmt::print(stderr, "{} scenes after {}, {} observations\n", scenes, scenes_before, observations);
  scenes_before = scenes;
  ask(store, memory::ObjectsQuestion{});
  return sound;
}

/// A reader that ends after some time: 0 = everything was as it should be.
int read_until(const fs::path& file, Clock::time_point end) {
  size_t scenes = 0;
  try {
    while (Clock::now() < end) {
      if (!is_consistent(file, scenes)) return 1;
      std::this_thread::sleep_for(100ms);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "reader: {}\n", error.what());
    return 2;
  }
  return 0;
}

class ManyReaders : public memory::testing_support::TemporaryFolder {};

TEST_F(ManyReaders, SeeWholeScenesWhileOneProgramWrites) {
  {
    memory::Store store = memory::Store::open_write(file_);
    add_scene(store, store.begin_run("test", "{}"), 1);
  }
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(duration());
  std::vector<pid_t> readers;
  for (int i = 0; i < kReaders; ++i) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(read_until(file_, end));
    readers.push_back(child);
  }
  int scenes = 1;
  while (Clock::now() < end) {
    // Opened again and again: each close folds the log into the file, unless a reader is in the way.
    memory::Store store = memory::Store::open_write(file_);
    const memory::Id run = store.begin_run("test", "{}");
    for (int i = 0; i < 20; ++i) add_scene(store, run, ++scenes);
    store.finish_run(run);
    std::this_thread::sleep_for(50ms);
  }
  for (const pid_t reader : readers) {
    int status = 0;
    ::waitpid(reader, &status, 0);
    EXPECT_EQ(status, 0);
  }
  NoProgress quiet;
  const memory::Store store = memory::Store::open_read(file_);
  EXPECT_EQ(store.scenes().size(), static_cast<size_t>(scenes));
  EXPECT_THAT(store.verify(quiet).problems, testing::IsEmpty());
  fmt::print("{} scenes were written while {} programs read\n", scenes, kReaders);
}

}  // namespace
}  // namespace loci::testing_support
