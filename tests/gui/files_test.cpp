// Opening in the background, broken and read-only files, memories that are being written.

#include <unistd.h>

#include <QMessageBox>
#include <QPushButton>
#include <QTimer>

#include "gui/core/background.h"
#include "gui/data/memory_log.h"
#include "gui/views/timeline/time_bar.h"
#include "mapping/base/text/json.h"
#include "memory/store/scene_transaction.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

/// Root may write everything: for as long as this lives, root is nobody.
class NotRoot {
 public:
  NotRoot() {
    if (::getuid() == 0) {
      EXPECT_EQ(::setresuid(kNobody, kNobody, 0), 0);
    }
  }
  ~NotRoot() {
    if (::getuid() == kNobody) {
      EXPECT_EQ(::setresuid(0, 0, 0), 0);
    }
  }
  NotRoot(const NotRoot&) = delete;
  NotRoot& operator=(const NotRoot&) = delete;

 private:
  static constexpr uid_t kNobody = 65534;
};

class FilesInWindow : public test::BrowserWindow {
 protected:
  void open(const std::filesystem::path& path) {
    window.open(QString::fromStdString(path.string()));
    settle();
  }
  /// Adds a scene at the end, as a program that perceives would.
  void add_scene(TimeNs time) {
    memory::Store store = memory::Store::open_write(sample_.path);
    const memory::Id run = store.begin_run("test", "{}");
    {
      memory::SceneTransaction transaction(store, run);
      memory::SceneRow row;
      row.time = time;
      transaction.add_scene(row);
      transaction.commit();
    }
    store.finish_run(run);
  }
};

TEST_F(FilesInWindow, OpeningGoesOnInTheBackgroundAndCanBeCancelled) {
  const auto other = folder_.path / "other.loci";
  std::filesystem::copy_file(sample_.path, other);
  window.open(QString::fromStdString(other.string()));
  EXPECT_TRUE(window.files().loader().is_loading());
  EXPECT_TRUE(window.windowTitle().contains("sample.loci")) << "what is open stays until then";
  window.files().loader().cancel();
  settle();
  EXPECT_TRUE(window.windowTitle().contains("sample.loci"));
  bool opened = false;
  window.open(QString::fromStdString(other.string()), [&] { opened = true; });
  settle();
  EXPECT_TRUE(opened);
  EXPECT_TRUE(window.windowTitle().contains("other.loci"));
}

TEST_F(FilesInWindow, BrokenFileIsExplainedAndCanBeChecked) {
  write_file_atomically(folder_.path / "broken.loci", "this is no memory");
  QStringList said;
  QTimer press;
  QObject::connect(&press, &QTimer::timeout, [&] {
    auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
    if (box == nullptr) return;
    said << box->text();
    QPushButton* check = nullptr;
    for (auto* button : box->findChildren<QPushButton*>())
      if (button->text().contains("Check the file")) check = button;
    if (check != nullptr)
      check->click();
    else
      box->accept();
  });
  press.start(50);
  open(folder_.path / "broken.loci");
  settle();  // the check
  ASSERT_EQ(said.size(), 2);
  EXPECT_TRUE(said[0].contains("broken.loci")) << said[0].toStdString();
  EXPECT_TRUE(said[1].contains("cannot be read at all")) << said[1].toStdString();
  EXPECT_TRUE(window.windowTitle().contains("sample.loci"));
}

TEST_F(FilesInWindow, ACheckFindsASoundFileSound) {
  NoProgress progress;
  const std::string found = verify_memory(sample_.path, progress);
  EXPECT_TRUE(found.starts_with("It is sound.")) << found;
  EXPECT_NE(found.find("3 scene"), std::string::npos) << found;
}

TEST_F(FilesInWindow, AMemoryThatIsWrittenIsFollowed) {
  open(sample_.path);
  window.files().loader().check();
  EXPECT_FALSE(window.files().loader().is_loading()) << "nothing has changed";
  const TimeNs fourth = sample_.third + 60 * kSecond;
  choose(1);
  add_scene(fourth);
  window.files().loader().check();
  EXPECT_TRUE(window.files().loader().is_loading());
  settle();
  EXPECT_EQ(window.browser().data()->scenes().size(), 4U);
  EXPECT_EQ(selection().time(), fourth) << "the end stays the end";
  EXPECT_EQ(selection().object(), 1) << "the selection stays";
  EXPECT_EQ(window.docks().time_bar().axis().to(), fourth);
  go_to(sample_.second);
  add_scene(fourth + kSecond);
  window.files().loader().check();
  settle();
  EXPECT_EQ(selection().time(), sample_.second) << "who looks back is not torn away";
}

TEST_F(FilesInWindow, AReadOnlyFileSaysSo) {
  EXPECT_FALSE(window.windowTitle().contains("read-only"));
  const auto other = folder_.path / "locked.loci";
  std::filesystem::copy_file(sample_.path, other);
  using std::filesystem::perms;
  std::filesystem::permissions(other, perms::owner_read | perms::group_read | perms::others_read);
  const NotRoot user;
  ASSERT_NE(::access(other.c_str(), W_OK), 0);
  open(other);
  EXPECT_TRUE(window.windowTitle().contains("read-only"));
  EXPECT_EQ(window.browser().data()->info().path, other.string());
}

}  // namespace
}  // namespace loci::gui
