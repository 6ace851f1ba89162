#pragma once

#include <QObject>
#include <QTimer>
#include <functional>

#include "gui/data/browser.h"
#include "gui/data/memory_loader.h"

class QMainWindow;
class QMenu;
class QProgressBar;
class QToolButton;

namespace loci::gui {

/// Opens memories for a window and follows the open one: progress and cancelling in the status bar, the
/// reason when a file cannot be opened, files opened recently.
class FileOpener : public QObject {
  Q_OBJECT

 public:
  /// `remember`: the list of recent files outlives the program.
  FileOpener(MemoryOpener opener, Browser& browser, QMainWindow& window, bool remember);

  /// Opens a file in the background; `then` runs when it is shown. A dialog gives the reason when that fails,
  /// and offers a check; the memory that was open stays then.
  void open(const QString& path, const std::function<void()>& then = {});
  void ask_for_file();
  /// Reads a whole file in the background and shows whether it is intact.
  void verify(const QString& path);
  /// The menu that lists recent files.
  void set_recent_menu(QMenu* menu);
  MemoryLoader& loader() { return loader_; }

 Q_SIGNALS:
  void opened(MemoryLoader::Result memory);
  void message(const QString& text);  ///< for the status bar

 private:
  void add_status_widgets();
  void show_reading();
  void take(const QString& path, const MemoryLoader::Result& memory, bool again);
  void explain_failure(const QString& path, const QString& reason);
  void remember_file(const QString& path);
  void fill_recent_menu();

  MemoryLoader loader_;
  Browser& browser_;
  QMainWindow& window_;
  bool remember_;
  QMenu* recent_ = nullptr;
  QProgressBar* progress_;
  QToolButton* cancel_;
  QTimer reading_;  ///< until reading for the views is shown as progress
  std::function<void()> then_;
};

}  // namespace loci::gui
