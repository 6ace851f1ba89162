#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "gui/data/browser_data.h"
#include "mapping/base/progress.h"

namespace loci {

/// Opens a memory by path; throws Error, Interrupted when it is told to stop.
using MemoryOpener = std::function<std::unique_ptr<BrowserData>(const std::string& path, Progress& progress)>;

/// Opens memories in the background, and again when the file has changed.
class MemoryLoader : public QObject {
  Q_OBJECT

 public:
  using Result = std::shared_ptr<const BrowserData>;

  explicit MemoryLoader(MemoryOpener opener, QObject* parent = nullptr);
  ~MemoryLoader() override;

  /// What was being opened is given up. `again`: the memory that is open, because it has changed.
  void load(const QString& path, bool again = false);
  void cancel();
  bool is_loading() const { return stop_ != nullptr; }
  /// Loads the file again whenever a writer has changed it; empty = follows none.
  void follow(const QString& path);
  /// Looks now whether the followed file has changed.
  void check();

 Q_SIGNALS:
  void started(const QString& path);
  void progressed(double fraction, const QString& text);
  void loaded(const QString& path, MemoryLoader::Result memory, bool again);
  void failed(const QString& path, const QString& reason, bool again);
  void finished();

 private:
  void finish();

  MemoryOpener opener_;
  std::shared_ptr<std::atomic<bool>> stop_;  ///< set while something is loaded
  QString followed_;
  std::string state_;  ///< of the followed file when it was loaded
  QTimer timer_;
};

}  // namespace loci
